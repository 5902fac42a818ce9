// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles from a host, made safe for every stage.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace kestrel {

/// Object slots above this are refused.
inline constexpr uint32_t kMaxMaterialSlot = 65535;

/// As KestrelMeshAttribute.
struct AttributeInput {
  uint64_t id = 0;
  int channels = 0;
  std::span<const float> values;
};

/// As KestrelMesh; spans may be empty where that allows NULL.
struct MeshInput {
  std::string name;
  std::span<const float> positions;              // 3 per vertex
  std::span<const uint32_t> triangles;           // 3 per triangle
  std::span<const float> corner_normals;         // 9 per triangle
  std::span<const float> corner_uvs;             // 6 per triangle
  std::span<const float> corner_tangents;        // 12 per triangle
  std::span<const uint32_t> triangle_materials;  // 1 per triangle
  size_t motion_count = 0;                       // shapes at even steps of time
  std::span<const float> motion_positions;       // as `positions`, shape after shape
  std::span<const float> motion_corner_normals;  // as `corner_normals`, likewise; may be empty
  uint64_t uv_map = 0;
  std::vector<AttributeInput> attributes;
};

struct ValidMesh {
  std::shared_ptr<const Mesh> mesh;
  std::vector<uint32_t> used_slots;  // material slots of its triangles, rising
};

/// Throws Error(invalid_argument) for an index or a slot out of range. Leaves triangles out that
/// have a vertex beyond ±1e18 (or not finite), or so little area that a float holds no normal of
/// theirs; refuses shapes of a motion that are not finite; repairs normals, UVs, tangents and
/// colours that are not finite. What it changed is warned of once, with counts.
ValidMesh validate_mesh(const MeshInput& input);

/// Embree reads whole 16-byte words, so 4 bytes past the last position must be readable.
void pad_positions(Mesh& mesh);

}  // namespace kestrel
