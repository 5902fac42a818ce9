// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/primary_rays.h"

#include "frame/camera_rays.h"
#include "frame/region_loops.h"
#include "shading/shading.h"
#include "shading/texture.h"
#include "tracers/embree/packet_surfaces.h"

namespace kestrel {
namespace {

/// Pixels of one packet; tiles hold whole ones but at the picture's edges.
constexpr int kPacketWidth = 4;
constexpr int kPacketHeight = embree::kPacket / kPacketWidth;

void store_hit(const Scene& scene, const CameraRays& camera, const SurfaceHit& hit, Surface s,
               const ivec2& pixel, size_t i, GBuffer& out) {
  out.position[i] = s.position;
  out.normal[i] = s.normal;
  out.normal_geometric[i] = s.normal_geometric;
  out.emission[i] = s.emission;
  out.ambient[i] = s.ambient;
  out.diffuse[i] = s.diffuse;
  out.specular[i] = s.specular;
  out.optical[i] = s.optical;
  out.depth[i] = camera.reversed_depth(s.position);
  out.object[i] = static_cast<uint32_t>(hit.object) + 1;
  if (scene.has_programs) {
    out.reflection_color[i] = s.reflection_color;
    out.transmission_color[i] = s.transmission_color;
  }
  out.material[i] =
      static_cast<uint32_t>(material_of(scene, scene.objects[hit.object], hit.triangle));
  if (!out.uv.empty()) out.uv[i] = mesh_uv(*scene.meshes[scene.objects[hit.object].mesh], hit);
  const vec3 to_viewer = camera.to_viewer(s.position, pixel.x, pixel.y);
  face_viewer(s, to_viewer);
  out.lighting[i] = lighting_without_shadows(scene, s, to_viewer);
}

void trace_packet(const RtScene& rt, const CameraRays& camera, int x0, int y0, GBuffer& out) {
  const Scene& scene = rt.scene();
  alignas(64) int valid[embree::kPacket];
  alignas(64) embree::RayHitPacket packet;
  CameraRay rays[embree::kPacket];
  for (int lane = 0; lane < embree::kPacket; ++lane) {
    const int x = x0 + lane % kPacketWidth, y = y0 + lane / kPacketWidth;
    valid[lane] = x < out.width && y < out.height ? -1 : 0;
    const CameraRay& r = rays[lane] = camera.ray(x, y);
    embree::set_ray(packet, lane, r.origin, r.direction, r.t_near, r.t_far, kCameraRays);
  }
  embree::Query query;
  embree::intersect(rt.handle(), query, valid, packet);
  embree::PacketSurfaces met(rt, valid, packet, 0);
  size_t next = 0;
  for (int lane = 0; lane < embree::kPacket; ++lane) {
    if (valid[lane] == 0) continue;
    const int x = x0 + lane % kPacketWidth, y = y0 + lane / kPacketWidth;
    const size_t i = static_cast<size_t>(y) * static_cast<size_t>(out.width) + x;
    const bool missed = packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID;
    const bool holdout = !missed && scene.objects[met.hits[next].object].holdout;
    if (scene.has_holdouts) out.holdout[i] = holdout;
    if (missed || holdout) {
      out.set_nothing(i, missed ? sample_world(scene, rays[lane].direction) : vec3(0.0f));
    } else {
      store_hit(scene, camera, met.hits[next], met.surfaces[next], {x, y}, i, out);
    }
    if (!missed) ++next;
  }
}

}  // namespace

uint64_t PrimaryRays::run(const FrameInputs& inputs, GBuffer& out) {
  const Region& region = inputs.region;
  out.resize(inputs);
  out.holdout.resize(inputs.scene.has_holdouts ? region.pixels() : 0);
  out.reflection_color.resize(inputs.scene.has_programs ? region.pixels() : 0);
  out.transmission_color.resize(inputs.scene.has_programs ? region.pixels() : 0);
  const CameraRays camera(inputs);
  for_tiles(region, [&](const Region& tile) {
    const int x0 = tile.x - region.x, y0 = tile.y - region.y;
    for (int y = y0; y < y0 + tile.height; y += kPacketHeight) {
      for (int x = x0; x < x0 + tile.width; x += kPacketWidth) {
        trace_packet(scene_, camera, x, y, out);
      }
    }
  });
  return region.pixels();
}

}  // namespace kestrel
