// SPDX-License-Identifier: GPL-3.0-or-later
// A matrix taken apart, so that what lies between two of them turns instead of shrinking.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "base/math.h"

namespace kestrel {

/// The matrix is rotation * stretch, then the translation.
struct Pose {
  vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  mat3 stretch{1.0f};  // scale and shear; symmetric
};

/// Where something is at even steps of time, two or more.
using ObjectMotion = std::vector<Pose>;

/// Takes matrices apart for in_between(). Where one of them has no inverse, none is: those in
/// between are then weighted means.
ObjectMotion poses_from(const std::vector<mat4x3>& matrices);

/// The matrix at a time of 0…1 from the first to the last of the poses.
mat4x3 in_between(const ObjectMotion& poses, float time);

/// A place in a row of `count` states, two or more, at even steps of time.
struct Step {
  size_t index;  // of the state before
  float share;   // 0…1 of the way to the next
};

inline Step step_at(size_t count, float time) {
  const float place = glm::clamp(time, 0.0f, 1.0f) * static_cast<float>(count - 1);
  const size_t index = glm::min(static_cast<size_t>(place), count - 2);
  return {index, place - static_cast<float>(index)};
}

}  // namespace kestrel
