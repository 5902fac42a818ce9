// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/node_run.h"

#include <span>

#include "shading/node_maths.h"
#include "shading/surface.h"
#include "shading/texture.h"

namespace kestrel {
namespace nodes {
namespace {

/// What a program reads that is not in the NodePoint.
struct Host {
  const Scene& scene;
  const NodeProgram& program;
  const Object& object;
  const Mesh& mesh;
  const SurfaceHit& hit;
  mat3 object_from_world;
  vec2 beside[3];  // barycentric steps: none, along step_x, along step_y
};

#define NODE_HOST_PARAMETER const Host &host,
#define NODE_HOST host,

vec4 node_texture(const Host& host, int index, vec2 uv) {
  const int texture = host.program.textures[index];
  return sample_texture(*host.scene.textures[texture], uv);
}

template <typename T>
T at_corners(const std::vector<T>& corners, const Host& host, int place) {
  const T* c = &corners[3 * static_cast<size_t>(host.hit.triangle)];
  const vec2 uv = host.hit.barycentric + host.beside[place];
  return (1.0f - uv.x - uv.y) * c[0] + uv.x * c[1] + uv.y * c[2];
}

vec4 node_attribute(const Host& host, int index, int place) {
  const uint64_t id = host.program.attributes[index];
  if (id != 0) {
    if (const ColorAttribute* colors = host.mesh.colors_of(id)) {
      return {at_corners(colors->corner_colors, host, place), 1.0f};
    }
  }
  const std::vector<vec2>& uvs = host.mesh.uvs_of(id);
  return uvs.empty() ? vec4(0.0f) : vec4(at_corners(uvs, host, place), 0.0f, 1.0f);
}

vec4 node_constant(const Host& host, int index) {
  return host.program.constants[index];
}

enum Space : uint { kWorld, kObject, kCamera };
enum Transformed : uint { kVector, kPoint, kDirection };

vec3 to_world(const Host& host, const vec3& v, uint type, uint space) {
  if (space == kWorld) return v;
  const mat4x3& m =
      space == kObject ? host.object.world_from_object : host.scene.camera.world_from_camera;
  const vec3 seen = space == kCamera ? vec3(v.x, v.y, -v.z) : v;
  if (type == kPoint) return m * vec4(seen, 1.0f);
  if (type == kDirection && space == kObject) {
    return glm::transpose(host.object_from_world) * seen;
  }
  return mat3(m) * seen;
}

vec3 from_world(const Host& host, const vec3& v, uint type, uint space) {
  if (space == kWorld) return v;
  const mat4x3& m =
      space == kObject ? host.object.world_from_object : host.scene.camera.world_from_camera;
  const vec3 from_origin = type == kPoint ? v - m[3] : v;
  if (space == kCamera) {
    const vec3 seen = glm::transpose(mat3(m)) * from_origin;
    return {seen.x, seen.y, -seen.z};
  }
  if (type == kDirection) return glm::transpose(mat3(m)) * from_origin;
  return host.object_from_world * from_origin;
}

vec3 node_transform(const Host& host, const vec3& v, uint type, uint from, uint to) {
  const vec3 moved = from_world(host, to_world(host, v, type, from), type, to);
  return type == kDirection ? node_normalize(moved, vec3(0.0f)) : moved;
}

#include "../../shaders/nodes/execute.glsl"

/// Two unit vectors that span the plane of a unit normal.
void span_plane(const vec3& normal, vec3& x, vec3& y) {
  const vec3 axis = glm::abs(normal.x) < 0.7f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
  x = glm::normalize(glm::cross(axis, normal));
  y = glm::cross(normal, x);
}

/// How far apart neighbouring pixels are on a surface that faces the camera at this distance.
float pixel_size(const Camera& camera, float distance) {
  constexpr float kPixels = 1000.0f;  // across the picture; a bump does not need it exactly
  const float size = (camera.right - camera.left) / kPixels;
  return glm::max(camera.projection == Projection::orthographic ? size : size * distance, 1e-6f);
}

/// Barycentric coordinates of a step in object space along the triangle's plane.
vec2 barycentric_step(const Mesh& mesh, uint32_t triangle, const vec3& step) {
  const uvec3& t = mesh.triangles[triangle];
  const vec3 u = mesh.positions[t.y] - mesh.positions[t.x];
  const vec3 v = mesh.positions[t.z] - mesh.positions[t.x];
  const float uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
  const float determinant = uu * vv - uv * uv;
  if (!(determinant > 0.0f)) return vec2(0.0f);
  const float su = glm::dot(step, u), sv = glm::dot(step, v);
  return vec2(vv * su - uv * sv, uu * sv - uv * su) / determinant;
}

vec4 tangent_of(const Host& host, const Material& material) {
  const std::vector<vec4>& tangents = host.mesh.tangents_of(material.tangent_map);
  if (tangents.empty()) return vec4(0.0f);
  const vec4 t = at_corners(tangents, host, 0);
  return {vec3(t), t.w < 0.0f ? -1.0f : 1.0f};
}

NodePoint node_point(Host& host, const Material& material, const BarePoint& bare,
                     const Look& look) {
  const Object& object = host.object;
  NodePoint p{};
  p.backfacing = glm::dot(bare.normal_geometric, look.direction) > 0.0f;
  const float side = p.backfacing ? -1.0f : 1.0f;
  p.position = bare.position;
  p.normal = side * bare.normal;
  p.true_normal = side * bare.normal_geometric;
  p.incoming = -look.direction;
  p.position_os = host.object_from_world * (bare.position - object.world_from_object[3]);
  p.normal_os = node_normalize(glm::transpose(mat3(object.world_from_object)) * p.normal, p.normal);
  const Bounds& bounds = host.mesh.bounds;
  const vec3 size = bounds.upper - bounds.lower;
  for (int axis = 0; axis < 3; ++axis) {  // a flat mesh is in the middle of its texture space
    const bool flat = size[axis] == 0.0f;
    p.texture_space_from[axis] = bounds.lower[axis] - (flat ? 1.0f : 0.0f);
    p.texture_space_scale[axis] = flat ? 0.5f : 1.0f / size[axis];
  }
  p.object_location = object.world_from_object[3];
  const float pixel = pixel_size(host.scene.camera, look.distance);
  span_plane(p.true_normal, p.step_x, p.step_y);
  p.step_x *= pixel;
  p.step_y *= pixel;
  p.step_x_os = host.object_from_world * p.step_x;
  p.step_y_os = host.object_from_world * p.step_y;
  host.beside[0] = vec2(0.0f);
  host.beside[1] = barycentric_step(host.mesh, host.hit.triangle, p.step_x_os);
  host.beside[2] = barycentric_step(host.mesh, host.hit.triangle, p.step_y_os);
  p.mesh_normal_os = host.mesh.corner_normals.empty()
                         ? (p.backfacing ? -p.normal_os : p.normal_os)
                         : at_corners(host.mesh.corner_normals, host, 0);
  p.tangent_os = tangent_of(host, material);
  p.parametric = host.hit.barycentric;
  p.position_camera = from_world(host, bare.position, kPoint, kCamera);
  const Camera& camera = host.scene.camera;
  const float depth =
      camera.projection == Projection::orthographic ? 1.0f : node_divide(1.0f, p.position_camera.z);
  p.window = (vec2(p.position_camera) * depth - vec2(camera.left, camera.bottom)) /
             vec2(camera.right - camera.left, camera.top - camera.bottom);
  p.ray_length = look.distance;
  p.object_index = static_cast<float>(object.pass_index);
  p.object_random = object.random;
  p.material_index = static_cast<float>(material.pass_index);
  p.ray = look.kind;
  p.ray_depth = look.depth;
  return p;
}

NodeValues run(const Scene& scene, const Material& material,
               std::span<const NodeInstruction> instructions, const SurfaceHit& hit,
               const BarePoint& bare, const Look& look) {
  const Object& object = scene.objects[hit.object];
  const NodeProgram& program = *material.program;
  Host host{scene,  program,
            object, *scene.meshes[object.mesh],
            hit,    glm::inverse(mat3(object.world_from_object)),
            {}};
  const NodePoint point = node_point(host, material, bare, look);
  vec4 registers[kNodeRegisters] = {};
  const auto value = [&](int operand) -> const vec4& {
    return operand < 0 ? program.constants[-1 - operand] : registers[operand];
  };
  vec4 operands[kNodeInputs];
  for (const NodeInstruction& step : instructions) {
    for (int i = 0; i < kNodeInputs; ++i) operands[i] = value(step.operands[i]);
    registers[step.result] = node_execute(host, step.op, step.mode, step.data, operands, point);
  }
  NodeValues out;
  for (int output = 0; output < kNodeOutputs; ++output) {
    if (program.computes(output)) out[output] = value(program.outputs[output]);
  }
  return out;
}

}  // namespace
}  // namespace nodes

NodeValues run_program(const Scene& scene, const Material& material, const SurfaceHit& hit,
                       const BarePoint& point, const Look& look) {
  return nodes::run(scene, material, material.program->instructions, hit, point, look);
}

NodeValues run_coverage(const Scene& scene, const Material& material, const SurfaceHit& hit,
                        const BarePoint& point, const Look& look) {
  return nodes::run(scene, material, material.program->coverage, hit, point, look);
}

}  // namespace kestrel
