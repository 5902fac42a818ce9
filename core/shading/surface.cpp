// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/surface.h"

#include <cassert>
#include <optional>

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

vec2 texture_uv(const Mesh& mesh, const Material& material, const SurfaceHit& hit) {
  return material.offset + mesh_uv(mesh, hit) * material.tiling;
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
  const vec4 tangent_os = interpolate(mesh.corner_tangents, hit);
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
  vec2 uv;  // of its textures
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
  const Point point{hit, object, mesh, material, texture_uv(mesh, material, hit)};
  const uvec3& triangle = mesh.triangles[hit.triangle];
  for (int c = 0; c < 3; ++c) prefetch(mesh.positions, triangle[c]);
  for (const int texture : {material.diffuse_texture, material.normal_texture,
                            material.specular_texture, material.optical_texture}) {
    if (texture != kNone) prefetch_texels(*scene.textures[texture], point.uv);
  }
  if (material.normal_texture != kNone) {
    prefetch(mesh.corner_tangents, 3 * static_cast<size_t>(hit.triangle));
  }
  return point;
}

Surface evaluate(const Scene& scene, const Point& point, const mat3& normal_from_object) {
  const auto& [hit, object, mesh, material, uv] = point;
  const uvec3& triangle = mesh.triangles[hit.triangle];
  const vec3& a = mesh.positions[triangle.x];
  const vec3& b = mesh.positions[triangle.y];
  const vec3& c = mesh.positions[triangle.z];
  const float u = hit.barycentric.x, v = hit.barycentric.y;

  Surface s;
  s.position = object.world_from_object * vec4((1.0f - u - v) * a + u * b + v * c, 1.0f);
  s.normal_geometric =
      safe_normalize(normal_from_object * glm::cross(b - a, c - a), vec3(0.0f, 0.0f, 1.0f));
  s.normal = s.normal_geometric;
  if (!mesh.corner_normals.empty()) {
    s.normal = safe_normalize(normal_from_object * interpolate(mesh.corner_normals, hit), s.normal);
  }
  if (material.normal_texture != kNone && !mesh.corner_tangents.empty()) {
    s.normal = mapped_normal(scene, mesh, material, hit, uv, normal_from_object,
                             object.world_from_object, s.normal);
  }
  s.diffuse = textured(scene, material.diffuse, material.diffuse_texture, uv);
  s.ambient = material.ambient_texture == material.diffuse_texture &&
                      material.ambient == vec3(material.diffuse)
                  ? vec3(s.diffuse)
                  : textured(scene, material.ambient, material.ambient_texture, uv);
  s.emission = textured(scene, material.emission, material.emission_texture, uv);
  s.specular = textured(scene, material.specular, material.specular_texture, uv);
  s.optical = textured(scene, material.optical, material.optical_texture, uv);
  s.reflection_color = material.reflection_color;
  s.transmission_color = material.transmission_color;
  apply_alpha(scene, material, s);
  return s;
}

}  // namespace

vec2 mesh_uv(const Mesh& mesh, const SurfaceHit& hit) {
  return mesh.corner_uvs.empty() ? vec2(0.0f) : interpolate(mesh.corner_uvs, hit);
}

void evaluate_surfaces(const Scene& scene, std::span<const mat3> normal_from_object,
                       std::span<const SurfaceHit> hits, Surface* out) {
  assert(hits.size() <= kMaxHits);
  for (const SurfaceHit& hit : hits) prefetch_geometry(scene, hit);
  std::optional<Point> points[kMaxHits];
  for (size_t i = 0; i < hits.size(); ++i) points[i].emplace(find_point(scene, hits[i]));
  for (size_t i = 0; i < hits.size(); ++i) {
    out[i] = evaluate(scene, *points[i], normal_from_object[hits[i].object]);
  }
}

float evaluate_alpha(const Scene& scene, const Object& object, const SurfaceHit& hit) {
  const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
  const vec2 uv = texture_uv(*scene.meshes[object.mesh], material, hit);
  return textured(scene, material.diffuse, material.diffuse_texture, uv).w;
}

vec3 shadow_transmission(const Scene& scene, const SurfaceHit& hit) {
  const Object& object = scene.objects[hit.object];
  const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
  if (!material.casts_shadow) return vec3(1.0f);
  const vec2 uv = texture_uv(*scene.meshes[object.mesh], material, hit);
  const vec4 diffuse = textured(scene, material.diffuse, material.diffuse_texture, uv);
  float coverage = 1.0f;
  if (material.alpha_mode == AlphaMode::mask) {
    coverage = diffuse.w < material.alpha_cutoff ? 0.0f : 1.0f;
  } else if (material.alpha_mode == AlphaMode::blend) {
    coverage = diffuse.w;
  }
  const float opacity = textured(scene, material.optical, material.optical_texture, uv).z;
  const vec3 through = (1.0f - opacity) * glm::max(1.0f - vec3(diffuse), 0.0f);
  return (1.0f - coverage) + coverage * through * material.transmission_color;
}

}  // namespace kestrel
