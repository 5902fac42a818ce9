// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/tangents.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>

namespace kestrel {
namespace {

/// What corners must share to share a tangent; sorted by it, equal ones lie together.
struct Corner {
  std::array<uint32_t, 8> bits;  // of position, normal and uv
  int orientation;               // of the triangle in UV space: 1, -1, or 0 where it has no area
  uint32_t index;

  bool same_frame(const Corner& o) const { return bits == o.bits && orientation == o.orientation; }
  bool operator<(const Corner& o) const {
    return std::tie(bits, orientation, index) < std::tie(o.bits, o.orientation, o.index);
  }
};

/// Equal for 0 and -0.
uint32_t bits_of(float v) {
  return std::bit_cast<uint32_t>(v + 0.0f);
}

/// A triangle's edges in object and UV space.
struct Triangle {
  vec3 p[3];
  vec2 uv[3];

  Triangle(const Mesh& mesh, const std::vector<vec2>& corner_uvs, size_t t) {
    for (int c = 0; c < 3; ++c) {
      p[c] = mesh.positions[mesh.triangles[t][c]];
      uv[c] = corner_uvs.empty() ? vec2(0.0f) : corner_uvs[3 * t + c];
    }
  }
  /// Twice the signed area in UV space.
  float uv_area() const {
    const vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
    return a.x * b.y - b.x * a.y;
  }
  /// The way u grows, of any length.
  vec3 along_u() const {
    const float v1 = uv[1].y - uv[0].y, v2 = uv[2].y - uv[0].y;
    const vec3 d = (p[1] - p[0]) * v2 - (p[2] - p[0]) * v1;
    return uv_area() < 0.0f ? -d : d;
  }
  vec3 normal() const { return glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])); }
  /// Radians.
  float angle(int corner) const {
    const vec3 a = glm::normalize(p[(corner + 1) % 3] - p[corner]);
    const vec3 b = glm::normalize(p[(corner + 2) % 3] - p[corner]);
    return std::acos(glm::clamp(glm::dot(a, b), -1.0f, 1.0f));
  }
};

vec3 corner_normal(const Mesh& mesh, const Triangle& triangle, size_t corner) {
  return mesh.corner_normals.empty() ? triangle.normal() : mesh.corner_normals[corner];
}

/// `v` across `normal` and of unit length, or zero where that has no direction.
vec3 unit_across(const vec3& v, const vec3& normal) {
  const float length = glm::length(v);
  if (!(length > 0.0f) || !std::isfinite(length)) return vec3(0.0f);
  const vec3 unit = v / length;
  const vec3 across = unit - normal * glm::dot(normal, unit);
  const float rest = glm::length(across);
  return rest > 1e-6f ? across / rest : vec3(0.0f);
}

Corner corner_key(const Mesh& mesh, const Triangle& triangle, uint32_t index) {
  const int c = static_cast<int>(index % 3);
  const vec3 n = corner_normal(mesh, triangle, index);
  const float area = triangle.uv_area();
  return {
      {bits_of(triangle.p[c].x), bits_of(triangle.p[c].y), bits_of(triangle.p[c].z), bits_of(n.x),
       bits_of(n.y), bits_of(n.z), bits_of(triangle.uv[c].x), bits_of(triangle.uv[c].y)},
      area > 0.0f ? 1 : (area < 0.0f ? -1 : 0),
      index};
}

/// Writes the tangents of the corners from `begin` on that share a frame; returns their end.
size_t share_tangent(const Mesh& mesh, const std::vector<vec2>& corner_uvs,
                     const std::vector<Corner>& corners, size_t begin,
                     std::vector<vec4>& tangents) {
  vec3 sum(0.0f);
  vec3 normal(0.0f);
  size_t end = begin;
  for (; end < corners.size() && corners[end].same_frame(corners[begin]); ++end) {
    const uint32_t index = corners[end].index;
    const Triangle triangle(mesh, corner_uvs, index / 3);
    normal = corner_normal(mesh, triangle, index);
    sum += unit_across(triangle.along_u(), normal) * triangle.angle(static_cast<int>(index % 3));
  }
  const vec3 mean = unit_across(sum, normal);
  const vec3 tangent = mean == vec3(0.0f) ? any_perpendicular(normal) : mean;
  const float sign = corners[begin].orientation < 0 ? -1.0f : 1.0f;
  for (size_t i = begin; i < end; ++i) tangents[corners[i].index] = vec4(tangent, sign);
  return end;
}

}  // namespace

vec3 any_perpendicular(const vec3& normal) {
  const vec3 axis = std::abs(normal.x) < 0.5f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
  return glm::normalize(glm::cross(glm::cross(normal, axis), normal));
}

std::vector<vec4> make_tangents(const Mesh& mesh, const std::vector<vec2>& corner_uvs) {
  std::vector<Corner> corners(3 * mesh.triangles.size());
  tbb::parallel_for(size_t{0}, mesh.triangles.size(), [&](size_t t) {
    const Triangle triangle(mesh, corner_uvs, t);
    for (size_t c = 3 * t; c < 3 * t + 3; ++c) {
      corners[c] = corner_key(mesh, triangle, static_cast<uint32_t>(c));
    }
  });
  tbb::parallel_sort(corners.begin(), corners.end());

  std::vector<vec4> tangents(corners.size());
  constexpr size_t kBlock = 4096;  // corners; a block does the frames that begin in it
  tbb::parallel_for(size_t{0}, (corners.size() + kBlock - 1) / kBlock, [&](size_t block) {
    const size_t block_end = std::min(corners.size(), (block + 1) * kBlock);
    size_t begin = block * kBlock;
    while (begin > 0 && begin < block_end && corners[begin].same_frame(corners[begin - 1])) ++begin;
    while (begin < block_end) begin = share_tangent(mesh, corner_uvs, corners, begin, tangents);
  });
  return tangents;
}

}  // namespace kestrel
