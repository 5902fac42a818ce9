// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_validation.h"

#include <cfloat>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "scene/tangents.h"

namespace kestrel {
namespace {

/// Embree ignores geometry beyond 1.8e18.
constexpr float kLargestPosition = 1e18f;

struct Repairs {
  size_t not_finite = 0;  // triangles
  size_t no_area = 0;     // triangles
  size_t normals = 0;     // corners
  size_t uvs = 0;         // corners
  size_t tangents = 0;    // corners
  size_t colors = 0;      // corners
};

vec3 vec3_at(std::span<const float> values, size_t index) {
  return {values[3 * index], values[3 * index + 1], values[3 * index + 2]};
}

bool usable(const vec3& p) {
  const vec3 a = glm::abs(p);
  return a.x <= kLargestPosition && a.y <= kLargestPosition && a.z <= kLargestPosition;
}

void check_indices(const MeshInput& input) {
  const size_t vertex_count = input.positions.size() / 3;
  for (size_t i = 0; i < input.triangles.size(); ++i) {
    if (input.triangles[i] < vertex_count) continue;
    fail(ErrorCode::invalid_argument,
         "Mesh '{}': triangle {} has the vertex index {}, but there are {} vertices (0 to {}). "
         "Send the triangles that belong to these vertices.",
         input.name, i / 3, input.triangles[i], vertex_count,
         vertex_count ? std::to_string(vertex_count - 1) : "none");
  }
  for (size_t i = 0; i < input.triangle_materials.size(); ++i) {
    if (input.triangle_materials[i] <= kMaxMaterialSlot) continue;
    fail(ErrorCode::invalid_argument,
         "Mesh '{}': triangle {} has the material slot {}; the highest is {}.", input.name, i,
         input.triangle_materials[i], kMaxMaterialSlot);
  }
}

/// The triangles that stay, by index, and their unit normals.
struct Kept {
  std::vector<uint32_t> triangles;
  std::vector<vec3> face_normals;  // object space
};

Kept keep_sound_triangles(const MeshInput& input, const std::vector<vec3>& positions,
                          Repairs& repairs) {
  Kept kept;
  const size_t count = input.triangles.size() / 3;
  kept.triangles.reserve(count);
  kept.face_normals.reserve(count);
  for (size_t t = 0; t < count; ++t) {
    const vec3& a = positions[input.triangles[3 * t]];
    const vec3& b = positions[input.triangles[3 * t + 1]];
    const vec3& c = positions[input.triangles[3 * t + 2]];
    if (!usable(a) || !usable(b) || !usable(c)) {
      ++repairs.not_finite;
      continue;
    }
    const vec3 cross = glm::cross(b - a, c - a);
    const float squared = glm::dot(cross, cross);
    // Below, renderers could not normalise the normal; above, it overflows.
    if (!(squared >= FLT_MIN && squared <= FLT_MAX)) {
      ++repairs.no_area;
      continue;
    }
    kept.triangles.push_back(static_cast<uint32_t>(t));
    kept.face_normals.push_back(cross / std::sqrt(squared));
  }
  return kept;
}

void copy_normals(const MeshInput& input, const Kept& kept, Mesh& mesh, Repairs& repairs) {
  mesh.corner_normals.reserve(3 * kept.triangles.size());
  for (size_t k = 0; k < kept.triangles.size(); ++k) {
    for (size_t corner = 0; corner < 3; ++corner) {
      const vec3 given = vec3_at(input.corner_normals, 3 * size_t{kept.triangles[k]} + corner);
      const float squared = glm::dot(given, given);
      const bool sound = squared >= FLT_MIN && squared <= FLT_MAX;
      if (!sound) ++repairs.normals;
      mesh.corner_normals.push_back(sound ? normalized(given) : kept.face_normals[k]);
    }
  }
}

std::vector<vec2> copy_uvs(std::span<const float> values, const Kept& kept, Repairs& repairs) {
  std::vector<vec2> uvs;
  uvs.reserve(3 * kept.triangles.size());
  for (const uint32_t t : kept.triangles) {
    for (size_t corner = 3 * size_t{t}; corner < 3 * size_t{t} + 3; ++corner) {
      const vec2 uv(values[2 * corner], values[2 * corner + 1]);
      const bool sound = std::isfinite(uv.x) && std::isfinite(uv.y);
      if (!sound) ++repairs.uvs;
      uvs.push_back(sound ? uv : vec2(0.0f));
    }
  }
  return uvs;
}

std::vector<vec3> copy_colors(std::span<const float> values, const Kept& kept, Repairs& repairs) {
  std::vector<vec3> colors;
  colors.reserve(3 * kept.triangles.size());
  for (const uint32_t t : kept.triangles) {
    for (size_t corner = 3 * size_t{t}; corner < 3 * size_t{t} + 3; ++corner) {
      const vec3 color = vec3_at(values, corner);
      if (!is_finite(color)) ++repairs.colors;
      colors.push_back(is_finite(color) ? color : vec3(0.0f));
    }
  }
  return colors;
}

void copy_attributes(const MeshInput& input, const Kept& kept, Mesh& mesh, Repairs& repairs) {
  mesh.uv_map = input.uv_map;
  for (const AttributeInput& attribute : input.attributes) {
    if (attribute.channels == 2) {
      mesh.more_uv_maps.push_back({attribute.id, copy_uvs(attribute.values, kept, repairs), {}});
    } else {
      mesh.color_attributes.push_back({attribute.id, copy_colors(attribute.values, kept, repairs)});
    }
  }
}

void copy_tangents(const MeshInput& input, const Kept& kept, Mesh& mesh, Repairs& repairs) {
  mesh.tangents_given = true;
  mesh.corner_tangents.reserve(3 * kept.triangles.size());
  for (size_t k = 0; k < kept.triangles.size(); ++k) {
    for (size_t corner = 0; corner < 3; ++corner) {
      const float* given = &input.corner_tangents[4 * (3 * size_t{kept.triangles[k]} + corner)];
      const vec3 direction(given[0], given[1], given[2]);
      const float squared = glm::dot(direction, direction);
      const float sign = given[3] < 0.0f ? -1.0f : 1.0f;
      if (squared >= FLT_MIN && squared <= FLT_MAX && std::isfinite(given[3])) {
        mesh.corner_tangents.emplace_back(normalized(direction), sign);
        continue;
      }
      ++repairs.tangents;
      const vec3& normal =
          mesh.corner_normals.empty() ? kept.face_normals[k] : mesh.corner_normals[3 * k + corner];
      mesh.corner_tangents.emplace_back(any_perpendicular(normal), sign);
    }
  }
}

std::vector<uint32_t> copy_slots(const MeshInput& input, const Kept& kept, Mesh& mesh) {
  if (kept.triangles.empty()) return {};
  if (input.triangle_materials.empty()) return {0};
  std::vector<bool> used(size_t{kMaxMaterialSlot} + 1, false);
  mesh.triangle_materials.reserve(kept.triangles.size());
  for (const uint32_t t : kept.triangles) {
    mesh.triangle_materials.push_back(input.triangle_materials[t]);
    used[input.triangle_materials[t]] = true;
  }
  std::vector<uint32_t> slots;
  for (uint32_t slot = 0; slot <= kMaxMaterialSlot; ++slot) {
    if (used[slot]) slots.push_back(slot);
  }
  return slots;
}

/// Throws where a position is beyond what a mesh may hold.
void copy_motion(const MeshInput& input, const Kept& kept, Mesh& mesh, Repairs& repairs) {
  const size_t vertices = input.positions.size() / 3;
  const size_t corners = input.triangles.size();
  auto motion = std::make_shared<MeshMotion>(input.motion_count);
  for (size_t step = 0; step < input.motion_count; ++step) {
    MeshInput moved = input;
    moved.positions = input.motion_positions.subspan(3 * vertices * step, 3 * vertices);
    Mesh shape;
    for (size_t v = 0; v < vertices; ++v) {
      shape.positions.push_back(vec3_at(moved.positions, v));
      if (!usable(shape.positions.back())) {
        fail(ErrorCode::invalid_argument,
             "Mesh '{}': vertex {} of step {} of its motion is not finite. Leave the motion out.",
             input.name, v, step);
      }
    }
    if (!input.motion_corner_normals.empty()) {
      moved.corner_normals = input.motion_corner_normals.subspan(3 * corners * step, 3 * corners);
      copy_normals(moved, kept, shape, repairs);
    } else {
      shape.corner_normals = mesh.corner_normals;
    }
    (*motion)[step] = {std::move(shape.positions), std::move(shape.corner_normals)};
  }
  mesh.motion = std::move(motion);
}

void warn_of(const Repairs& r, const MeshInput& input) {
  std::string text;
  const auto add = [&text](size_t count, const char* what) {
    if (count) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(r.not_finite, "triangles left out whose vertices are not finite");
  add(r.no_area, "triangles left out that have no area");
  add(r.normals, "normals that are not finite or zero replaced by the face's");
  add(r.uvs, "UVs that are not finite replaced by (0, 0)");
  add(r.tangents, "tangents that are not finite or zero replaced");
  add(r.colors, "colours that are not finite replaced by black");
  if (text.empty()) return;
  log::warning_once("Mesh '{}' ({} triangles): {}.", input.name, input.triangles.size() / 3, text);
}

}  // namespace

ValidMesh validate_mesh(const MeshInput& input) {
  check_indices(input);
  auto mesh = std::make_shared<Mesh>();
  mesh->name = input.name;
  const size_t vertex_count = input.positions.size() / 3;
  mesh->positions.reserve(vertex_count + 1);
  for (size_t v = 0; v < vertex_count; ++v) mesh->positions.push_back(vec3_at(input.positions, v));
  pad_positions(*mesh);

  Repairs repairs;
  const Kept kept = keep_sound_triangles(input, mesh->positions, repairs);
  mesh->triangles.reserve(kept.triangles.size());
  for (const uint32_t t : kept.triangles) {
    const uint32_t* v = &input.triangles[3 * size_t{t}];
    mesh->triangles.emplace_back(v[0], v[1], v[2]);
    for (int corner = 0; corner < 3; ++corner) mesh->bounds.extend(mesh->positions[v[corner]]);
  }
  if (!input.corner_normals.empty()) copy_normals(input, kept, *mesh, repairs);
  if (input.motion_count > 0) copy_motion(input, kept, *mesh, repairs);
  if (!input.corner_uvs.empty()) mesh->corner_uvs = copy_uvs(input.corner_uvs, kept, repairs);
  if (!input.corner_tangents.empty()) copy_tangents(input, kept, *mesh, repairs);
  copy_attributes(input, kept, *mesh, repairs);
  std::vector<uint32_t> slots = copy_slots(input, kept, *mesh);
  warn_of(repairs, input);
  return {std::move(mesh), std::move(slots)};
}

void pad_positions(Mesh& mesh) {
  mesh.positions.reserve(mesh.positions.size() + 1);
}

}  // namespace kestrel
