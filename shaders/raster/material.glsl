// SPDX-License-Identifier: GPL-3.0-or-later
// A material at a point: each property is its colour times its texture (paper, Table 1 and
// listing 3), as core/shading/surface.cpp evaluates it. Textures are read at level 0 on purpose, so
// that rasterised and ray-traced surfaces agree.

layout(std430, binding = 0) readonly buffer MaterialBuffer {
  GpuMaterial materials[];
};

layout(binding = 0) uniform sampler2D emission_texture;
layout(binding = 1) uniform sampler2D ambient_texture;
layout(binding = 2) uniform sampler2D diffuse_texture;
layout(binding = 3) uniform sampler2D specular_texture;
layout(binding = 4) uniform sampler2D normal_texture;
layout(binding = 5) uniform sampler2D optical_texture;

const uint kNormalUnit = 4u;
const uint kAlphaMask = 1u;
const uint kAlphaBlend = 2u;
// What an opaque texel may come to after filtering.
const float kOpaque = 1.0 - 1e-6;

struct MaterialSample {
  vec3 emission;
  vec3 ambient;
  vec4 diffuse;   // A: alpha after the alpha mode
  vec4 specular;  // A: exponent, 0 ... 1 for 1 ... 255
  vec3 optical;   // R reflectivity, G index of refraction, B opacity including alpha
  float alpha;    // before the alpha mode
};

bool has_texture(GpuMaterial m, uint unit) { return (m.textures & (1u << unit)) != 0u; }

vec4 textured(GpuMaterial m, vec4 color, uint unit, sampler2D image, vec2 uv) {
  return has_texture(m, unit) ? color * textureLod(image, uv, 0.0) : color;
}

// `uvs`: by texture unit.
MaterialSample sample_material(GpuMaterial m, vec2 uvs[6], float environment_ior) {
  MaterialSample s;
  s.emission = textured(m, vec4(m.emission, 1.0), 0u, emission_texture, uvs[0]).rgb;
  s.ambient = textured(m, vec4(m.ambient, 1.0), 1u, ambient_texture, uvs[1]).rgb;
  s.diffuse = textured(m, m.diffuse, 2u, diffuse_texture, uvs[2]);
  s.specular = textured(m, m.specular, 3u, specular_texture, uvs[3]);
  s.optical = textured(m, vec4(m.optical, 1.0), 5u, optical_texture, uvs[5]).rgb;
  s.alpha = s.diffuse.a;
  if (m.alpha_mode != kAlphaBlend) s.diffuse.a = 1.0;
  // What alpha alone leaves uncovered shines straight through.
  if (m.alpha_mode == kAlphaBlend && s.optical.b >= kOpaque) s.optical.g = environment_ior;
  s.optical.b *= s.diffuse.a;
  return s;
}

vec3 safe_normalize(vec3 v, vec3 fallback) {
  float squared = dot(v, v);
  return squared > 1e-30 ? v * inversesqrt(squared) : fallback;
}

// The normal map's normal in world space; `normal` unit, `tangent` as interpolated, w = sign of the
// bitangent. No tangent: the normal as it is.
vec3 mapped_normal(GpuMaterial m, vec2 uv, vec3 normal, vec4 tangent) {
  if (!has_texture(m, kNormalUnit)) return normal;
  vec3 t = safe_normalize(tangent.xyz - normal * dot(normal, tangent.xyz), vec3(0.0));
  if (t == vec3(0.0)) return normal;
  vec3 b = cross(normal, t) * (tangent.w < 0.0 ? -1.0 : 1.0);
  vec3 painted = textureLod(normal_texture, uv, 0.0).rgb * 2.0 - 1.0;
  vec3 n = mix(vec3(0.0, 0.0, 1.0), painted, m.normal_strength);
  return safe_normalize(n.x * t + n.y * b + n.z * normal, normal);
}
