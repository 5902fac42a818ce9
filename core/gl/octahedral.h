// SPDX-License-Identifier: GPL-3.0-or-later
// Unit vectors as two numbers in [-1, 1]: the octahedron |x| + |y| + |z| = 1 unfolded into a
// square. shaders/common/octahedral.glsl holds the same pair.
#pragma once

#include <cmath>

#include "base/math.h"

namespace kestrel::gl {

inline vec2 fold_octahedron(const vec2& p) {
  return {std::copysign(1.0f - std::abs(p.y), p.x), std::copysign(1.0f - std::abs(p.x), p.y)};
}

/// `n` must not be zero.
inline vec2 encode_octahedral(const vec3& n) {
  const vec2 p = vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  return n.z < 0.0f ? fold_octahedron(p) : p;
}

inline vec3 decode_octahedral(const vec2& e) {
  const float z = 1.0f - std::abs(e.x) - std::abs(e.y);
  const vec2 p = z < 0.0f ? fold_octahedron(e) : e;
  return glm::normalize(vec3(p, z));
}

}  // namespace kestrel::gl
