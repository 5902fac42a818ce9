// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh's triangles in Embree. Those whose material must be looked at when a ray meets them
// (alpha masks, glass in shadow rays) form a geometry of their own, so that only they pay for it.
#pragma once

#include <memory>
#include <vector>

#include "scene/scene.h"
#include "tracers/embree/embree_api.h"

namespace kestrel {

class RtScene;

class RtMesh {
 public:
  /// `filtered_slots`: by material slot. With `world_from_object`, positions are copied into world
  /// space; else the mesh's own are shared.
  RtMesh(std::shared_ptr<const Mesh> mesh, const std::vector<bool>& filtered_slots,
         const mat4x3* world_from_object);

  /// Adds the geometries under ids 2 * slot (plain) and 2 * slot + 1 (filtered), where they have
  /// triangles, for the rays of `mask` (RayBits). The mesh must stay where it is; filter functions
  /// are given `owner`.
  void attach(RTCDevice device, RTCScene scene, unsigned slot, unsigned mask,
              const RtScene* owner) const;

  /// Triangle of the mesh that a primitive of one of the two geometries is.
  uint32_t triangle(bool filtered, unsigned primitive) const {
    const std::vector<uint32_t>& map = triangles_[filtered];
    return map.empty() ? primitive : map[primitive];
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::vector<vec3> positions_ws_;  // empty: the mesh's own
  bool whole_[2] = {false, false};  // all triangles are of this kind: nothing is copied
  std::vector<uvec3> indices_[2];   // plain, filtered
  std::vector<uint32_t> triangles_[2];
};

}  // namespace kestrel
