// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/gpu_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <climits>
#include <map>
#include <utility>

#include "base/error.h"
#include "gl/debug.h"

namespace kestrel {
namespace {

// Attribute locations of shaders/raster/gbuffer.vert.
constexpr GLuint kPosition = 0, kNormal = 1, kFaceNormal = 2, kUv = 3, kTangent = 4;
constexpr GLuint kUvOfTexture = 5;  // 5 ... 10, by TextureSlot
constexpr GLuint kEmissionColor = 11, kAmbientColor = 12, kDiffuseColor = 13;

/// Triangle indices grouped by slot, and the ranges they make.
std::vector<uint32_t> group_by_slot(const Mesh& mesh, std::vector<SlotRange>& ranges) {
  const size_t count = mesh.triangles.size();
  const auto slot_of = [&](size_t i) {
    return mesh.triangle_materials.empty() ? 0u : mesh.triangle_materials[i];
  };
  std::map<uint32_t, uint32_t> next;  // slot: how many triangles, then where its next one goes
  for (size_t i = 0; i < count; ++i) ++next[slot_of(i)];
  uint32_t first = 0;
  for (auto& [slot, place] : next) {
    ranges.push_back({slot, static_cast<int>(3 * first), static_cast<int>(3 * place)});
    first += std::exchange(place, first);
  }
  std::vector<uint32_t> order(count);
  for (size_t i = 0; i < count; ++i) order[next[slot_of(i)]++] = static_cast<uint32_t>(i);
  return order;
}

/// In double precision: slivers of large meshes keep a direction.
vec3 face_normal(const vec3& a, const vec3& b, const vec3& c) {
  const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  const double length = glm::length(n);
  return length > 0.0 ? vec3(n / length) : vec3(0.0f);
}

template <typename T>
void copy_corners(const std::vector<T>& from, size_t triangle, std::vector<T>& to, size_t place) {
  if (from.empty()) return;
  for (size_t k = 0; k < 3; ++k) to[3 * place + k] = from[3 * triangle + k];
}

template <typename T>
std::vector<T> expand(const std::vector<T>& from, const std::vector<uint32_t>& order) {
  std::vector<T> to(from.size());
  tbb::parallel_for(size_t(0), order.size(),
                    [&](size_t place) { copy_corners(from, order[place], to, place); });
  return to;
}

void expand_attributes(const Mesh& mesh, const std::vector<uint32_t>& order, VertexStreams& out) {
  for (const UvMap& map : mesh.more_uv_maps) {
    out.more_uv_maps.push_back(
        {map.id, expand(map.corner_uvs, order), expand(map.corner_tangents, order)});
  }
  for (const ColorAttribute& colors : mesh.color_attributes) {
    out.color_attributes.push_back({colors.id, expand(colors.corner_colors, order)});
  }
}

template <typename T>
gl::Buffer stream_buffer(const Mesh& mesh, const char* what, const std::vector<T>& data) {
  if (data.empty()) return {};
  return gl::Buffer(mesh.name + " " + what, data);
}

}  // namespace

VertexStreams expand_mesh(const Mesh& mesh) {
  VertexStreams out;
  const std::vector<uint32_t> order = group_by_slot(mesh, out.ranges);
  const size_t corners = 3 * order.size();
  out.positions.resize(corners);
  out.face_normals.resize(corners);
  out.normals.resize(mesh.corner_normals.empty() ? 0 : corners);
  out.uvs.resize(mesh.corner_uvs.empty() ? 0 : corners);
  out.tangents.resize(mesh.corner_tangents.empty() ? 0 : corners);
  tbb::parallel_for(size_t(0), order.size(), [&](size_t place) {
    const uint32_t triangle = order[place];
    const uvec3& t = mesh.triangles[triangle];
    vec3* p = &out.positions[3 * place];
    for (int k = 0; k < 3; ++k) p[k] = mesh.positions[t[k]];
    const vec3 n = face_normal(p[0], p[1], p[2]);
    for (size_t k = 0; k < 3; ++k) out.face_normals[3 * place + k] = n;
    copy_corners(mesh.corner_normals, triangle, out.normals, place);
    copy_corners(mesh.corner_uvs, triangle, out.uvs, place);
    copy_corners(mesh.corner_tangents, triangle, out.tangents, place);
  });
  expand_attributes(mesh, order, out);
  for (const vec3& p : out.positions) out.bounds.extend(p);
  return out;
}

GpuMesh::GpuMesh(const Mesh& mesh) {
  if (mesh.triangles.size() > INT_MAX / 3) {
    fail(ErrorCode::unsupported,
         "The mesh '{}' has {} triangles, more than one OpenGL draw can take; split it, or render "
         "with primary=rays.",
         mesh.name, mesh.triangles.size());
  }
  VertexStreams streams = expand_mesh(mesh);
  bounds_ = streams.bounds;
  ranges_ = std::move(streams.ranges);
  positions_ = stream_buffer(mesh, "positions", streams.positions);
  face_normals_ = stream_buffer(mesh, "face normals", streams.face_normals);
  normals_ = stream_buffer(mesh, "normals", streams.normals);
  own_ = {mesh.uv_map, stream_buffer(mesh, "UVs", streams.uvs),
          stream_buffer(mesh, "tangents", streams.tangents)};
  for (const UvMap& map : streams.more_uv_maps) {
    more_uv_maps_.push_back({map.id, stream_buffer(mesh, "more UVs", map.corner_uvs),
                             stream_buffer(mesh, "more tangents", map.corner_tangents)});
  }
  for (const ColorAttribute& colors : streams.color_attributes) {
    colors_.push_back({colors.id, stream_buffer(mesh, "colours", colors.corner_colors)});
  }

  vertex_array_ = gl::VertexArray(mesh.name);
  vertex_array_.set_floats(kPosition, 3, positions_);
  vertex_array_.set_floats(kNormal, 3, normals_ ? normals_ : face_normals_);
  vertex_array_.set_floats(kFaceNormal, 3, face_normals_);
  vertex_array_.set_floats(kUv, 2, own_.uvs);
  vertex_array_.set_floats(kTangent, 4, own_.tangents);
  gl::check_errors("uploading the mesh '" + mesh.name + "'");
}

void GpuMesh::bind() const {
  glBindVertexArray(vertex_array_.name());
  glVertexAttrib2f(kUv, 0.0f, 0.0f);
  glVertexAttrib4f(kTangent, 0.0f, 0.0f, 0.0f, 0.0f);
}

/// Null where the mesh has no such map.
const GpuMesh::UvBuffers* GpuMesh::uv_buffers(uint64_t id) const {
  if (id == 0 || id == own_.id) return &own_;
  for (const UvBuffers& map : more_uv_maps_) {
    if (map.id == id) return &map;
  }
  return nullptr;
}

void GpuMesh::bind_colors(GLuint location, uint64_t id) const {
  const auto found = std::find_if(colors_.begin(), colors_.end(),
                                  [id](const ColorBuffer& colors) { return colors.id == id; });
  static const gl::Buffer kNothing;
  const float constant = id == 0 ? 1.0f : 0.0f;
  glVertexAttrib3f(location, constant, constant, constant);
  vertex_array_.set_floats(location, 3, found == colors_.end() ? kNothing : found->colors);
}

void GpuMesh::bind_attributes(const Material& material) const {
  static const UvBuffers kNothing{};
  const auto buffers = [this](uint64_t id) -> const UvBuffers& {
    const UvBuffers* found = uv_buffers(id);
    return found ? *found : kNothing;
  };
  const uint64_t uvs = material.uv_maps[kDiffuseTexture];
  if (std::exchange(bound_uvs_, uvs) != uvs) {
    vertex_array_.set_floats(kUv, 2, buffers(uvs).uvs);
  }
  if (std::exchange(bound_tangents_, material.tangent_map) != material.tangent_map) {
    vertex_array_.set_floats(kTangent, 4, buffers(material.tangent_map).tangents);
  }
  if (!material.reads_attributes()) return;
  for (GLuint slot = 0; slot < kTextureSlots; ++slot) {
    glVertexAttrib2f(kUvOfTexture + slot, 0.0f, 0.0f);
    vertex_array_.set_floats(kUvOfTexture + slot, 2, buffers(material.uv_maps[slot]).uvs);
  }
  bind_colors(kEmissionColor, material.emission_colors);
  bind_colors(kAmbientColor, material.ambient_colors);
  bind_colors(kDiffuseColor, material.diffuse_colors);
}

}  // namespace kestrel
