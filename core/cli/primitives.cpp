// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/primitives.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace kestrel::cli {
namespace {

/// For each vertex the first of those at the same place.
std::vector<uint32_t> first_at_same_place(const std::vector<vec3>& positions) {
  // By their bits, which orders positions that are no numbers too; + 0 makes -0 and 0 equal.
  const auto key = [&](uint32_t i) {
    return std::bit_cast<std::array<uint32_t, 3>>(positions[i] + vec3(0.0f));
  };
  const auto less = [&](uint32_t a, uint32_t b) {
    return std::make_pair(key(a), a) < std::make_pair(key(b), b);
  };
  std::vector<uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), less);
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

float angle_between(const vec3& a, const vec3& b) {
  const float lengths = glm::length(a) * glm::length(b);
  return lengths > 0.0f ? std::acos(glm::clamp(glm::dot(a, b) / lengths, -1.0f, 1.0f)) : 0.0f;
}

}  // namespace

MeshDescription make_plane() {
  MeshDescription mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.corner_uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  return mesh;
}

MeshDescription make_cube() {
  MeshDescription mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
  }
  // Corners anticlockwise seen from outside; the first edge runs to the right.
  static constexpr uint32_t kFaces[6][4] = {{0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7},
                                            {2, 0, 4, 6}, {4, 5, 7, 6}, {2, 3, 1, 0}};
  static constexpr vec2 kUvs[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const auto& face : kFaces) {
    mesh.triangles.emplace_back(face[0], face[1], face[2]);
    mesh.triangles.emplace_back(face[0], face[2], face[3]);
    for (const int corner : {0, 1, 2, 0, 2, 3}) mesh.corner_uvs.push_back(kUvs[corner]);
  }
  return mesh;
}

MeshDescription make_sphere(int slices, int stacks, bool smooth) {
  MeshDescription mesh;
  const auto position = [&](int slice, int stack) {
    const double azimuth = 2.0 * M_PI * (slice % slices) / slices;
    const double polar = M_PI * stack / stacks;  // 0 at the south pole
    return vec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                -std::cos(polar));
  };
  const auto index = [&](int slice, int stack) -> uint32_t {
    if (stack == 0) return 0;
    if (stack == stacks) return 1;
    return 2 + static_cast<uint32_t>((stack - 1) * slices + slice % slices);
  };
  mesh.positions = {{0, 0, -1}, {0, 0, 1}};
  for (int stack = 1; stack < stacks; ++stack) {
    for (int slice = 0; slice < slices; ++slice) mesh.positions.push_back(position(slice, stack));
  }
  const auto add = [&](const int(&corners)[3][2]) {
    mesh.triangles.emplace_back(index(corners[0][0], corners[0][1]),
                                index(corners[1][0], corners[1][1]),
                                index(corners[2][0], corners[2][1]));
    for (const auto& [slice, stack] : corners) {
      mesh.corner_uvs.emplace_back(static_cast<float>(slice) / slices,
                                   static_cast<float>(stack) / stacks);
      if (smooth) mesh.corner_normals.push_back(mesh.positions[index(slice, stack)]);
    }
  };
  for (int stack = 0; stack < stacks; ++stack) {
    for (int slice = 0; slice < slices; ++slice) {
      if (stack > 0) add({{slice, stack}, {slice + 1, stack}, {slice + 1, stack + 1}});
      if (stack + 1 < stacks) add({{slice, stack}, {slice + 1, stack + 1}, {slice, stack + 1}});
    }
  }
  return mesh;
}

void smooth_normals(MeshDescription& mesh) {
  const std::vector<uint32_t> first = first_at_same_place(mesh.positions);
  std::vector<vec3> sums(mesh.positions.size(), vec3(0.0f));
  for (const uvec3& t : mesh.triangles) {
    const vec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const vec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
    const float length = glm::length(cross);
    if (!(length > 0.0f)) continue;
    for (int i = 0; i < 3; ++i) {
      const float angle = angle_between(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
      sums[first[t[i]]] += cross / length * angle;
    }
  }
  mesh.corner_normals.resize(mesh.triangles.size() * 3);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const vec3& sum = sums[first[mesh.triangles[t][i]]];
      const float length = glm::length(sum);
      mesh.corner_normals[3 * t + i] = length > 0.0f ? sum / length : vec3(0.0f);
    }
  }
}

}  // namespace kestrel::cli
