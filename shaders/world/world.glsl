// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance of the world in a direction: the formulas of core/scene/world.h, read at level 0. Needs
// common/frame.glsl. A face without a texture shows the plain colour.

layout(binding = 7) uniform sampler2D world_texture_0;  // equirectangular, or +X
layout(binding = 8) uniform sampler2D world_texture_1;  // -X
layout(binding = 9) uniform sampler2D world_texture_2;  // +Y
layout(binding = 10) uniform sampler2D world_texture_3;  // -Y
layout(binding = 11) uniform sampler2D world_texture_4;  // +Z
layout(binding = 12) uniform sampler2D world_texture_5;  // -Z

const float kPi = 3.14159265358979;
const uint kWorldColor = 0u;
const uint kWorldCube = 2u;

// asin(z) as an arc tangent, which keeps its precision at the poles.
vec2 equirectangular_uv(vec3 d) {
  float around = (d.x == 0.0 && d.y == 0.0) ? 0.0 : atan(d.y, d.x);
  return vec2(0.5 - around / (2.0 * kPi), 0.5 + atan(d.z, length(d.xy)) / kPi);
}

// xy: coordinates in the face, z: the face, 0 ... 5 for +X -X +Y -Y +Z -Z.
vec3 cube_uv(vec3 d) {
  vec3 a = abs(d);
  float face, sc, tc, ma;
  if (a.x >= a.y && a.x >= a.z) {
    face = d.x > 0.0 ? 0.0 : 1.0;
    sc = d.x > 0.0 ? -d.z : d.z;
    tc = -d.y;
    ma = a.x;
  } else if (a.y >= a.z) {
    face = d.y > 0.0 ? 2.0 : 3.0;
    sc = d.x;
    tc = d.y > 0.0 ? d.z : -d.z;
    ma = a.y;
  } else {
    face = d.z > 0.0 ? 4.0 : 5.0;
    sc = d.z > 0.0 ? d.x : -d.x;
    tc = -d.y;
    ma = a.z;
  }
  return vec3(0.5 * (sc / ma + 1.0), 1.0 - 0.5 * (tc / ma + 1.0), face);
}

vec3 cube_texel(vec3 at) {
  switch (int(at.z)) {
    case 0: return textureLod(world_texture_0, at.xy, 0.0).rgb;
    case 1: return textureLod(world_texture_1, at.xy, 0.0).rgb;
    case 2: return textureLod(world_texture_2, at.xy, 0.0).rgb;
    case 3: return textureLod(world_texture_3, at.xy, 0.0).rgb;
    case 4: return textureLod(world_texture_4, at.xy, 0.0).rgb;
  }
  return textureLod(world_texture_5, at.xy, 0.0).rgb;
}

// `direction_ws` is unit.
vec3 world_radiance(vec3 direction_ws) {
  if (frame.world_kind == kWorldColor) return frame.world_color;
  vec3 d = mat3(frame.map_from_world) * direction_ws;
  if (frame.world_kind == kWorldCube) return frame.world_color * cube_texel(cube_uv(d));
  return frame.world_color * textureLod(world_texture_0, equirectangular_uv(d), 0.0).rgb;
}
