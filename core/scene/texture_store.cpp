// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/texture_store.h"

#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <cmath>

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

void TextureStore::set_file(uint64_t id, std::string path, const TextureOptions& options) {
  entries_.put(id, {options, File{std::move(path)}, nullptr});
}

void TextureStore::set_memory(uint64_t id, std::span<const uint8_t> bytes,
                              const TextureOptions& options) {
  entries_.put(
      id,
      {options, std::make_shared<const std::vector<uint8_t>>(bytes.begin(), bytes.end()), nullptr});
}

void TextureStore::set_pixels8(uint64_t id, int width, int height, std::span<const uint8_t> rgba,
                               const TextureOptions& options) {
  auto texture = empty_texture(options);
  texture->width = width;
  texture->height = height;
  texture->texels8.assign(rgba.begin(), rgba.end());
  entries_.put(id, {options, std::monostate{}, std::move(texture)});
}

void TextureStore::set_pixels_float(uint64_t id, int width, int height, std::span<const float> rgba,
                                    const TextureOptions& options) {
  auto texture = empty_texture(options);
  texture->width = width;
  texture->height = height;
  texture->texels_float.assign(rgba.begin(), rgba.end());
  replace_infinite(*texture);
  entries_.put(id, {options, std::monostate{}, std::move(texture)});
}

TextureStore::FileKey TextureStore::key_of(const Entry& entry) {
  FileKey key{.path = std::get<File>(entry.source).path,
              .srgb = entry.options.srgb,
              .nearest = entry.options.nearest,
              .extension = entry.options.extension};
  std::error_code error;
  const auto modified = std::filesystem::last_write_time(key.path, error);
  if (!error) key.modified = modified.time_since_epoch().count();
  const auto byte_count = std::filesystem::file_size(key.path, error);
  if (!error) key.byte_count = byte_count;
  return key;
}

std::vector<TextureStore::Job> TextureStore::jobs_for(std::span<const uint64_t> ids) {
  std::vector<Job> jobs;
  std::map<FileKey, size_t> job_of_file;
  for (const uint64_t id : ids) {
    Entry& entry = *entries_.find(id);
    if (entry.texture) continue;
    if (!std::holds_alternative<File>(entry.source)) {
      jobs.emplace_back(entry).waiting.push_back(&entry);
      continue;
    }
    const FileKey key = key_of(entry);
    const auto known = decoded_.find(key);
    if (known != decoded_.end() && (entry.texture = known->second.lock())) continue;
    const auto [place, added] = job_of_file.emplace(key, jobs.size());
    if (added) jobs.emplace_back(entry).key = key;
    jobs[place->second].waiting.push_back(&entry);
  }
  return jobs;
}

void TextureStore::run(Job& job) {
  const auto texture = empty_texture(job.first->options);
  try {
    if (const File* file = std::get_if<File>(&job.first->source)) {
      if (texture->name.empty()) texture->name = file->path;
      images::read_file(file->path, *texture);
    } else {
      const auto& bytes = *std::get<Bytes>(job.first->source);
      images::read_memory(bytes.data(), bytes.size(), *texture);
    }
    replace_infinite(*texture);
    drop_opaque_alpha(*texture);
  } catch (const Error& error) {
    job.failure = error.what();
    images::fill_missing(*texture);
  }
  job.texture = texture;
}

void TextureStore::decode(std::span<const uint64_t> ids) {
  std::vector<Job> jobs = jobs_for(ids);
  tbb::parallel_for_each(jobs, run);
  for (Job& job : jobs) {
    if (!job.failure.empty()) {
      const File* file = std::get_if<File>(&job.first->source);
      log::warning("Texture '{}'{} is shown in magenta. {}", job.first->options.name,
                   file ? fmt::format(" (file '{}')", file->path) : "", job.failure);
    } else if (job.key) {
      decoded_[*job.key] = job.texture;
    }
    for (Entry* entry : job.waiting) {
      entry->texture = job.texture;
      if (std::holds_alternative<Bytes>(entry->source)) entry->source = std::monostate{};
    }
  }
  std::erase_if(decoded_, [](const auto& known) { return known.second.expired(); });
}

}  // namespace kestrel
