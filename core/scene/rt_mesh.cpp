// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/rt_mesh.h"

#include "tracers/embree/filters.h"

namespace kestrel {

RtMesh::RtMesh(std::shared_ptr<const Mesh> mesh, const std::vector<bool>& filtered_slots,
               const mat4x3* world_from_object)
    : mesh_(std::move(mesh)) {
  if (world_from_object && *world_from_object != mat4x3(1.0f)) {
    positions_ws_.reserve(mesh_->positions.size() + 2);  // Embree reads 16 bytes past the last
    for (const vec3& p : mesh_->positions) {
      positions_ws_.push_back(*world_from_object * vec4(p, 1.0f));
    }
  }
  const size_t count = mesh_->triangles.size();
  const auto filtered = [&](size_t t) {
    const size_t slot = mesh_->triangle_materials.empty() ? 0 : mesh_->triangle_materials[t];
    return filtered_slots[std::min(slot, filtered_slots.size() - 1)];
  };
  size_t with_filter = 0;
  for (size_t t = 0; t < count; ++t) with_filter += filtered(t);
  whole_[0] = with_filter == 0;
  whole_[1] = with_filter == count;
  if (whole_[0] || whole_[1]) return;
  for (size_t t = 0; t < count; ++t) {
    const int kind = filtered(t);
    indices_[kind].push_back(mesh_->triangles[t]);
    triangles_[kind].push_back(static_cast<uint32_t>(t));
  }
}

void RtMesh::attach(RTCDevice device, RTCScene scene, unsigned slot, unsigned mask,
                    const RtScene* owner) const {
  const std::vector<vec3>& positions = positions_ws_.empty() ? mesh_->positions : positions_ws_;
  for (unsigned kind = 0; kind < 2; ++kind) {
    const std::vector<uvec3>& indices = whole_[kind] ? mesh_->triangles : indices_[kind];
    if (indices.empty()) continue;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions.data(), 0, sizeof(vec3), positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(),
                               0, sizeof(uvec3), indices.size());
    if (kind == 1) {
      rtcSetGeometryUserData(geometry, const_cast<RtScene*>(owner));
      rtcSetGeometryIntersectFilterFunction(geometry, embree::skip_masked);
      rtcSetGeometryOccludedFilterFunction(geometry, embree::attenuate_shadow);
    }
    rtcSetGeometryMask(geometry, mask);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, 2 * slot + kind);
    rtcReleaseGeometry(geometry);
  }
}

}  // namespace kestrel
