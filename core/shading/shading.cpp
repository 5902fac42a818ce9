// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/shading.h"

#include <cmath>

namespace kestrel {
namespace {

/// A spot's cone: 0 outside, smooth over `blend` of the cone, and within it the falloff to the
/// side.
float spot_factor(const Light& light, const vec3& to_light) {
  const float cosine = -glm::dot(to_light, light.direction);
  if (cosine <= light.cos_outer) return 0.0f;
  const float width = (1.0f - light.cos_outer) * light.blend;
  const float edge =
      width > 0.0f ? glm::smoothstep(0.0f, 1.0f, (cosine - light.cos_outer) / width) : 1.0f;
  return light.exponent > 0.0f ? edge * std::pow(glm::max(cosine, 0.0f), light.exponent) : edge;
}

vec3 blinn_phong(const Surface& s, const vec3& to_viewer, const Light& light,
                 const Incident& incident) {
  const float n_dot_l = glm::dot(s.normal, incident.direction);
  if (n_dot_l <= 0.0f) return vec3(0.0f);
  vec3 reflected = vec3(s.diffuse) * n_dot_l;
  if (max_component(vec3(s.specular)) * light.specular_factor > 0.0f) {
    const vec3 half_way = glm::normalize(incident.direction + to_viewer);
    const float n_dot_h = glm::max(glm::dot(s.normal, half_way), 0.0f);
    const float exponent = 1.0f + 254.0f * s.specular.w;
    reflected += vec3(s.specular) * (light.specular_factor * std::pow(n_dot_h, exponent));
  }
  return reflected * incident.radiance;
}

}  // namespace

bool incident_light(const Light& light, const vec3& position_ws, Incident& incident) {
  if (light.type == LightType::directional) {
    incident = {-light.direction, INFINITY, light.color};
    return true;
  }
  const vec3 to_light = light.position - position_ws;
  const float distance = glm::length(to_light);
  if (!(distance > 0.0f)) return false;
  incident.direction = to_light / distance;
  incident.distance = distance;
  const vec3& a = light.attenuation;
  const float falloff = a.x + distance * (a.y + distance * a.z);
  float factor = falloff > 0.0f ? 1.0f / falloff : 0.0f;
  if (light.type == LightType::spot) factor *= spot_factor(light, incident.direction);
  incident.radiance = light.color * factor;
  return factor > 0.0f;
}

void face_viewer(Surface& surface, const vec3& to_viewer) {
  if (glm::dot(surface.normal_geometric, to_viewer) < 0.0f) {
    surface.normal = -surface.normal;
    surface.normal_geometric = -surface.normal_geometric;
  }
}

vec3 reflect_light(const Settings& settings, const Surface& surface, const vec3& to_viewer,
                   const Light& light, const Incident& incident) {
  switch (settings.shading_model) {
    case ShadingModel::blinn_phong:
      return blinn_phong(surface, to_viewer, light, incident);
  }
  return vec3(0.0f);
}

vec3 unlit(const Settings& settings, const Surface& surface) {
  return surface.emission + settings.ambient * surface.ambient;
}

vec3 lighting_without_shadows(const Scene& scene, const Surface& surface, const vec3& to_viewer) {
  vec3 sum = unlit(scene.settings, surface);
  Incident incident;
  for (const Light& light : scene.lights) {
    if (incident_light(light, surface.position, incident)) {
      sum += reflect_light(scene.settings, surface, to_viewer, light, incident);
    }
  }
  return sum;
}

}  // namespace kestrel
