// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/array_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "scene/scene_file_words.h"

namespace kestrel {

static_assert(std::endian::native == std::endian::little);

ArrayFile::ArrayFile(const std::string& path) : file_(path) {
  piece_.reserve(kSceneBufferPiece);
}

ArrayFile::Json ArrayFile::append(const void* values, size_t count, size_t bytes_each) {
  Json place = {{"offset", size_}, {"count", count}};
  append_bytes(values, count * bytes_each);
  static constexpr char kPadding[4] = {};
  append_bytes(kPadding, (4 - size_ % 4) % 4);
  return place;
}

void ArrayFile::append_bytes(const void* data, size_t byte_count) {
  const auto* bytes = static_cast<const uint8_t*>(data);
  size_ += byte_count;
  while (byte_count > 0) {
    const size_t part = std::min(byte_count, kSceneBufferPiece - piece_.size());
    piece_.insert(piece_.end(), bytes, bytes + part);
    bytes += part;
    byte_count -= part;
    if (piece_.size() == kSceneBufferPiece) end_piece();
  }
}

void ArrayFile::end_piece() {
  if (piece_.empty()) return;
  hash_ = hash_bytes(piece_, hash_);
  file_.write(piece_.data(), piece_.size());
  piece_.clear();
}

ArrayFile::Json ArrayFile::close() {
  end_piece();
  file_.close();
  return {{"bytes", size_}, {"hash", fmt::format("{:016x}{:016x}", hash_.high, hash_.low)}};
}

}  // namespace kestrel
