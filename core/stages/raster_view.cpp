// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/raster_view.h"

#include "frame/lens.h"

namespace kestrel {
namespace {

mat4 square(const mat4x3& m) {
  return mat4(vec4(m[0], 0.0f), vec4(m[1], 0.0f), vec4(m[2], 0.0f), vec4(m[3], 1.0f));
}

/// Columns of the projection; z' / w' runs from 1 at -near to 0 at -far.
glm::dmat4 clip_from_camera(const Camera& camera) {
  const double l = camera.left, r = camera.right, b = camera.bottom, t = camera.top;
  const double n = camera.near_clip, f = camera.far_clip;
  const double sx = 2.0 / (r - l), sy = 2.0 / (t - b);
  const double shift_x = (r + l) / (r - l), shift_y = (t + b) / (t - b);
  glm::dmat4 m(0.0);
  m[0][0] = sx;
  m[1][1] = sy;
  if (camera.projection == Projection::perspective) {
    m[2] = {shift_x, shift_y, n / (f - n), -1.0};
    m[3] = {0.0, 0.0, n * f / (f - n), 0.0};
  } else {
    m[2][2] = 1.0 / (f - n);
    m[3] = {-shift_x, -shift_y, f / (f - n), 1.0};
  }
  return m;
}

/// The pinhole camera of the frame's sample.
Camera sample_camera(const Scene& scene, const FrameInputs& inputs) {
  if (!inputs.lens.open) return scene.camera;
  return seen_through(scene.camera, aperture_point(scene.camera, inputs.lens, 0, 0));
}

/// Moves the picture by -subpixel pixels: clip x and y by a share of w.
glm::dmat4 subpixel_shift(const FrameInputs& inputs) {
  glm::dmat4 m(1.0);
  m[3][0] = -2.0 * inputs.subpixel.x / inputs.width;
  m[3][1] = -2.0 * inputs.subpixel.y / inputs.height;
  return m;
}

}  // namespace

glm::dmat4 clip_from_world(const Scene& scene, const FrameInputs& inputs) {
  const Camera camera = sample_camera(scene, inputs);
  const glm::dmat4 world_from_camera(square(camera.world_from_camera));
  return subpixel_shift(inputs) * clip_from_camera(camera) * glm::inverse(world_from_camera);
}

bool may_be_visible(const Bounds& b, const glm::dmat4& clip_from_world) {
  if (b.empty()) return false;
  bool all_outside[6] = {true, true, true, true, true, true};
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 corner((i & 1) ? b.upper.x : b.lower.x, (i & 2) ? b.upper.y : b.lower.y,
                            (i & 4) ? b.upper.z : b.lower.z, 1.0);
    const glm::dvec4 c = clip_from_world * corner;
    // The shader works in float32: what is outside by less than its rounding is kept.
    const double slack = 1e-4 * (glm::abs(c.x) + glm::abs(c.y) + glm::abs(c.w)) + 1e-6;
    const double inside[6] = {c.w + c.x, c.w - c.x, c.w + c.y, c.w - c.y, c.z, c.w - c.z};
    for (int p = 0; p < 6; ++p) all_outside[p] &= inside[p] < -slack;
  }
  for (const bool outside : all_outside) {
    if (outside) return false;
  }
  return true;
}

gpu::GpuFrame gpu_frame(const Scene& scene, const FrameInputs& inputs) {
  gpu::GpuFrame out{};
  const Camera camera = sample_camera(scene, inputs);
  out.clip_from_world = mat4(clip_from_world(scene, inputs));
  out.world_from_camera = square(camera.world_from_camera);
  if (inputs.lens.open) out.world_from_camera[2] = glm::normalize(out.world_from_camera[2]);
  out.map_from_world = mat4(scene.world.map_from_world);
  out.window = vec4(camera.left, camera.right, camera.bottom, camera.top);
  out.picture_size = vec2(inputs.width, inputs.height);
  out.subpixel = inputs.subpixel;
  out.ambient = scene.settings.ambient;
  out.environment_ior = scene.settings.environment_ior;
  out.world_color = scene.world.color;
  out.world_kind = static_cast<uint32_t>(scene.world.kind);
  out.orthographic = camera.projection == Projection::orthographic;
  out.light_count = static_cast<uint32_t>(scene.lights.size());
  return out;
}

}  // namespace kestrel
