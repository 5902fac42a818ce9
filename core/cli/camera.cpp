// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/camera.h"

#include <algorithm>

namespace kestrel::cli {
namespace {

using glm::dvec3;

KestrelCamera with_window(const CameraDescription& camera, const mat4x3& world_from_camera,
                          int width, int height) {
  const bool horizontal =
      camera.fit == CameraFit::horizontal || (camera.fit == CameraFit::larger && width >= height);
  const float fitted = static_cast<float>(horizontal ? width : height);
  const vec2 half = 0.5f * camera.extent * vec2(width, height) / fitted;
  const vec2 center = camera.shift * camera.extent;
  KestrelCamera out{};
  out.projection = camera.projection;
  out.left = center.x - half.x;
  out.right = center.x + half.x;
  out.bottom = center.y - half.y;
  out.top = center.y + half.y;
  if (camera.window) {
    const vec4& window = *camera.window;
    out.left = window.x, out.right = window.y, out.bottom = window.z, out.top = window.w;
  }
  out.near_clip = camera.near_clip;
  out.far_clip = camera.far_clip;
  out.aperture_radius = camera.aperture_radius;
  out.focus_distance = camera.focus_distance;
  out.aperture_blades = camera.aperture_blades;
  out.aperture_rotation = camera.aperture_rotation;
  out.aperture_ratio = camera.aperture_ratio;
  for (int i = 0; i < 12; ++i) out.world_from_camera[i] = world_from_camera[i / 3][i % 3];
  return out;
}

/// Slope of `field` at key `i`, per second: from its neighbours, one-sided at the ends.
dvec3 tangent(const std::vector<CameraKey>& keys, size_t i, vec3 CameraKey::*field) {
  const CameraKey& before = keys[i == 0 ? 0 : i - 1];
  const CameraKey& after = keys[std::min(i + 1, keys.size() - 1)];
  return (dvec3(after.*field) - dvec3(before.*field)) / (after.time - before.time);
}

/// `s` 0…1 between keys `i` and `i + 1`.
vec3 interpolated(const std::vector<CameraKey>& keys, size_t i, double s, vec3 CameraKey::*field) {
  const double span = keys[i + 1].time - keys[i].time;
  const dvec3 p0(keys[i].*field), p1(keys[i + 1].*field);
  const dvec3 m0 = tangent(keys, i, field) * span, m1 = tangent(keys, i + 1, field) * span;
  const double s2 = s * s, s3 = s2 * s;
  return vec3((2 * s3 - 3 * s2 + 1) * p0 + (s3 - 2 * s2 + s) * m0 + (3 * s2 - 2 * s3) * p1 +
              (s3 - s2) * m1);
}

}  // namespace

mat4x3 world_from_camera_looking(const vec3& position, const vec3& look_at, const vec3& up) {
  const vec3 back = glm::normalize(position - look_at);
  vec3 right = glm::cross(up, back);
  if (glm::dot(right, right) < 1e-10f * glm::dot(up, up)) {
    right = glm::cross(std::abs(back.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0), back);
  }
  right = glm::normalize(right);
  return mat4x3(right, glm::cross(back, right), back, position);
}

KestrelCamera camera_for(const CameraDescription& camera, int width, int height) {
  return with_window(camera, camera.world_from_camera, width, height);
}

KestrelCamera camera_on_path(const CameraDescription& camera, double fraction, int width,
                             int height) {
  const std::vector<CameraKey>& keys = camera.path;
  const double start = keys.front().time;
  const double time = start + std::clamp(fraction, 0.0, 1.0) * (keys.back().time - start);
  size_t i = 0;
  while (i + 2 < keys.size() && keys[i + 1].time <= time) ++i;
  const double s = (time - keys[i].time) / (keys[i + 1].time - keys[i].time);
  const vec3 position = interpolated(keys, i, s, &CameraKey::position);
  vec3 look_at = interpolated(keys, i, s, &CameraKey::look_at);
  if (position == look_at) look_at = position + vec3(0.0f, 1.0f, 0.0f);
  return with_window(camera, world_from_camera_looking(position, look_at, camera.up), width,
                     height);
}

}  // namespace kestrel::cli
