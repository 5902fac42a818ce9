// SPDX-License-Identifier: GPL-3.0-or-later
// The file of arrays beside a scene file, and arrays wherever they stand.
#pragma once

#include <cstdint>
#include <vector>

#include "cli/json_node.h"

namespace kestrel::cli {

/// Arrays that a scene file holds itself, or says the place of: {"offset": bytes, "count": values}.
class SceneBuffer {
 public:
  SceneBuffer() = default;
  /// Reads the file that belongs to the scene file of `node`, which says its size and hash.
  explicit SceneBuffer(const JsonNode& node);

  /// Numbers of an array in the scene file lie within [minimum, maximum]; others are as they are.
  std::vector<float> floats(const JsonNode& node, double minimum, double maximum) const;
  /// Each below `end`.
  std::vector<uint32_t> indices(const JsonNode& node, uint32_t end) const;
  /// Only of a place.
  std::vector<uint8_t> bytes(const JsonNode& node) const;

 private:
  template <typename T>
  std::vector<T> values_at(const JsonNode& place) const;

  std::vector<uint8_t> data_;
};

}  // namespace kestrel::cli
