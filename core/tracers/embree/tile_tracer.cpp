// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/tile_tracer.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "frame/region_loops.h"
#include "shading/optics.h"
#include "shading/shading.h"
#include "shading/texture.h"
#include "stages/blend.h"
#include "tracers/embree/packet_surfaces.h"

namespace kestrel {
namespace {

/// Start of a ray that leaves a surface to the side of `normal`: far enough off it for float32
/// positions, `travelled` being the distance over which the position was computed, in metres.
vec3 leave_surface(const vec3& position, const vec3& normal, float travelled) {
  const float magnitude = max_component(glm::abs(position)) + travelled;
  return position + normal * (1.6e-5f * magnitude);
}

}  // namespace

TileTracer::TileTracer(const TraceRequest& request, const RtScene& scene, Buffers& buffers,
                       EffectBuffers& effects)
    : request_(request),
      rt_(scene),
      scene_(scene.scene()),
      effects_(effects),
      camera_(request.inputs),
      pixels_(buffers.pixels),
      paths_(buffers.paths),
      next_reflected_(buffers.next_reflected),
      next_refracted_(buffers.next_refracted),
      lit_(buffers.lit),
      hits_(buffers.hits),
      shadows_(buffers.shadows),
      rays_by_unit_(buffers.rays_by_unit),
      units_(buffers.units) {
  rays_by_unit_.resize(scene_.units.size(), 0);
  for (const uint32_t unit : units_) rays_by_unit_[unit] = 0;
  units_.clear();
}

void TileTracer::count(uint32_t unit, uint64_t& kind) {
  ++kind;
  if (rays_by_unit_[unit]++ == 0) units_.push_back(unit);
}

void TileTracer::add_counts(TraceCounts& counts) const {
  counts.rays += rays_;
  counts.trace_calls_ms += trace_calls_ms_;
  counts.rays_by_unit.resize(scene_.units.size(), 0);
  for (const uint32_t unit : units_) counts.rays_by_unit[unit] += rays_by_unit_[unit];
}

uint32_t TileTracer::unit_of(uint32_t pixel) const {
  return static_cast<uint32_t>(scene_.objects[request_.gbuffer.object[pixel] - 1].unit);
}

void TileTracer::trace(const Region& tile) {
  gather_pixels(tile);
  if (pixels_.empty()) return;
  trace_primary_shadows();
  start_paths();
  while (!paths_.empty() && !(request_.cancelled && request_.cancelled())) trace_depth();
}

/// In blocks of 4 x 4, so that a packet's rays stay close together.
void TileTracer::gather_pixels(const Region& tile) {
  constexpr int kBlock = 4, kBlocks = kTileSize / kBlock;
  pixels_.clear();
  const int stride = request_.pixel_stride;
  for (int i = 0; i < kTileSize * kTileSize; ++i) {
    const int block = i / (kBlock * kBlock), within = i % (kBlock * kBlock);
    const int x = block % kBlocks * kBlock + within % kBlock;
    const int y = block / kBlocks * kBlock + within / kBlock;
    if (x >= tile.width || y >= tile.height) continue;
    if ((tile.x + x) % stride != 0 || (tile.y + y) % stride != 0) continue;
    gather_pixel(static_cast<uint32_t>((tile.y + y) * request_.gbuffer.width + tile.x + x));
  }
}

void TileTracer::gather_pixel(uint32_t i) {
  const GBuffer& g = request_.gbuffer;
  if (g.object[i] == 0) return;
  const uint32_t unit = unit_of(i);
  const uint8_t effects = request_.selection.units[unit].effects;
  if (effects == 0) return;
  const Material& material = scene_.materials[g.material[i]];
  const auto width = static_cast<uint32_t>(g.width);
  const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
  Pixel p{i, unit, {}, camera_.to_viewer(g.position[i], x, y)};
  p.surface = {
      g.position[i],
      g.normal[i],
      g.normal_geometric[i],
      g.emission[i],
      g.ambient[i],
      g.diffuse[i],
      g.specular[i],
      g.optical[i],
      g.reflection_color.empty() ? material.reflection_color : g.reflection_color[i],
      g.transmission_color.empty() ? material.transmission_color : g.transmission_color[i]};
  p.entering = glm::dot(p.surface.normal_geometric, p.to_viewer) >= 0.0f;
  face_viewer(p.surface, p.to_viewer);
  p.reflectivity = effects & kReflections ? p.surface.optical.x : 0.0f;
  p.transparency = effects & kRefractions ? 1.0f - p.surface.optical.z : 0.0f;
  p.needs_lighting =
      (effects & kShadows) && blend_weights(p.reflectivity, p.transparency).surface > 0.0f;
  pixels_.push_back(p);
}

void TileTracer::trace_primary_shadows() {
  Incident incident;
  for (const Light& light : scene_.lights) {
    if (!light.casts_shadow) continue;
    for (const Pixel& p : pixels_) {
      if (!p.needs_lighting) continue;
      const Surface& s = p.surface;
      if (!incident_light(light, s.position, incident)) continue;
      const vec3 light_color = reflect_light(scene_.settings, s, p.to_viewer, light, incident);
      if (max_component(light_color) <= 0.0f) continue;
      const vec3 origin =
          leave_surface(s.position, s.normal_geometric, camera_.distance(s.position));
      shadows_.push(origin, incident.direction, incident.distance, {light_color, p.index});
      count(p.unit, rays_.shadow);
    }
    trace_calls_ms_ +=
        shadows_.resolve(rt_, [&](const ShadowQueue::Task& task, const vec3& transmitted) {
          effects_.shadow[task.target] -= task.light * (1.0f - transmitted);
        });
  }
}

void TileTracer::start_paths() {
  for (const Pixel& p : pixels_) {
    const Path eye{{}, -p.to_viewer, vec3(1.0f), 1.0f, p.index, 0, kCameraRays, false};
    spawn(eye, p.surface, p.entering, camera_.distance(p.surface.position), 1.0f, 1.0f,
          p.reflectivity, p.transparency);
  }
  take_next_paths();
}

/// Reflections first, then refractions: neighbours in a packet go the same way.
void TileTracer::take_next_paths() {
  paths_.clear();
  paths_.insert(paths_.end(), next_reflected_.begin(), next_reflected_.end());
  paths_.insert(paths_.end(), next_refracted_.begin(), next_refracted_.end());
  next_reflected_.clear();
  next_refracted_.clear();
}

void TileTracer::spawn(const Path& from, const Surface& facing, bool entering, float distance,
                       float weight_reflection, float weight_refraction, float reflectivity,
                       float transparency) {
  const auto emit = [&](const vec3& direction, const vec3& tint, float importance, uint8_t kind,
                        bool reflected) {
    const float side = glm::dot(direction, facing.normal_geometric) < 0.0f ? -1.0f : 1.0f;
    (reflected ? next_reflected_ : next_refracted_)
        .push_back({leave_surface(facing.position, side * facing.normal_geometric, distance),
                    direction, from.throughput * tint, importance, from.pixel,
                    static_cast<uint8_t>(from.depth + 1), kind,
                    from.depth == 0 ? reflected : from.reflected});
    count(unit_of(from.pixel), reflected ? rays_.reflection : rays_.refraction);
  };
  const float cutoff = scene_.settings.importance_cutoff;
  const float reflection_importance = from.importance * reflectivity;
  if (reflectivity > 0.0f && reflection_importance > cutoff) {
    emit(reflect_outward(from.direction, facing.normal, facing.normal_geometric),
         weight_reflection * facing.reflection_color, reflection_importance, kReflectionRays, true);
  }
  const float refraction_importance = from.importance * transparency;
  if (transparency > 0.0f && refraction_importance > cutoff) {
    const float outside = scene_.settings.environment_ior, inside = facing.optical.y;
    const float eta = entering ? outside / inside : inside / outside;
    const uint8_t kind = inside == outside ? from.kind : uint8_t{kRefractionRays};
    emit(refract_or_reflect(from.direction, facing.normal, eta),
         weight_refraction * facing.transmission_color, refraction_importance, kind, false);
  }
}

void TileTracer::trace_depth() {
  constexpr size_t kPacket = embree::kPacket;
  hits_.resize((paths_.size() + kPacket - 1) / kPacket);
  for (size_t i = 0; i < paths_.size(); ++i) {
    embree::set_ray(hits_[i / kPacket], i % kPacket, paths_[i].origin, paths_[i].direction, 0.0f,
                    INFINITY, paths_[i].kind);
  }
  const auto begin = std::chrono::steady_clock::now();
  embree::Query query;
  for (size_t p = 0; p < hits_.size(); ++p) {
    const embree::ValidLanes valid(paths_.size() - kPacket * p);
    embree::intersect(rt_.handle(), query, valid.mask, hits_[p]);
  }
  trace_calls_ms_ +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();

  for (size_t p = 0; p < hits_.size(); ++p) shade_packet(kPacket * p, hits_[p]);
  light_hits();
  take_next_paths();
}

/// `first`: the path of the packet's first lane.
void TileTracer::shade_packet(size_t first, const embree::RayHitPacket& packet) {
  const size_t count = std::min<size_t>(embree::kPacket, paths_.size() - first);
  const embree::PacketSurfaces met(rt_, embree::ValidLanes(count).mask, packet,
                                   paths_[first].depth);
  size_t next = 0;
  for (size_t lane = 0; lane < count; ++lane) {
    const Path& path = paths_[first + lane];
    const bool missed = packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID;
    if (leaves_hole(path, missed, missed ? kNone : met.hits[next].object)) {
      effects_.clear[path.pixel] += glm::dot(path.throughput, vec3(1.0f / 3.0f));
    } else if (missed) {
      sum_of(path.pixel, path.reflected) += path.throughput * sample_world(scene_, path.direction);
    } else {
      shade_hit(path, met.surfaces[next], packet.ray.tfar[lane]);
    }
    if (!missed) ++next;
  }
}

/// Whether a path that comes straight from the camera sees nothing: no world on a transparent
/// film, or a holdout.
bool TileTracer::leaves_hole(const Path& path, bool missed, int object) const {
  if (path.kind != kCameraRays) return false;
  return missed ? scene_.settings.film_transparent : scene_.objects[object].holdout;
}

/// `distance`: that the ray travelled, metres.
void TileTracer::shade_hit(const Path& path, Surface s, float distance) {
  const bool entering = glm::dot(s.normal_geometric, path.direction) < 0.0f;
  const vec3 to_viewer = -path.direction;
  face_viewer(s, to_viewer);

  const float reflectivity = s.optical.x, transparency = 1.0f - s.optical.z;
  BlendWeights w = blend_weights(reflectivity, transparency);
  if (path.depth >= scene_.settings.max_depth) {
    w = {1.0f, 0.0f, 0.0f};  // listing 8c: lighting stands in for what is not followed
  } else {
    spawn(path, s, entering, distance, w.reflection, w.refraction, reflectivity, transparency);
  }
  if (w.surface > 0.0f) {
    sum_of(path.pixel, path.reflected) += path.throughput * w.surface * unlit(scene_.settings, s);
    lit_.push_back(
        {s, to_viewer, path.throughput * w.surface, distance, path.pixel, path.reflected});
  }
}

/// Light for light, so that neighbours in a packet go the same way.
void TileTracer::light_hits() {
  Incident incident;
  for (const Light& light : scene_.lights) {
    for (const Hit& h : lit_) {
      const Surface& s = h.surface;
      if (!incident_light(light, s.position, incident)) continue;
      const vec3 light_color =
          h.weight * reflect_light(scene_.settings, s, h.to_viewer, light, incident);
      if (max_component(light_color) <= 0.0f) continue;
      if (!light.casts_shadow) {
        sum_of(h.pixel, h.reflected) += light_color;
        continue;
      }
      shadows_.push(leave_surface(s.position, s.normal_geometric, h.distance), incident.direction,
                    incident.distance, {light_color, h.pixel << 1 | (h.reflected ? 1u : 0u)});
      count(unit_of(h.pixel), rays_.shadow);
    }
  }
  lit_.clear();
  trace_calls_ms_ +=
      shadows_.resolve(rt_, [&](const ShadowQueue::Task& task, const vec3& transmitted) {
        sum_of(task.target >> 1, task.target & 1u) += task.light * transmitted;
      });
}

}  // namespace kestrel
