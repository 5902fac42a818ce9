// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/lens.h"

#include <cmath>

namespace kestrel {
namespace {

/// The unit disk: squares around the middle become circles.
vec2 disk_point(const vec2& square) {
  const vec2 p = 2.0f * square - 1.0f;
  if (p == vec2(0.0f)) return p;
  const bool wide = std::abs(p.x) > std::abs(p.y);
  const float radius = wide ? p.x : p.y;
  const float angle = wide ? kPi / 4.0f * (p.y / p.x) : kPi / 2.0f - kPi / 4.0f * (p.x / p.y);
  return radius * vec2(std::cos(angle), std::sin(angle));
}

/// A regular polygon with its corners on the unit circle, the middle of one side at `rotation`.
vec2 polygon_point(int corners, float rotation, const vec2& square) {
  const float scaled = square.x * static_cast<float>(corners);
  const float side = glm::min(std::floor(scaled), static_cast<float>(corners - 1));
  const float outwards = std::sqrt(scaled - side);  // 0 in the centre, 1 on the side
  const float half_angle = kPi / static_cast<float>(corners);
  const vec2 on_side(std::cos(half_angle), std::sin(half_angle) * (2.0f * square.y - 1.0f));
  const float turn = rotation + 2.0f * half_angle * side;
  const float c = std::cos(turn), s = std::sin(turn);
  return outwards * vec2(c * on_side.x - s * on_side.y, s * on_side.x + c * on_side.y);
}

/// Two numbers of 0…1 that differ from pixel to pixel without a pattern.
vec2 pixel_shift(int x, int y) {
  uint32_t a = static_cast<uint32_t>(x) * 0x9e3779b1u ^ static_cast<uint32_t>(y) * 0x85ebca77u;
  const auto next = [&a] {
    a = (a ^ (a >> 15)) * 0x2c1b3c6du;
    a = (a ^ (a >> 12)) * 0x297a2d39u;
    a ^= a >> 15;
    return static_cast<float>(a >> 8) * 0x1p-24f;
  };
  const float u = next();
  return {u, next()};
}

}  // namespace

vec2 aperture_point(const Camera& camera, const vec2& square) {
  vec2 p = camera.aperture_blades < 3
               ? disk_point(square)
               : polygon_point(camera.aperture_blades, camera.aperture_rotation, square);
  p.x /= camera.aperture_ratio;
  return p * camera.aperture_radius;
}

vec2 aperture_point(const Camera& camera, const LensSample& sample, int x, int y) {
  if (!sample.open) return vec2(0.0f);
  return aperture_point(camera,
                        sample.per_pixel ? glm::fract(sample.at + pixel_shift(x, y)) : sample.at);
}

Camera seen_through(const Camera& camera, const vec2& point) {
  Camera out = camera;
  mat4x3& m = out.world_from_camera;
  const vec3 across = point.x * m[0] + point.y * m[1];
  const vec2 slope = point / camera.focus_distance;
  m[3] += across;
  if (camera.projection == Projection::orthographic) {
    m[2] += across / camera.focus_distance;
  } else {
    out.left -= slope.x;
    out.right -= slope.x;
    out.bottom -= slope.y;
    out.top -= slope.y;
  }
  return out;
}

}  // namespace kestrel
