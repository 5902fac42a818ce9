// SPDX-License-Identifier: GPL-3.0-or-later
// A point on a surface with its material evaluated: what shading needs, wherever it came from.
#pragma once

#include <span>

#include "scene/scene.h"
#include "shading/node_run.h"

namespace kestrel {

struct Surface {
  vec3 position;          // world space
  vec3 normal;            // world space, unit, after normal maps, on the mesh's own side
  vec3 normal_geometric;  // world space, unit, of the triangle, on the mesh's own side
  vec3 emission;
  vec3 ambient;
  vec4 diffuse;   // A: alpha after the alpha mode
  vec4 specular;  // A: exponent, 0 … 1 for 1 … 255
  vec3 optical;   // R reflectivity, G index of refraction, B opacity incl. alpha
  vec3 reflection_color;
  vec3 transmission_color;
};

/// Where a ray met a mesh.
struct SurfaceHit {
  int object;         // index in Scene::objects
  uint32_t triangle;  // index in its mesh
  vec2 barycentric;   // weights of the second and third corner
};

/// The material's slot at a triangle.
inline int material_of(const Scene& scene, const Object& object, uint32_t triangle) {
  const Mesh& mesh = *scene.meshes[object.mesh];
  const uint32_t slot = mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[triangle];
  return object.materials[glm::min<size_t>(slot, object.materials.size() - 1)];
}

/// UV of the mesh at a hit; (0, 0) where it has none.
vec2 mesh_uv(const Mesh& mesh, const SurfaceHit& hit);

/// How many hits evaluate_surfaces() takes at once.
inline constexpr size_t kMaxHits = 8;

/// Interpolates and evaluates the materials of up to kMaxHits hits. Tangent space is listing 2's,
/// with an orthogonal tangent. `normal_from_object`: the inverse transpose of every object's
/// matrix; `looks`: how each hit came about. Several hits together take less time than one after
/// the other: their geometry and texels come from memory side by side.
void evaluate_surfaces(const Scene& scene, std::span<const mat3> normal_from_object,
                       std::span<const SurfaceHit> hits, std::span<const Look> looks, Surface* out);

/// Diffuse alpha at a hit, before the alpha mode: colour times texture, or the program's.
float evaluate_alpha(const Scene& scene, const SurfaceHit& hit, const mat3& normal_from_object,
                     const Look& look);

/// Light that gets past a surface on its way to another (listing 8b): what alpha leaves uncovered,
/// and of the rest transparency * (1 - diffuse), tinted, or what the program lets through.
vec3 shadow_transmission(const Scene& scene, const SurfaceHit& hit, const mat3& normal_from_object,
                         const Look& look);

}  // namespace kestrel
