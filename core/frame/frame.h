// SPDX-License-Identifier: GPL-3.0-or-later
// The data between the four stages. All planes are row-major, row 0 at the bottom, float32.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/math.h"
#include "scene/scene.h"

namespace kestrel {

/// A rectangle of the picture, in pixels; row 0 is at the bottom.
struct Region {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
};

/// Through which point of the camera's aperture a sample looks.
struct LensSample {
  bool open = false;       // false: through its centre
  vec2 at{0.5f};           // point of the unit square that stands for the aperture
  bool per_pixel = false;  // every pixel another one: grain instead of many sharp pictures
};

/// What every stage needs to know of this frame. Stages work on the whole picture or, so that all
/// their data stays in the processor's cache, on a tile of it.
struct FrameInputs {
  const Scene& scene;
  int width;                           // of the picture, pixels
  int height;                          // of the picture, pixels
  vec2 subpixel{0.0f};                 // sample position, offset from the pixel's centre, in pixels
  float budget_ms = 0.0f;              // T for this sample: the frame's share; 0 means no limit
  Region region{0, 0, width, height};  // what is rendered now; the planes have its size
  LensSample lens{};
  bool keep_uv = false;      // fill GBuffer::uv
  bool keep_behind = false;  // fill GBuffer::behind
};

/// Planes are written whole by whoever fills them, in parallel: new memory is left uninitialised,
/// so that it is touched once.
template <typename T>
struct UninitializedAllocator : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = UninitializedAllocator<U>;
  };
  template <typename U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <typename U, typename... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};
template <typename T>
using Plane = std::vector<T, UninitializedAllocator<T>>;

/// A surface that shows through another one.
struct SurfaceLayer {
  uint32_t pixel;     // index in the region
  uint32_t object;    // as in the G-buffer
  uint32_t material;  // as in the G-buffer
  vec3 position;      // world space
  float coverage;     // share of the pixel's sample that it covers, 0…1
};

/// Stage 1's output (paper, Table 2), filled by the rasteriser or by primary rays.
/// Where `object == 0` nothing was hit: lighting holds the world, the other planes zero.
struct GBuffer {
  int width = 0;
  int height = 0;                // of the region
  Plane<vec3> position;          // world space
  Plane<vec3> normal;            // world space, unit, after normal maps, on the mesh's own side
  Plane<vec3> normal_geometric;  // world space, unit, of the triangle, on the mesh's own side
  Plane<vec3> emission;
  Plane<vec3> ambient;               // material ambient, without the global ambient light
  Plane<vec4> diffuse;               // A: alpha after the material's alpha mode (1 where opaque)
  Plane<vec4> specular;              // A: exponent, 0 … 1 for 1 … 255
  Plane<vec3> optical;               // R reflectivity, G index of refraction, B opacity incl. alpha
  Plane<float> heuristic_mask;       // stage 2: 1 selected, 0 not
  Plane<float> depth;                // reversed z: 1 at the near plane, 0 at the far one and beyond
  Plane<uint32_t> object;            // scene object index + 1, 0 = nothing
  Plane<uint32_t> material;          // scene material index (0 also where nothing)
  Plane<vec3> lighting;              // P-buffer: L, lit without shadows, reflections, refractions
  Plane<vec4> motion;                // pixels moved since the state before (XY) and until the one
                                     // after (ZW); of the first sample, where the pass is wanted
  Plane<uint8_t> holdout;            // 1: a holdout is in front, and so nothing; empty without any
  Plane<vec3> reflection_color;      // tints, as the material's; of primary rays in scenes with
  Plane<vec3> transmission_color;    // node programs, else empty: the material's
  Plane<vec2> uv;                    // of the mesh, before the material's tiling; may be left out
  std::vector<SurfaceLayer> behind;  // by pixel, front to back; may be left out

  /// The planes of every frame, and `uv`; `motion`, `holdout`, `behind` and the tints stay as they
  /// are.
  void resize(const FrameInputs& inputs);

  /// Makes a pixel show nothing, in front of this radiance.
  void set_nothing(size_t i, const vec3& radiance) {
    position[i] = normal[i] = normal_geometric[i] = vec3(0.0f);
    emission[i] = ambient[i] = optical[i] = vec3(0.0f);
    diffuse[i] = specular[i] = vec4(0.0f);
    depth[i] = 0.0f;
    object[i] = material[i] = 0;
    lighting[i] = radiance;
    if (!uv.empty()) uv[i] = vec2(0.0f);
  }
};

/// Share that a surface covers of what lies straight behind it, 0…1: glass that bends the view
/// covers all of it.
inline float straight_coverage(const Scene& scene, const vec3& optical, float alpha) {
  return optical.y == scene.settings.environment_ior ? optical.z : alpha;
}
inline float coverage(const Scene& scene, const GBuffer& gbuffer, size_t i) {
  return straight_coverage(scene, gbuffer.optical[i], gbuffer.diffuse[i].w);
}

/// The layers behind the surface of a pixel.
std::span<const SurfaceLayer> layers_behind(const GBuffer& gbuffer, size_t pixel);

/// Bits of what stage 3 does for a unit.
enum EffectBits : uint8_t { kShadows = 1, kReflections = 2, kRefractions = 4 };

/// Every factor of the paper's Table 3 for one unit in one frame.
struct UnitSelection {
  uint64_t area = 0;            // A: visible pixels
  float centrality = 0.0f;      // P: 0.01 … 1, 1 in the middle of the view
  float distance = 0.0f;        // D: camera to the box's centre, metres
  float visibility = 0.0f;      // V = A P / D                        (eq. 1)
  float rays = 0.0f;            // Q: rays per pixel
  float estimated_cost = 0.0f;  // E, learned where the setting is 0
  float cost = 0.0f;            // C = A Q E, in milliseconds         (eq. 2)
  float relevance = 0.0f;       // R = (S I + V) K                    (eq. 3)
  bool was_selected = false;    // S
  bool selected = false;
  uint8_t effects = 0;       // EffectBits traced this frame
  double ms = 0.0;           // measured after stage 3: this unit's share of the trace time
  uint64_t traced_rays = 0;  // measured: rays started for its pixels, all depths
};

/// Stage 2's output.
struct Selection {
  std::vector<UnitSelection> units;  // parallel to Scene::units
};

struct RayCounts {
  uint64_t primary = 0;
  uint64_t shadow = 0;
  uint64_t reflection = 0;
  uint64_t refraction = 0;

  uint64_t secondary() const { return shadow + reflection + refraction; }
  RayCounts& operator+=(const RayCounts& o) {
    primary += o.primary;
    shadow += o.shadow;
    reflection += o.reflection;
    refraction += o.refraction;
    return *this;
  }
};

/// What tracing took: a sum over regions and samples.
struct TraceCounts {
  RayCounts rays;
  double trace_calls_ms = 0.0;         // thread time inside Embree calls
  std::vector<uint64_t> rays_by_unit;  // parallel to Scene::units

  /// Nothing yet, of a scene with so many units.
  void reset(size_t units);
  TraceCounts& operator+=(const TraceCounts& o);
};

/// Stage 3's output. Where nothing is traced: shadow 1, the others 0.
struct EffectBuffers {
  Plane<vec3> shadow;      // S = 1 - Σ blocked light, unclamped
  Plane<vec3> reflection;  // M, already tinted by the material's reflection colour
  Plane<vec3> refraction;  // R, already tinted by the material's transmission colour
  Plane<float> clear;      // share of R behind which is nothing: a transparent film or a holdout;
                           // empty where the scene cannot have any
};

}  // namespace kestrel
