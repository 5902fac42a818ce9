// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as the rasteriser draws it: three vertices a triangle, triangles of one slot together.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/objects.h"
#include "scene/scene.h"

namespace kestrel {

/// Vertices that share a material slot of the object.
struct SlotRange {
  uint32_t slot = 0;
  int first_vertex = 0;
  int vertex_count = 0;
};

/// Per-corner vertex streams, object space; the optional ones are empty where the mesh's are.
struct VertexStreams {
  std::vector<vec3> positions;
  std::vector<vec3> face_normals;  // unit, by the winding; zero where the triangle has no area
  std::vector<vec3> normals;
  std::vector<vec2> uvs;
  std::vector<vec4> tangents;
  std::vector<UvMap> more_uv_maps;
  std::vector<ColorAttribute> color_attributes;
  std::vector<SlotRange> ranges;  // ascending slots
  Bounds bounds;                  // of the triangles' corners
};

/// Spreads a mesh into streams; triangles keep their order within a slot.
VertexStreams expand_mesh(const Mesh& mesh);

/// The streams in GL memory. GL thread only.
class GpuMesh {
 public:
  explicit GpuMesh(const Mesh& mesh);

  /// Binds the streams; absent ones read as constants (flat normals, uv (0, 0), no tangent).
  void bind() const;

  /// After bind(): the UV maps, tangents and colours that this material asks for take their places.
  void bind_attributes(const Material& material) const;

  const std::vector<SlotRange>& ranges() const { return ranges_; }
  const Bounds& bounds() const { return bounds_; }

 private:
  struct UvBuffers {
    uint64_t id;
    gl::Buffer uvs, tangents;
  };
  struct ColorBuffer {
    uint64_t id;
    gl::Buffer colors;
  };

  const UvBuffers* uv_buffers(uint64_t id) const;
  void bind_colors(GLuint location, uint64_t id) const;

  std::vector<SlotRange> ranges_;
  Bounds bounds_;
  gl::Buffer positions_, face_normals_, normals_;
  UvBuffers own_;  // the mesh's own UVs
  std::vector<UvBuffers> more_uv_maps_;
  std::vector<ColorBuffer> colors_;
  gl::VertexArray vertex_array_;
  mutable uint64_t bound_uvs_ = 0;  // ids of what the vertex array has now
  mutable uint64_t bound_tangents_ = 0;
};

}  // namespace kestrel
