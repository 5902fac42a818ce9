// SPDX-License-Identifier: GPL-3.0-or-later
// Whitted ray tracing of one tile, breadth first: all shadow rays of a light, then all reflections
// and refractions of a depth, so that rays reach Embree in batches. Because equations 5 and 6 are
// linear, every ray carries its share of the pixel and nothing has to be put together afterwards.
#pragma once

#include <vector>

#include "frame/camera_rays.h"
#include "shading/surface.h"
#include "tracers/embree/shadow_queue.h"
#include "tracers/tracer.h"

namespace kestrel {

class TileTracer {
 public:
  /// Memory that one tile after the other uses.
  class Buffers;

  /// All must outlive it.
  TileTracer(const TraceRequest& request, const RtScene& scene, Buffers& buffers,
             EffectBuffers& effects);

  /// A tile of at most kTileSize, in pixels of the request's region.
  void trace(const Region& tile);

  /// Adds what the traced tile took.
  void add_counts(TraceCounts& counts) const;

 private:
  /// A reflection or refraction ray on its way.
  struct Path {
    vec3 origin;
    vec3 direction;
    vec3 throughput;   // what its radiance is multiplied with
    float importance;  // product of the reflectivities and transparencies along it
    uint32_t pixel;    // in the picture
    uint8_t depth;     // 1: from the G-buffer
    uint8_t kind;      // one of RayBits
    bool reflected;    // goes to M, else to R
  };
  /// Where a path met a surface whose own light shows.
  struct Hit {
    Surface surface;  // faces the viewer
    vec3 to_viewer;
    vec3 weight;     // of its light in the pixel's M or R
    float distance;  // that the ray travelled, metres
    uint32_t pixel;
    bool reflected;
  };
  /// A pixel of the tile that something is traced for.
  struct Pixel {
    uint32_t index;
    uint32_t unit;
    Surface surface;  // faces the viewer
    vec3 to_viewer;
    bool entering = true;        // the mesh's own side faces the viewer
    bool needs_lighting = true;  // shadows are traced, and the surface's own light shows
    float reflectivity = 0.0f;   // of what is traced
    float transparency = 0.0f;
  };

  void gather_pixels(const Region& tile);
  void gather_pixel(uint32_t index);
  void trace_primary_shadows();
  void start_paths();
  void trace_depth();
  void shade_packet(size_t first, const embree::RayHitPacket& packet);
  bool leaves_hole(const Path& path, bool missed, int object) const;
  void shade_hit(const Path& path, Surface surface, float distance);
  void light_hits();
  void take_next_paths();
  void spawn(const Path& from, const Surface& facing, bool entering, float distance,
             float weight_reflection, float weight_refraction, float reflectivity,
             float transparency);
  vec3& sum_of(uint32_t pixel, bool reflected) {
    return (reflected ? effects_.reflection : effects_.refraction)[pixel];
  }
  uint32_t unit_of(uint32_t pixel) const;
  void count(uint32_t unit, uint64_t& kind);

  const TraceRequest& request_;
  const RtScene& rt_;
  const Scene& scene_;
  EffectBuffers& effects_;
  CameraRays camera_;

  std::vector<Pixel>& pixels_;
  std::vector<Path>& paths_;
  std::vector<Path>& next_reflected_;
  std::vector<Path>& next_refracted_;
  std::vector<Hit>& lit_;
  std::vector<embree::RayHitPacket>& hits_;
  ShadowQueue& shadows_;
  std::vector<uint64_t>& rays_by_unit_;  // 0 outside units_
  std::vector<uint32_t>& units_;         // that rays were started for
  RayCounts rays_;
  double trace_calls_ms_ = 0.0;
};

class TileTracer::Buffers {
  friend class TileTracer;
  std::vector<Pixel> pixels;
  std::vector<Path> paths;
  std::vector<Path> next_reflected;
  std::vector<Path> next_refracted;
  std::vector<Hit> lit;
  std::vector<embree::RayHitPacket> hits;
  ShadowQueue shadows;
  std::vector<uint64_t> rays_by_unit;
  std::vector<uint32_t> units;
};

}  // namespace kestrel
