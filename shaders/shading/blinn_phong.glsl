// SPDX-License-Identifier: GPL-3.0-or-later
// Blinn-Phong reflection: diffuse N.L + specular (N.H)^(1 + 254 A), the maths of
// core/shading/shading.cpp. Another model replaces shade_light() alone.

struct Surface {
  vec3 position;  // world space
  vec3 normal;    // unit, on the viewer's side
  vec4 diffuse;
  vec4 specular;  // A: exponent, 0 ... 1 for 1 ... 255
};

const uint kLightDirectional = 0u;
const uint kLightSpot = 2u;

// Share of a spot's light on a ray whose angle to the axis has this cosine: smooth from the cone's
// edge inwards over `blend` of 1 - cos_outer, and falling off to the side with a power of the cosine.
float spot_factor(GpuLight light, float cosine) {
  if (cosine <= light.cos_outer) return 0.0;
  float width = (1.0 - light.cos_outer) * light.blend;
  float edge = width > 0.0 ? smoothstep(0.0, 1.0, (cosine - light.cos_outer) / width) : 1.0;
  return light.exponent > 0.0 ? edge * pow(max(cosine, 0.0), light.exponent) : edge;
}

// Light that arrives at a point; `to_light` gets the unit direction to where it comes from.
vec3 incident_light(GpuLight light, vec3 position_ws, out vec3 to_light) {
  to_light = -light.direction;
  if (light.type == kLightDirectional) return light.color;
  vec3 offset = light.position - position_ws;
  float distance_m = length(offset);
  if (!(distance_m > 0.0)) return vec3(0.0);
  to_light = offset / distance_m;
  vec3 a = light.attenuation;
  float falloff = a.x + distance_m * (a.y + distance_m * a.z);
  float factor = falloff > 0.0 ? 1.0 / falloff : 0.0;
  if (light.type == kLightSpot) factor *= spot_factor(light, -dot(to_light, light.direction));
  return light.color * factor;
}

// Light of one source that the surface sends to the viewer, nothing shadowed. `to_viewer` unit.
vec3 shade_light(GpuLight light, Surface surface, vec3 to_viewer) {
  vec3 to_light;
  vec3 incident = incident_light(light, surface.position, to_light);
  float n_dot_l = dot(surface.normal, to_light);
  if (n_dot_l <= 0.0) return vec3(0.0);
  vec3 reflected = surface.diffuse.rgb * n_dot_l;
  vec3 specular = surface.specular.rgb * light.specular_factor;
  if (max(specular.r, max(specular.g, specular.b)) > 0.0) {
    vec3 half_way = to_light + to_viewer;
    float squared = dot(half_way, half_way);
    float n_dot_h =
        squared > 0.0 ? max(dot(surface.normal, half_way) * inversesqrt(squared), 0.0) : 0.0;
    reflected += specular * pow(n_dot_h, 1.0 + 254.0 * surface.specular.a);
  }
  return reflected * incident;
}
