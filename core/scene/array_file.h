// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a scene file's arrays, as it is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "base/hash.h"
#include "base/math.h"
#include "base/whole_file.h"

namespace kestrel {

/// Arrays one after the other, each at a multiple of 4 bytes. Throws Error(file).
class ArrayFile {
 public:
  using Json = nlohmann::ordered_json;

  explicit ArrayFile(const std::string& path);

  /// Appends numbers, or the numbers of vectors, and returns what the scene file says of their
  /// place.
  template <typename T>
  Json add(const std::vector<T>& values) {
    if constexpr (std::is_arithmetic_v<T>) {
      return append(values.data(), values.size(), sizeof(T));
    } else {
      constexpr auto kLength = static_cast<size_t>(T::length());
      using Number = typename T::value_type;
      static_assert(sizeof(T) == kLength * sizeof(Number));
      return append(values.data(), values.size() * kLength, sizeof(Number));
    }
  }

  /// Nothing is added any more; what the scene file says of the whole.
  Json close();
  /// After close(): the file appears.
  void publish() { file_.publish(); }

 private:
  Json append(const void* values, size_t count, size_t bytes_each);
  void append_bytes(const void* data, size_t byte_count);
  void end_piece();

  WholeFile file_;
  std::vector<uint8_t> piece_;  // not yet written
  size_t size_ = 0;             // bytes
  Hash128 hash_;
};

}  // namespace kestrel
