// SPDX-License-Identifier: GPL-3.0-or-later
// The vector types of the whole core. World space is Blender's: right-handed, Z up, metres.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace kestrel {

using glm::ivec2;
using glm::mat3;
using glm::mat4;
using glm::mat4x3;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float kPi = 3.14159265358979323846f;

/// Relative luminance of a linear Rec. 709 colour.
inline float luminance(const vec3& rgb) {
  return glm::dot(rgb, vec3(0.2126f, 0.7152f, 0.0722f));
}

/// `v` as a unit vector. One that is unit but for rounding stays as it is: what was normalised once
/// keeps its bits. Not for zero.
inline vec3 normalized(const vec3& v) {
  const float squared = glm::dot(v, v);
  return std::abs(squared - 1.0f) <= 1e-6f ? v : v / std::sqrt(squared);
}

inline float max_component(const vec3& v) {
  return glm::max(v.x, glm::max(v.y, v.z));
}

inline bool is_finite(const vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Axis-aligned box; empty while `lower > upper`.
struct Bounds {
  vec3 lower{INFINITY};
  vec3 upper{-INFINITY};

  void extend(const vec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  void extend(const Bounds& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }
  bool empty() const { return lower.x > upper.x; }
  vec3 center() const { return 0.5f * (lower + upper); }
};

/// The box around `b` after `m`; empty stays empty.
inline Bounds transformed(const Bounds& b, const mat4x3& m) {
  Bounds out;
  if (b.empty()) return out;
  for (int i = 0; i < 8; ++i) {
    const vec3 corner((i & 1) ? b.upper.x : b.lower.x, (i & 2) ? b.upper.y : b.lower.y,
                      (i & 4) ? b.upper.z : b.lower.z);
    out.extend(m * vec4(corner, 1.0f));
  }
  return out;
}

}  // namespace kestrel
