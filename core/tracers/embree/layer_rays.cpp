// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/layer_rays.h"

#include <algorithm>

#include "frame/camera_rays.h"
#include "tracers/embree/packet_surfaces.h"

namespace kestrel {
namespace {

constexpr int kMaxLayers = 32;        // behind the first one
constexpr float kLeastShare = 1e-3f;  // of a pixel that is still followed
constexpr float kStep = 1e-4f;        // off the last surface, relative to its distance

/// A view through a pixel, on its way.
struct View {
  uint32_t pixel;  // of the region
  CameraRay ray;   // what is left of it
  float share;     // of the pixel that it still sees
};

/// Goes on behind a surface that covers this much.
void pass_surface(View& view, const vec3& position, float coverage) {
  const float distance = glm::dot(position - view.ray.origin, view.ray.direction);
  view.ray.t_near = distance + glm::max(kStep * std::abs(distance), kStep);
  view.share *= 1.0f - coverage;
}

bool is_over(const View& view) {
  return view.share < kLeastShare || view.ray.t_near >= view.ray.t_far;
}

/// The views through all pixels whose surface leaves something uncovered.
std::vector<View> clear_views(const FrameInputs& inputs, const GBuffer& gbuffer) {
  const CameraRays camera(inputs);
  std::vector<View> views;
  for (size_t i = 0; i < gbuffer.object.size(); ++i) {
    const float covered = coverage(inputs.scene, gbuffer, i);
    if (gbuffer.object[i] == 0 || covered >= 1.0f) continue;
    const auto width = static_cast<size_t>(gbuffer.width);
    views.push_back({static_cast<uint32_t>(i),
                     camera.ray(static_cast<int>(i % width), static_cast<int>(i / width)), 1.0f});
    pass_surface(views.back(), gbuffer.position[i], covered);
  }
  return views;
}

/// Takes a packet of views to their next surfaces; those that meet none or a holdout are over.
void trace_packet(const RtScene& rt, std::span<View> views, std::vector<SurfaceLayer>& out) {
  const Scene& scene = rt.scene();
  const embree::ValidLanes valid(views.size());
  alignas(64) embree::RayHitPacket packet;
  for (size_t lane = 0; lane < views.size(); ++lane) {
    const CameraRay& ray = views[lane].ray;
    embree::set_ray(packet, lane, ray.origin, ray.direction, ray.t_near, ray.t_far, kCameraRays);
  }
  embree::Query query;
  embree::intersect(rt.handle(), query, valid.mask, packet);
  const embree::PacketSurfaces met(rt, valid.mask, packet, 0);
  size_t next = 0;
  for (size_t lane = 0; lane < views.size(); ++lane) {
    View& view = views[lane];
    if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
      view.share = 0.0f;
      continue;
    }
    const SurfaceHit& hit = met.hits[next];
    const Surface& s = met.surfaces[next++];
    if (scene.objects[hit.object].holdout) {
      view.share = 0.0f;
      continue;
    }
    const float covered = straight_coverage(scene, s.optical, s.diffuse.w);
    const int material = material_of(scene, scene.objects[hit.object], hit.triangle);
    out.push_back({view.pixel, static_cast<uint32_t>(hit.object) + 1,
                   static_cast<uint32_t>(material), s.position, view.share * covered});
    pass_surface(view, s.position, covered);
  }
}

}  // namespace

uint64_t LayerRays::run(const FrameInputs& inputs, GBuffer& gbuffer) {
  gbuffer.behind.clear();
  std::vector<View> views = clear_views(inputs, gbuffer);
  uint64_t rays = 0;
  for (int layer = 0; layer < kMaxLayers && !views.empty(); ++layer) {
    rays += views.size();
    for (size_t first = 0; first < views.size(); first += embree::kPacket) {
      const size_t count = std::min<size_t>(embree::kPacket, views.size() - first);
      trace_packet(scene_, std::span(views).subspan(first, count), gbuffer.behind);
    }
    std::erase_if(views, is_over);
  }
  std::stable_sort(gbuffer.behind.begin(), gbuffer.behind.end(),
                   [](const auto& a, const auto& b) { return a.pixel < b.pixel; });
  return rays;
}

}  // namespace kestrel
