// SPDX-License-Identifier: GPL-3.0-or-later
// A material's node program: what computes its properties point by point.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/node_types.h"

namespace kestrel {

/// An output that the program leaves to the material's own value.
inline constexpr int kNodeUnset = INT32_MIN;

struct NodeProgram {
  std::vector<nodes::NodeInstruction> instructions;
  std::vector<vec4> constants;
  std::vector<uint64_t> texture_ids;
  std::vector<uint64_t> attributes;              // of the mesh; 0: its own UVs
  std::array<int, nodes::kNodeOutputs> outputs;  // operands, or kNodeUnset

  std::vector<int> textures;                     // by texture_ids: in Scene::textures
  std::vector<nodes::NodeInstruction> coverage;  // those that decide what light gets through
  bool reads_tangent = false;

  bool computes(int output) const { return outputs[output] != kNodeUnset; }
  /// Whether an output may be other than 0.
  bool may_be_lit(int output) const;
};

/// Throws Error(invalid_argument) that names the material where a number is out of its range or a
/// constant not finite; fills what is derived, but for `textures`.
void check_program(NodeProgram& program, const std::string& material);

}  // namespace kestrel
