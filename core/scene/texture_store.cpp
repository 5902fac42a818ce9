// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/texture_store.h"

#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/log.h"
#include "images/images.h"

namespace kestrel {
namespace {

std::shared_ptr<Texture> empty_texture(const TextureOptions& options) {
  auto texture = std::make_shared<Texture>();
  texture->name = options.name;
  texture->srgb = options.srgb;
  texture->nearest = options.nearest;
  texture->extension = options.extension;
  return texture;
}

/// Filtering spreads an infinite texel over its neighbours: not-a-number becomes 0, infinity the
/// largest half float, which is far above any light.
void replace_infinite(Texture& texture) {
  constexpr float kLargest = 65504.0f;
  size_t count = 0;
  for (float& v : texture.texels_float) {
    if (std::isfinite(v)) continue;
    v = std::isnan(v) ? 0.0f : std::copysign(kLargest, v);
    ++count;
  }
  if (count) {
    log::warning_once("Texture '{}': {} values that are not finite were replaced.", texture.name,
                      count);
  }
}

/// Leaves alpha out where every texel is opaque.
void drop_opaque_alpha(Texture& t) {
  const size_t count = t.texels8.size() / 4;
  if (t.channels8 != 4 || count == 0) return;
  for (size_t i = 0; i < count; ++i) {
    if (t.texels8[4 * i + 3] != 255) return;
  }
  std::vector<uint8_t> rgb(3 * count);
  for (size_t i = 0; i < count; ++i) std::copy_n(&t.texels8[4 * i], 3, &rgb[3 * i]);
  t.texels8 = std::move(rgb);
  t.channels8 = 3;
}

}  // namespace

bool TextureDecoding::try_run() {
  if (begun_.test_and_set()) return false;
  decode();
  source_ = Bytes();
  done_.count_down();
  return true;
}

void TextureDecoding::run() {
  if (!try_run()) done_.wait();
}

void TextureDecoding::decode() {
  const auto texture = empty_texture(options_);
  try {
    if (const std::string* path = std::get_if<std::string>(&source_)) {
      if (texture->name.empty()) texture->name = *path;
      options_.name = fmt::format("'{}' (file '{}')", options_.name, *path);
      images::read_file(*path, *texture);
    } else {
      const Bytes& bytes = std::get<Bytes>(source_);
      options_.name = fmt::format("'{}'", options_.name);
      images::read_memory(bytes.data(), bytes.size(), *texture);
    }
    replace_infinite(*texture);
    drop_opaque_alpha(*texture);
    if (const std::string* path = std::get_if<std::string>(&source_)) texture->path = *path;
  } catch (const std::exception& error) {
    failure_ = error.what();
    images::fill_missing(*texture);
  }
  texture_ = texture;
}

void TextureDecoding::report() {
  if (failure_.empty() || reported_) return;
  reported_ = true;
  log::warning("Texture {} is shown in magenta. {}", options_.name, failure_);
}

TextureStore::~TextureStore() {
  for (auto& [id, entry] : entries_) {
    if (entry.decoding) entry.decoding->abandon();
  }
}

void TextureStore::start(const std::shared_ptr<TextureDecoding>& decoding) {
  background_.enqueue([decoding] { decoding->try_run(); });
}

void TextureStore::set_file(uint64_t id, std::string path, const TextureOptions& options) {
  std::weak_ptr<TextureDecoding>& known = files_[key_of(path, options)];
  std::shared_ptr<TextureDecoding> decoding = known.lock();
  if (!decoding || decoding->reported()) {
    known = decoding = std::make_shared<TextureDecoding>(options, std::move(path));
    start(decoding);
  }
  entries_.put(id, {std::move(decoding), nullptr});
}

void TextureStore::set_memory(uint64_t id, std::span<const uint8_t> bytes,
                              const TextureOptions& options) {
  const auto decoding = std::make_shared<TextureDecoding>(
      options, TextureDecoding::Bytes(bytes.begin(), bytes.end()));
  start(decoding);
  entries_.put(id, {decoding, nullptr});
}

void TextureStore::set_pixels8(uint64_t id, int width, int height, std::span<const uint8_t> rgba,
                               const TextureOptions& options) {
  auto texture = empty_texture(options);
  texture->width = width;
  texture->height = height;
  texture->texels8.assign(rgba.begin(), rgba.end());
  entries_.put(id, {nullptr, std::move(texture)});
}

void TextureStore::set_pixels_float(uint64_t id, int width, int height, std::span<const float> rgba,
                                    const TextureOptions& options) {
  auto texture = empty_texture(options);
  texture->width = width;
  texture->height = height;
  texture->texels_float.assign(rgba.begin(), rgba.end());
  replace_infinite(*texture);
  entries_.put(id, {nullptr, std::move(texture)});
}

TextureStore::FileKey TextureStore::key_of(const std::string& path, const TextureOptions& options) {
  FileKey key{.path = path,
              .srgb = options.srgb,
              .nearest = options.nearest,
              .extension = options.extension};
  std::error_code error;
  const auto modified = std::filesystem::last_write_time(path, error);
  if (!error) key.modified = modified.time_since_epoch().count();
  const auto byte_count = std::filesystem::file_size(path, error);
  if (!error) key.byte_count = byte_count;
  return key;
}

void TextureStore::decode(std::span<const uint64_t> ids, const std::function<bool()>& cancelled) {
  std::vector<Entry*> waiting;
  for (const uint64_t id : ids) {
    Entry& entry = *entries_.find(id);
    if (!entry.texture) waiting.push_back(&entry);
  }
  tbb::parallel_for_each(waiting, [&](const Entry* entry) {
    if (cancelled && cancelled()) fail(ErrorCode::cancelled, "The commit was cancelled.");
    entry->decoding->run();
  });
  for (Entry* entry : waiting) {
    entry->decoding->report();
    entry->texture = entry->decoding->texture();
  }
  std::erase_if(files_, [](const auto& known) { return known.second.expired(); });
}

}  // namespace kestrel
