// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/surface.h"

#include <cassert>
#include <optional>

#include "frame/blend_weights.h"
#include "shading/texture.h"

namespace kestrel {
namespace {

template <typename T>
T interpolate(const std::vector<T>& corners, const SurfaceHit& hit) {
  const T* c = &corners[3 * static_cast<size_t>(hit.triangle)];
  const float u = hit.barycentric.x, v = hit.barycentric.y;
  return (1.0f - u - v) * c[0] + u * c[1] + v * c[2];
}

vec3 safe_normalize(const vec3& v, const vec3& fallback) {
  const float length2 = glm::dot(v, v);
  return length2 > 1e-30f ? v * glm::inversesqrt(length2) : fallback;
}

vec2 texture_uv(const Mesh& mesh, const Material& material, TextureSlot slot,
                const SurfaceHit& hit) {
  const std::vector<vec2>& uvs = mesh.uvs_of(material.uv_maps[slot]);
  const vec2 uv = uvs.empty() ? vec2(0.0f) : interpolate(uvs, hit);
  return material.offset + uv * material.tiling;
}

/// Factor from the mesh's colour attribute of this id, 0 being none.
vec3 corner_color(const Mesh& mesh, uint64_t id, const SurfaceHit& hit) {
  if (id == 0) return vec3(1.0f);
  const ColorAttribute* colors = mesh.colors_of(id);
  return colors ? interpolate(colors->corner_colors, hit) : vec3(0.0f);
}

vec4 textured(const Scene& scene, const vec4& color, int texture, const vec2& uv) {
  return texture == kNone ? color : color * sample_texture(*scene.textures[texture], uv);
}

vec3 textured(const Scene& scene, const vec3& color, int texture, const vec2& uv) {
  return texture == kNone ? color : color * vec3(sample_texture(*scene.textures[texture], uv));
}

vec3 mapped_normal(const Scene& scene, const Mesh& mesh, const Material& material,
                   const SurfaceHit& hit, const vec2& uv, const mat3& normal_from_object,
                   const mat4x3& world_from_object, const vec3& normal) {
  const std::vector<vec4>& tangents = mesh.tangents_of(material.tangent_map);
  if (tangents.empty()) return normal;
  const vec4 tangent_os = interpolate(tangents, hit);
  const vec3 along = mat3(world_from_object) * vec3(tangent_os);
  const vec3 tangent = safe_normalize(along - normal * glm::dot(normal, along), vec3(0.0f));
  if (tangent == vec3(0.0f)) return normal;
  const float side = (tangent_os.w < 0.0f ? -1.0f : 1.0f) *
                     (glm::determinant(normal_from_object) < 0.0f ? -1.0f : 1.0f);
  const vec3 bitangent = glm::cross(normal, tangent) * side;
  const vec3 painted =
      vec3(sample_texture(*scene.textures[material.normal_texture], uv)) * 2.0f - 1.0f;
  const vec3 n = glm::mix(vec3(0.0f, 0.0f, 1.0f), painted, material.normal_strength);
  return safe_normalize(n.x * tangent + n.y * bitangent + n.z * normal, normal);
}

/// Opacity (optical B) including alpha, and the index of refraction that goes with it.
void apply_alpha(const Scene& scene, const Material& material, Surface& s) {
  if (material.alpha_mode != AlphaMode::blend) {
    s.diffuse.w = 1.0f;
    return;
  }
  if (s.optical.z >= 1.0f) s.optical.y = scene.settings.environment_ior;
  s.optical.z *= s.diffuse.w;
}

/// A hit with what it refers to.
struct Point {
  SurfaceHit hit;
  const Object& object;
  const Mesh& mesh;
  const Material& material;
  vec2 uv;  // of its textures, unless they have several maps

  vec2 uv_of(TextureSlot slot) const {
    return material.several_uv_maps ? texture_uv(mesh, material, slot, hit) : uv;
  }
};

template <typename T>
void prefetch(const std::vector<T>& items, size_t index) {
  if (index < items.size()) __builtin_prefetch(&items[index]);
}

/// Asks for what find_point() and evaluate() are going to read.
void prefetch_geometry(const Scene& scene, const SurfaceHit& hit) {
  const Mesh& mesh = *scene.meshes[scene.objects[hit.object].mesh];
  prefetch(mesh.triangles, hit.triangle);
  prefetch(mesh.triangle_materials, hit.triangle);
  prefetch(mesh.corner_uvs, 3 * static_cast<size_t>(hit.triangle));
  prefetch(mesh.corner_normals, 3 * static_cast<size_t>(hit.triangle));
}

/// Also asks for the vertices and texels that evaluate() is going to read.
Point find_point(const Scene& scene, const SurfaceHit& hit) {
  const Object& object = scene.objects[hit.object];
  const Mesh& mesh = *scene.meshes[object.mesh];
  const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
  const Point point{hit, object, mesh, material, texture_uv(mesh, material, kDiffuseTexture, hit)};
  const uvec3& triangle = mesh.triangles[hit.triangle];
  for (int c = 0; c < 3; ++c) prefetch(mesh.positions, triangle[c]);
  for (const int texture : {material.diffuse_texture, material.normal_texture,
                            material.specular_texture, material.optical_texture}) {
    if (texture != kNone) prefetch_texels(*scene.textures[texture], point.uv);
  }
  if (material.normal_texture != kNone) {
    prefetch(mesh.tangents_of(material.tangent_map), 3 * static_cast<size_t>(hit.triangle));
  }
  return point;
}

/// Diffuse, ambient and emission.
void evaluate_colors(const Scene& scene, const Point& point, Surface& s) {
  const Material& m = point.material;
  s.diffuse = textured(scene, m.diffuse, m.diffuse_texture, point.uv_of(kDiffuseTexture));
  s.ambient =
      m.ambient_texture == m.diffuse_texture && m.ambient == vec3(m.diffuse) && !m.several_uv_maps
          ? vec3(s.diffuse)
          : textured(scene, m.ambient, m.ambient_texture, point.uv_of(kAmbientTexture));
  s.emission = textured(scene, m.emission, m.emission_texture, point.uv_of(kEmissionTexture));
  if (!m.has_colors()) return;
  s.diffuse *= vec4(corner_color(point.mesh, m.diffuse_colors, point.hit), 1.0f);
  s.ambient *= corner_color(point.mesh, m.ambient_colors, point.hit);
  s.emission *= corner_color(point.mesh, m.emission_colors, point.hit);
}

BarePoint bare_point(const Object& object, const Mesh& mesh, const SurfaceHit& hit,
                     const mat3& normal_from_object) {
  const uvec3& triangle = mesh.triangles[hit.triangle];
  const vec3& a = mesh.positions[triangle.x];
  const vec3& b = mesh.positions[triangle.y];
  const vec3& c = mesh.positions[triangle.z];
  const float u = hit.barycentric.x, v = hit.barycentric.y;
  BarePoint p;
  p.position = object.world_from_object * vec4((1.0f - u - v) * a + u * b + v * c, 1.0f);
  p.normal_geometric =
      safe_normalize(normal_from_object * glm::cross(b - a, c - a), vec3(0.0f, 0.0f, 1.0f));
  p.normal = p.normal_geometric;
  if (!mesh.corner_normals.empty()) {
    p.normal = safe_normalize(normal_from_object * interpolate(mesh.corner_normals, hit), p.normal);
  }
  return p;
}

/// Shares of light by colour; below 0 there is none.
vec3 share(const vec4& value) {
  return glm::max(vec3(value), 0.0f);
}

/// A highlight of the roughness of a microfacet surface: Blinn-Phong's of equal width and height.
vec4 highlight(const vec3& f0, float roughness) {
  constexpr float kMirror = 0.05f;  // reflections of point lights have no size there
  if (roughness < kMirror) return vec4(0.0f);
  const float r2 = roughness * roughness;
  const float exponent = glm::clamp(2.0f / (r2 * r2) - 2.0f, 1.0f, 255.0f);
  return {f0 * ((exponent + 2.0f) / 8.0f), (exponent - 1.0f) / 254.0f};
}

/// Puts what a program computes in place of the material's own. Programs say which share of the
/// light each part of the surface gives; a Surface says what the parts are before the blend stage
/// weighs them.
void apply_program(const Scene& scene, const Material& material, const NodeValues& values,
                   const Look& look, Surface& s) {
  const NodeProgram& program = *material.program;
  const auto value = [&](int output, auto& place) {
    using T = std::remove_reference_t<decltype(place)>;
    if (program.computes(output)) place = T(share(values[output]));
  };
  if (program.computes(nodes::kNodeNormal)) {
    const bool back = glm::dot(s.normal_geometric, look.direction) > 0.0f;
    const vec3 normal(values[nodes::kNodeNormal]);
    s.normal = safe_normalize(back ? -normal : normal, s.normal);
  }
  value(nodes::kNodeEmission, s.emission);
  vec3 diffuse(s.diffuse);
  value(nodes::kNodeDiffuse, diffuse);
  if (program.computes(nodes::kNodeDiffuse)) s.ambient = diffuse;
  value(nodes::kNodeAmbient, s.ambient);
  if (program.computes(nodes::kNodeAlpha)) {
    s.diffuse.w = glm::clamp(values[nodes::kNodeAlpha].x, 0.0f, 1.0f);
  }
  if (program.computes(nodes::kNodeSpecular)) {
    const float roughness =
        program.computes(nodes::kNodeRoughness) ? values[nodes::kNodeRoughness].x : 0.5f;
    s.specular = highlight(share(values[nodes::kNodeSpecular]), roughness);
  }
  vec3 reflected = s.optical.x * s.reflection_color;
  vec3 transmitted = (1.0f - s.optical.z) * s.transmission_color;
  value(nodes::kNodeReflection, reflected);
  value(nodes::kNodeTransmission, transmitted);
  if (program.computes(nodes::kNodeIor)) {
    s.optical.y = glm::clamp(values[nodes::kNodeIor].x, 0.1f, 10.0f);
  }
  const float coverage = material.alpha_mode == AlphaMode::blend ? s.diffuse.w : 1.0f;
  if (coverage < 1.0f) {
    if (max_component(transmitted) <= 0.0f) s.optical.y = scene.settings.environment_ior;
    reflected *= coverage;
    transmitted = coverage * transmitted + (1.0f - coverage);
    diffuse *= coverage;
  }
  s.optical.x = glm::min(max_component(reflected), 1.0f);
  s.optical.z = 1.0f - glm::min(max_component(transmitted), 1.0f);
  const BlendWeights w = blend_weights(s.optical.x, 1.0f - s.optical.z);
  constexpr float kNothing = 1e-4f;
  s.reflection_color = w.reflection > kNothing ? reflected / w.reflection : vec3(0.0f);
  s.transmission_color = w.refraction > kNothing ? transmitted / w.refraction : vec3(0.0f);
  const float rest = w.surface > kNothing ? 1.0f / w.surface : 0.0f;
  s.diffuse = vec4(diffuse * rest, material.alpha_mode == AlphaMode::blend ? coverage : 1.0f);
  const float scale = rest * coverage;
  s.emission *= scale;
  s.ambient *= scale;
  s.specular = vec4(vec3(s.specular) * scale, s.specular.w);
}

Surface evaluate(const Scene& scene, const Point& point, const mat3& normal_from_object,
                 const Look& look) {
  const auto& [hit, object, mesh, material, _] = point;
  const BarePoint bare = bare_point(object, mesh, hit, normal_from_object);
  Surface s;
  s.position = bare.position;
  s.normal_geometric = bare.normal_geometric;
  s.normal = bare.normal;
  if (material.normal_texture != kNone) {
    s.normal = mapped_normal(scene, mesh, material, hit, point.uv_of(kNormalTexture),
                             normal_from_object, object.world_from_object, s.normal);
  }
  evaluate_colors(scene, point, s);
  s.specular =
      textured(scene, material.specular, material.specular_texture, point.uv_of(kSpecularTexture));
  s.optical =
      textured(scene, material.optical, material.optical_texture, point.uv_of(kOpticalTexture));
  s.reflection_color = material.reflection_color;
  s.transmission_color = material.transmission_color;
  if (material.program) {
    apply_program(scene, material, run_program(scene, material, hit, bare, look), look, s);
  } else {
    apply_alpha(scene, material, s);
  }
  return s;
}

vec3 program_transmission(const Scene& scene, const Material& material, const SurfaceHit& hit,
                          const BarePoint& bare, const Look& look) {
  const NodeProgram& program = *material.program;
  const NodeValues values = run_coverage(scene, material, hit, bare, look);
  float coverage = 1.0f;
  if (material.alpha_mode != AlphaMode::opaque) {
    coverage = program.computes(nodes::kNodeAlpha)
                   ? glm::clamp(values[nodes::kNodeAlpha].x, 0.0f, 1.0f)
                   : material.diffuse.w;
    if (material.alpha_mode == AlphaMode::mask) {
      coverage = coverage < material.alpha_cutoff ? 0.0f : 1.0f;
    }
  }
  const vec3 through = program.computes(nodes::kNodeTransmission)
                           ? glm::clamp(share(values[nodes::kNodeTransmission]), 0.0f, 1.0f)
                           : (1.0f - material.optical.z) * material.transmission_color;
  return (1.0f - coverage) + coverage * through;
}

}  // namespace

vec2 mesh_uv(const Mesh& mesh, const SurfaceHit& hit) {
  return mesh.corner_uvs.empty() ? vec2(0.0f) : interpolate(mesh.corner_uvs, hit);
}

void evaluate_surfaces(const Scene& scene, std::span<const mat3> normal_from_object,
                       std::span<const SurfaceHit> hits, std::span<const Look> looks,
                       Surface* out) {
  assert(hits.size() <= kMaxHits);
  for (const SurfaceHit& hit : hits) prefetch_geometry(scene, hit);
  std::optional<Point> points[kMaxHits];
  for (size_t i = 0; i < hits.size(); ++i) points[i].emplace(find_point(scene, hits[i]));
  for (size_t i = 0; i < hits.size(); ++i) {
    out[i] = evaluate(scene, *points[i], normal_from_object[hits[i].object], looks[i]);
  }
}

float evaluate_alpha(const Scene& scene, const SurfaceHit& hit, const mat3& normal_from_object,
                     const Look& look) {
  const Object& object = scene.objects[hit.object];
  const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
  const Mesh& mesh = *scene.meshes[object.mesh];
  if (material.program && material.program->computes(nodes::kNodeAlpha)) {
    const BarePoint bare = bare_point(object, mesh, hit, normal_from_object);
    return run_coverage(scene, material, hit, bare, look)[nodes::kNodeAlpha].x;
  }
  const vec2 uv = texture_uv(mesh, material, kDiffuseTexture, hit);
  return textured(scene, material.diffuse, material.diffuse_texture, uv).w;
}

vec3 shadow_transmission(const Scene& scene, const SurfaceHit& hit, const mat3& normal_from_object,
                         const Look& look) {
  const Object& object = scene.objects[hit.object];
  const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
  if (!material.casts_shadow) return vec3(1.0f);
  const Mesh& mesh = *scene.meshes[object.mesh];
  if (material.program) {
    return program_transmission(scene, material, hit,
                                bare_point(object, mesh, hit, normal_from_object), look);
  }
  const vec2 uv = texture_uv(mesh, material, kDiffuseTexture, hit);
  vec4 diffuse = textured(scene, material.diffuse, material.diffuse_texture, uv);
  diffuse *= vec4(corner_color(mesh, material.diffuse_colors, hit), 1.0f);
  float coverage = 1.0f;
  if (material.alpha_mode == AlphaMode::mask) {
    coverage = diffuse.w < material.alpha_cutoff ? 0.0f : 1.0f;
  } else if (material.alpha_mode == AlphaMode::blend) {
    coverage = diffuse.w;
  }
  const vec2 optical_uv = texture_uv(mesh, material, kOpticalTexture, hit);
  const float opacity = textured(scene, material.optical, material.optical_texture, optical_uv).z;
  const vec3 through = (1.0f - opacity) * glm::max(1.0f - vec3(diffuse), 0.0f);
  return (1.0f - coverage) + coverage * through * material.transmission_color;
}

}  // namespace kestrel
