// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/pose.h"

#include <algorithm>

#include "scene/scene_inputs.h"

namespace kestrel {
namespace {

/// The rotation nearest to a matrix (polar decomposition by Newton's iteration); it mirrors where
/// the matrix does.
glm::dmat3 nearest_rotation(const glm::dmat3& matrix) {
  constexpr int kMaxIterations = 100;
  glm::dmat3 r = matrix;
  for (int i = 0; i < kMaxIterations; ++i) {
    const glm::dmat3 next = 0.5 * (r + glm::transpose(glm::inverse(r)));
    double change = 0.0;
    for (int c = 0; c < 3; ++c) change = std::max(change, glm::length(next[c] - r[c]));
    r = next;
    if (change < 1e-12) break;
  }
  return r;
}

Pose pose_from(const mat4x3& matrix) {
  const glm::dmat3 linear{mat3(matrix)};
  glm::dmat3 rotation = nearest_rotation(linear);
  if (glm::determinant(rotation) < 0.0) rotation = -rotation;
  return {matrix[3], glm::quat(glm::normalize(glm::dquat(rotation))),
          mat3(glm::transpose(rotation) * linear)};
}

}  // namespace

ObjectMotion poses_from(const std::vector<mat4x3>& matrices) {
  ObjectMotion poses;
  const bool sound = std::all_of(matrices.begin(), matrices.end(), invertible);
  for (const mat4x3& m : matrices) {
    Pose pose = sound ? pose_from(m) : Pose{m[3], Pose().rotation, mat3(m)};
    if (!poses.empty() && glm::dot(poses.back().rotation, pose.rotation) < 0.0f) {
      pose.rotation = -pose.rotation;  // the same rotation, the short way
    }
    poses.push_back(pose);
  }
  return poses;
}

mat4x3 in_between(const ObjectMotion& poses, float time) {
  const Step step = step_at(poses.size(), time);
  const Pose &a = poses[step.index], &b = poses[step.index + 1];
  const float s = step.share;
  const mat3 stretch = a.stretch * (1.0f - s) + b.stretch * s;
  const mat3 linear = glm::mat3_cast(glm::slerp(a.rotation, b.rotation, s)) * stretch;
  return mat4x3(linear[0], linear[1], linear[2], glm::mix(a.translation, b.translation, s));
}

}  // namespace kestrel
