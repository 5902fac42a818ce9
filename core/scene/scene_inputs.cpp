// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_inputs.h"

#include <cfloat>
#include <cmath>

#include "base/error.h"
#include "base/log.h"

namespace kestrel {
namespace {

/// Checks the numbers of one item, which messages call `item`.
class Checker {
 public:
  explicit Checker(std::string item) : item_(std::move(item)) {}

  void finite(const char* field, const float* values, int count) const {
    for (int i = 0; i < count; ++i) {
      if (std::isfinite(values[i])) continue;
      fail(ErrorCode::invalid_argument, "{}: '{}' is {}. Give it finite numbers.", item_, field,
           values[i]);
    }
  }
  void finite(const char* field, const float& v) const { finite(field, &v, 1); }
  void finite(const char* field, const vec2& v) const { finite(field, &v[0], 2); }
  void finite(const char* field, const vec3& v) const { finite(field, &v[0], 3); }
  void finite(const char* field, const vec4& v) const { finite(field, &v[0], 4); }

  void clamp(const char* field, float& v, float lower, float upper) const {
    if (v >= lower && v <= upper) return;
    const float clamped = glm::clamp(v, lower, upper);
    log::warning_once("{}: '{}' is {}, outside {} to {}; {} is used.", item_, field, v, lower,
                      upper, clamped);
    v = clamped;
  }

  [[noreturn]] void refuse(const char* what) const {
    fail(ErrorCode::invalid_argument, "{}: {}.", item_, what);
  }

 private:
  std::string item_;
};

/// Whether the axes are unit and at right angles, but for rounding.
bool is_rigid(const mat3& m) {
  const mat3 product = glm::transpose(m) * m;
  for (int i = 0; i < 9; ++i) {
    if (std::abs(product[i / 3][i % 3] - (i % 4 == 0 ? 1.0f : 0.0f)) > 2e-6f) return false;
  }
  return true;
}

float column_product(const mat4x3& m) {
  return glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
}

}  // namespace

int texture_count(WorldKind kind) {
  switch (kind) {
    case WorldKind::color:
      return 0;
    case WorldKind::equirectangular:
      return 1;
    case WorldKind::cube:
      return 6;
  }
  return 0;
}

void check_material(MaterialInput& input) {
  Material& m = input.values;
  const Checker check(fmt::format("Material '{}'", m.name));
  check.finite("emission", m.emission);
  check.finite("ambient", m.ambient);
  check.finite("diffuse", m.diffuse);
  check.finite("specular", m.specular);
  check.finite("optical", m.optical);
  check.finite("reflection_color", m.reflection_color);
  check.finite("transmission_color", m.transmission_color);
  check.finite("normal_strength", m.normal_strength);
  check.finite("tiling", m.tiling);
  check.finite("offset", m.offset);
  check.finite("alpha_cutoff", m.alpha_cutoff);
  check.clamp("alpha", m.diffuse.w, 0.0f, 1.0f);
  check.clamp("specular exponent", m.specular.w, 0.0f, 1.0f);
  check.clamp("reflectivity", m.optical.x, 0.0f, 1.0f);
  check.clamp("index of refraction", m.optical.y, 0.1f, 10.0f);
  check.clamp("opacity", m.optical.z, 0.0f, 1.0f);
  check.clamp("alpha_cutoff", m.alpha_cutoff, 0.0f, 1.0f);
}

Light checked_light(LightInput input) {
  Light light = std::move(input.values);
  const Checker check(fmt::format("Light '{}'", light.name));
  check.finite("color", light.color);
  check.finite("position", light.position);
  check.finite("direction", light.direction);
  check.finite("attenuation", light.attenuation);
  check.finite("spot_angle", input.spot_angle);
  check.finite("spot_blend", light.blend);
  check.finite("spot_exponent", light.exponent);
  check.finite("specular_factor", light.specular_factor);
  const vec3& a = light.attenuation;
  const bool reaches = light.type == LightType::directional ||
                       (glm::min(a.x, glm::min(a.y, a.z)) >= 0.0f && a.x + a.y + a.z > 0.0f);
  if (!reaches) {
    check.refuse("'attenuation' must not be negative nor all zero; {0, 0, 1} is physical");
  }
  if (light.type != LightType::point) {
    const float length = glm::length(light.direction);
    if (!(length > 0.0f && std::isfinite(length))) {
      check.refuse("'direction' has no direction; give it the way the light travels");
    }
    light.direction = normalized(light.direction);
  }
  check.clamp("spot_blend", light.blend, 0.0f, 1.0f);
  check.clamp("spot_exponent", light.exponent, 0.0f, 128.0f);
  check.clamp("spot_angle", input.spot_angle, 0.0f, kPi);
  light.spot_angle = input.spot_angle;
  light.cos_outer = std::cos(0.5f * input.spot_angle);
  return light;
}

void check_matrix(const mat4x3& matrix, const std::string& item, const char* field) {
  Checker(item).finite(field, &matrix[0][0], 12);
}

Camera checked_camera(Camera camera) {
  const Checker check("The camera");
  check_matrix(camera.world_from_camera, "The camera", "world_from_camera");
  check.finite("left", camera.left);
  check.finite("right", camera.right);
  check.finite("bottom", camera.bottom);
  check.finite("top", camera.top);
  check.finite("near_clip", camera.near_clip);
  check.finite("far_clip", camera.far_clip);
  check.finite("focus_distance", camera.focus_distance);
  check.finite("aperture_radius", camera.aperture_radius);
  check.finite("aperture_rotation", camera.aperture_rotation);
  check.finite("aperture_ratio", camera.aperture_ratio);
  if (!(camera.left < camera.right && camera.bottom < camera.top)) {
    check.refuse("its window is empty; left must be below right, and bottom below top");
  }
  if (!(camera.near_clip < camera.far_clip)) check.refuse("near_clip must be below far_clip");
  if (camera.projection == Projection::perspective && !(camera.near_clip > 0.0f)) {
    check.refuse("near_clip must be above 0 in perspective");
  }
  if (camera.aperture_radius > 0.0f) {
    check.clamp("focus_distance", camera.focus_distance, 1e-5f, 1e9f);
    check.clamp("aperture_ratio", camera.aperture_ratio, 0.01f, 100.0f);
  }
  mat4x3& m = camera.world_from_camera;
  if (!invertible(m)) check.refuse("'world_from_camera' has no inverse; give it a scale of 1");
  if (is_rigid(mat3(m))) return camera;
  const bool mirrored = glm::determinant(mat3(m)) < 0.0f;
  const vec3 z = glm::normalize(m[2]);
  const vec3 x = glm::normalize(m[0] - z * glm::dot(z, m[0]));
  m[0] = x;
  m[1] = glm::cross(z, x) * (mirrored ? -1.0f : 1.0f);
  m[2] = z;
  return camera;
}

void check_world(const WorldInput& input) {
  const Checker check("The world");
  check.finite("color", input.values.color);
  check.finite("mist_start", input.values.mist.start);
  check.finite("mist_depth", input.values.mist.depth);
  check.finite("mist_falloff", input.values.mist.falloff);
  const int count = texture_count(input.values.kind);
  if (count == 0) return;
  for (int i = 0; i < 3; ++i) check.finite("map_from_world", input.values.map_from_world[i]);
  if (std::abs(glm::determinant(input.values.map_from_world)) < 1e-6f) {
    check.refuse("'map_from_world' is no rotation; {1,0,0, 0,1,0, 0,0,1} turns nothing");
  }
  for (int i = 0; i < count; ++i) {
    if (input.textures[i] == 0) {
      check.refuse(count == 1 ? "an equirectangular world needs textures[0]"
                              : "a cube world needs six textures");
    }
  }
}

bool invertible(const mat4x3& matrix) {
  const float determinant = std::abs(glm::determinant(mat3(matrix)));
  if (!(determinant >= FLT_MIN && determinant <= FLT_MAX)) return false;
  // Below, the determinant is only rounding.
  return determinant > 1e-6f * column_product(matrix);
}

}  // namespace kestrel
