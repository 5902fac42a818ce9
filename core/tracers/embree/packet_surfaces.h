// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scene/rt_scene.h"
#include "shading/surface.h"
#include "tracers/embree/embree_api.h"

namespace kestrel::embree {

static_assert(kPacket <= kMaxHits);

/// The surfaces that a traced packet's rays have met, in the order of its lanes; lanes without a
/// hit are left out.
struct PacketSurfaces {
  SurfaceHit hits[kPacket];
  Look looks[kPacket];
  Surface surfaces[kPacket];
  size_t count = 0;

  /// `valid`: as for Embree, 0 for lanes without a ray. `depth`: how often the rays were reflected
  /// or refracted.
  PacketSurfaces(const RtScene& rt, const int* valid, const RayHitPacket& packet, int depth) {
    for (size_t lane = 0; lane < kPacket; ++lane) {
      if (valid[lane] == 0 || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
      looks[count] = {{packet.ray.dir_x[lane], packet.ray.dir_y[lane], packet.ray.dir_z[lane]},
                      packet.ray.tfar[lane],
                      static_cast<uint8_t>(packet.ray.mask[lane]),
                      depth};
      hits[count++] =
          rt.resolve(packet.hit.instID[0][lane], packet.hit.geomID[lane], packet.hit.primID[lane],
                     vec2(packet.hit.u[lane], packet.hit.v[lane]));
    }
    evaluate_surfaces(rt.scene(), rt.normal_from_object(), {hits, count}, {looks, count}, surfaces);
  }
};

}  // namespace kestrel::embree
