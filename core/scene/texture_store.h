// SPDX-License-Identifier: GPL-3.0-or-later
// Textures by id: files, bytes of files, or texels; decoded when they are first used.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "scene/item_store.h"
#include "scene/scene.h"

namespace kestrel {

/// As KestrelTextureOptions.
struct TextureOptions {
  std::string name;
  bool srgb = false;
  bool nearest = false;
  Extension extension = Extension::repeat;
};

class TextureStore {
 public:
  void set_file(uint64_t id, std::string path, const TextureOptions& options);
  void set_memory(uint64_t id, std::span<const uint8_t> bytes, const TextureOptions& options);
  /// 4 values a pixel. Floats that are not finite are replaced, with a warning.
  void set_pixels8(uint64_t id, int width, int height, std::span<const uint8_t> rgba,
                   const TextureOptions& options);
  void set_pixels_float(uint64_t id, int width, int height, std::span<const float> rgba,
                        const TextureOptions& options);
  bool erase(uint64_t id) { return entries_.erase(id); }
  bool contains(uint64_t id) { return entries_.find(id) != nullptr; }

  /// Decodes those of `ids` (all known) that are not yet, in parallel. The same file under the
  /// same options is decoded once, however many ids name it, and not again while it is unchanged.
  /// What cannot be read becomes magenta, with one warning.
  void decode(std::span<const uint64_t> ids);

  /// After decode(). The same pointer for the same texels.
  std::shared_ptr<const Texture> get(uint64_t id) { return entries_.find(id)->texture; }

 private:
  struct File {
    std::string path;
  };
  using Bytes = std::shared_ptr<const std::vector<uint8_t>>;
  struct Entry {
    TextureOptions options;
    std::variant<std::monostate, File, Bytes> source;  // monostate: texels were given
    std::shared_ptr<const Texture> texture;            // null until decoded
  };
  /// What decides the texels of a file.
  struct FileKey {
    std::string path;
    int64_t modified = 0;
    uintmax_t byte_count = 0;
    bool srgb = false;
    bool nearest = false;
    Extension extension = Extension::repeat;
    auto operator<=>(const FileKey&) const = default;
  };
  /// One image to decode, and who waits for it.
  struct Job {
    const Entry* first = nullptr;
    std::optional<FileKey> key;  // of files
    std::vector<Entry*> waiting;
    std::shared_ptr<const Texture> texture;
    std::string failure;

    explicit Job(const Entry& entry) : first(&entry) {}
  };

  static FileKey key_of(const Entry& entry);
  std::vector<Job> jobs_for(std::span<const uint64_t> ids);
  static void run(Job& job);

  ItemStore<Entry> entries_;
  std::map<FileKey, std::weak_ptr<const Texture>> decoded_;
};

}  // namespace kestrel
