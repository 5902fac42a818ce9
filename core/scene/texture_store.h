// SPDX-License-Identifier: GPL-3.0-or-later
// Textures by id: files, bytes of files, or texels.
#pragma once

#include <tbb/task_arena.h>

#include <atomic>
#include <compare>
#include <cstdint>
#include <functional>
#include <latch>
#include <map>
#include <memory>
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

/// A file or its bytes, decoded once by whoever comes first.
class TextureDecoding {
 public:
  using Bytes = std::vector<uint8_t>;

  TextureDecoding(TextureOptions options, std::variant<std::string, Bytes> path_or_bytes)
      : options_(std::move(options)), source_(std::move(path_or_bytes)) {}

  /// Decodes, unless somebody has begun to.
  bool try_run();
  /// Decodes, or waits for the thread that does.
  void run();
  /// Nobody decodes it any more who has not begun.
  void abandon() { begun_.test_and_set(); }

  /// After run(). Magenta where it failed.
  const std::shared_ptr<const Texture>& texture() const { return texture_; }
  /// After run(): says in the log why it failed, if it did and that was not said yet.
  void report();
  /// Whether report() said that it failed.
  bool reported() const { return reported_; }

 private:
  void decode();

  TextureOptions options_;
  std::variant<std::string, Bytes> source_;
  std::atomic_flag begun_;
  std::latch done_{1};
  std::shared_ptr<const Texture> texture_;
  std::string failure_;
  bool reported_ = false;
};

class TextureStore {
 public:
  TextureStore() = default;
  ~TextureStore();
  TextureStore(const TextureStore&) = delete;
  TextureStore& operator=(const TextureStore&) = delete;

  /// Files and bytes are decoded on other threads from now on. The same file under the same options
  /// is decoded once, however many ids name it, and not again while it is unchanged.
  void set_file(uint64_t id, std::string path, const TextureOptions& options);
  void set_memory(uint64_t id, std::span<const uint8_t> bytes, const TextureOptions& options);
  /// 4 values a pixel. Floats that are not finite are replaced, with a warning.
  void set_pixels8(uint64_t id, int width, int height, std::span<const uint8_t> rgba,
                   const TextureOptions& options);
  void set_pixels_float(uint64_t id, int width, int height, std::span<const float> rgba,
                        const TextureOptions& options);
  bool erase(uint64_t id) { return entries_.erase(id); }
  bool contains(uint64_t id) { return entries_.find(id) != nullptr; }

  /// Decodes those of `ids` (all known) that are not yet, in parallel. What cannot be read becomes
  /// magenta, with one warning. Throws Error(cancelled), between textures, once `cancelled()`.
  void decode(std::span<const uint64_t> ids, const std::function<bool()>& cancelled = {});

  /// After decode(). The same pointer for the same texels.
  std::shared_ptr<const Texture> get(uint64_t id) { return entries_.find(id)->texture; }

 private:
  struct Entry {
    std::shared_ptr<TextureDecoding> decoding;  // null: texels were given
    std::shared_ptr<const Texture> texture;     // null until decoded
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

  static FileKey key_of(const std::string& path, const TextureOptions& options);
  void start(const std::shared_ptr<TextureDecoding>& decoding);

  ItemStore<Entry> entries_;
  std::map<FileKey, std::weak_ptr<TextureDecoding>> files_;
  tbb::task_arena background_;
};

}  // namespace kestrel
