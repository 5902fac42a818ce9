// SPDX-License-Identifier: GPL-3.0-or-later
// Everything in which Embree 3.13 and 4 differ. A query carries a pointer to the caller's state to
// the filter functions.
#pragma once

#include <cstddef>

#include "base/math.h"

#if KESTREL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace kestrel::embree {

/// Rays of one packet. Embree traces wider packets than the processor's vectors ray by ray.
inline constexpr int kPacket = 8;
using RayPacket = RTCRay8;
using RayHitPacket = RTCRayHit8;

/// Embree's mask of the lanes in use: the first `count`, or all.
struct ValidLanes {
  alignas(64) int mask[kPacket];

  explicit ValidLanes(size_t count) {
    for (size_t lane = 0; lane < kPacket; ++lane) mask[lane] = lane < count ? -1 : 0;
  }
};

/// Fills one ray of a packet; filter functions see its `id`. `kind`: one of RayBits.
inline void set_ray(RayPacket& rays, size_t lane, const vec3& origin, const vec3& direction,
                    float t_near, float t_far, unsigned kind, size_t id) {
  rays.org_x[lane] = origin.x;
  rays.org_y[lane] = origin.y;
  rays.org_z[lane] = origin.z;
  rays.dir_x[lane] = direction.x;
  rays.dir_y[lane] = direction.y;
  rays.dir_z[lane] = direction.z;
  rays.tnear[lane] = t_near;
  rays.tfar[lane] = t_far;
  rays.time[lane] = 0.0f;
  rays.mask[lane] = kind;
  rays.id[lane] = static_cast<unsigned>(id);
  rays.flags[lane] = 0;
}

/// The same for a ray that is to find the nearest hit: none yet.
inline void set_ray(RayHitPacket& rays, size_t lane, const vec3& origin, const vec3& direction,
                    float t_near, float t_far, unsigned kind) {
  set_ray(rays.ray, lane, origin, direction, t_near, t_far, kind, lane);
  rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
}

#if KESTREL_EMBREE_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
#else
using QueryContext = RTCIntersectContext;
#endif

/// One traversal's context. Derive from it to give filter functions more; `context` comes first so
/// that a filter can cast back. Packets are made of rays that go the same way, so Embree is told
/// to take them through its tree together.
struct Query {
  QueryContext context;

  Query() {
#if KESTREL_EMBREE_MAJOR >= 4
    rtcInitRayQueryContext(&context);
#else
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
#endif
  }
};

#if KESTREL_EMBREE_MAJOR >= 4

inline RTCIntersectArguments intersect_arguments(Query& query) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  arguments.context = &query.context;
  return arguments;
}

inline RTCOccludedArguments occluded_arguments(Query& query) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  arguments.context = &query.context;
  return arguments;
}

inline void intersect(RTCScene scene, Query& query, const int* valid, RayHitPacket& rays) {
  RTCIntersectArguments arguments = intersect_arguments(query);
  rtcIntersect8(valid, scene, &rays, &arguments);
}
inline void occluded(RTCScene scene, Query& query, const int* valid, RayPacket& rays) {
  RTCOccludedArguments arguments = occluded_arguments(query);
  rtcOccluded8(valid, scene, &rays, &arguments);
}

#else

inline void intersect(RTCScene scene, Query& query, const int* valid, RayHitPacket& rays) {
  rtcIntersect8(valid, scene, &query.context, &rays);
}
inline void occluded(RTCScene scene, Query& query, const int* valid, RayPacket& rays) {
  rtcOccluded8(valid, scene, &query.context, &rays);
}

#endif

}  // namespace kestrel::embree
