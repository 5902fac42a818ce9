// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/scene_buffer.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "kestrel/kestrel.h"
#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

constexpr size_t kMaximumNumbers = 300'000'000;  // in one array of the scene file

std::string hash_of(const std::vector<uint8_t>& data) {
  uint64_t hash[2] = {};
  for (size_t begin = 0; begin < data.size(); begin += kSceneBufferPiece) {
    kestrelHash(&data[begin], std::min(kSceneBufferPiece, data.size() - begin), hash);
  }
  return fmt::format("{:016x}{:016x}", hash[1], hash[0]);
}

std::vector<uint32_t> indices_in(const JsonNode& node, uint32_t end) {
  std::vector<uint32_t> out;
  const std::vector<float> check = node.numbers(0, kMaximumNumbers, 0, end - 1.0);
  out.reserve(check.size());
  for (size_t i = 0; i < check.size(); ++i) {
    const nlohmann::json& item = node.value()[i];
    if (!item.is_number_integer()) {
      JsonNode(node.file(), item, fmt::format("{}/{}", node.pointer(), i))
          .integer(0, static_cast<int>(end) - 1);
    }
    out.push_back(item.get<uint32_t>());
  }
  return out;
}

}  // namespace

SceneBuffer::SceneBuffer(const JsonNode& node) {
  node.expect_keys({"bytes", "hash"});
  const uint64_t size = node.require("bytes").whole();
  const std::string hash = node.require("hash").text();
  const std::string path = scene_buffer_path(node.file());
  std::error_code error;
  const uintmax_t there = std::filesystem::file_size(path, error);
  if (error) {
    node.fail("'{}' is missing, which holds the scene's arrays; keep both files together", path);
  }
  if (there != size) {
    node.fail("'{}' has {} bytes instead of {}; it belongs to another scene file", path, there,
              size);
  }
  data_.resize(size);
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(data_.data()), static_cast<std::streamsize>(size));
  if (!stream) node.fail("'{}' cannot be read", path);
  if (hash_of(data_) != hash) {
    node.fail("'{}' is damaged or belongs to another scene file; write the scene again", path);
  }
}

template <typename T>
std::vector<T> SceneBuffer::values_at(const JsonNode& place) const {
  place.expect_keys({"offset", "count"});
  const uint64_t offset = place.require("offset").whole();
  const uint64_t count = place.require("count").whole();
  if (offset > data_.size() || count > (data_.size() - offset) / sizeof(T)) {
    place.fail("ends after the {} bytes of the scene's arrays", data_.size());
  }
  std::vector<T> out(count);
  if (count) std::memcpy(out.data(), &data_[offset], count * sizeof(T));
  return out;
}

std::vector<float> SceneBuffer::floats(const JsonNode& node, double minimum, double maximum) const {
  if (node.value().is_object()) return values_at<float>(node);
  return node.numbers(0, kMaximumNumbers, minimum, maximum);
}

std::vector<uint32_t> SceneBuffer::indices(const JsonNode& node, uint32_t end) const {
  if (!node.value().is_object()) return indices_in(node, end);
  std::vector<uint32_t> out = values_at<uint32_t>(node);
  const auto beyond = std::find_if(out.begin(), out.end(), [end](uint32_t i) { return i >= end; });
  if (beyond != out.end()) node.fail("holds {}; expected numbers below {}", *beyond, end);
  return out;
}

std::vector<uint8_t> SceneBuffer::bytes(const JsonNode& node) const {
  return values_at<uint8_t>(node);
}

}  // namespace kestrel::cli
