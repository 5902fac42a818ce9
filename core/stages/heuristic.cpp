// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/heuristic.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string_view>
#include <unordered_map>

#include "frame/region_loops.h"

namespace kestrel {
namespace {

constexpr float kMinCentrality = 0.01f;  // P outside the view (listing 6)
constexpr float kMinDistance = 1e-3f;    // metres; keeps V finite where the camera is inside

// Learning E.
constexpr float kCostSmoothing = 0.5f;  // weight of a new measurement
constexpr double kPriorPixels = 4.0;    // a probe's few pixels against what was believed
constexpr float kMinCost = 0.01f, kMaxCost = 1e4f;
constexpr int kMaxStarvedFrames = 60;

// ---- Rays per pixel: Q -----------------------------------------------------------------------

/// Lights that a pixel, or a point that it reflects or refracts, sends a shadow ray to.
size_t shadow_light_count(const Scene& scene) {
  return std::count_if(scene.lights.begin(), scene.lights.end(),
                       [](const Light& light) { return light.casts_shadow; });
}

/// Q of the given effects (listing 6): a shadow ray for each light, from the pixel and from what it
/// reflects and refracts; one ray for the reflection; four for refraction, which goes through two
/// surfaces at least and may reflect inside.
float rays_per_pixel(uint8_t effects, size_t lights) {
  size_t rays = 0;
  if (effects & kShadows) rays += lights;
  if (effects & kReflections) rays += 1 + lights;
  if (effects & kRefractions) rays += 4 + lights;
  return static_cast<float>(rays);
}

/// EffectBits that a unit can have at all, by who decides.
struct WantedEffects {
  uint8_t automatic = 0;  // the heuristic
  uint8_t always = 0;

  uint8_t all() const { return automatic | always; }
};

WantedEffects wanted_effects(const Unit& unit, size_t lights) {
  WantedEffects wanted;
  const auto add = [&wanted](bool applies, EffectMode mode, EffectBits bit) {
    if (!applies || mode == EffectMode::never) return;
    (mode == EffectMode::always ? wanted.always : wanted.automatic) |= bit;
  };
  add(lights > 0, unit.settings.shadows, kShadows);
  add(unit.reflective, unit.settings.reflections, kReflections);
  add(unit.refractive, unit.settings.refractions, kRefractions);
  return wanted;
}

// ---- Factors: A, P, D ------------------------------------------------------------------------

/// Fills A.
void measure_areas(const Scene& scene, const Areas& areas, Selection& selection) {
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const int unit = scene.objects[i].unit;
    if (unit != kNone) selection.units[unit].area += areas[i + 1];
  }
}

/// P of a point: from 1 in the middle of the view to 0.01 at the middle of its edges, beyond them
/// and behind the camera. An orthographic view with a negative near plane begins behind it.
float centrality(const Camera& camera, const vec3& point_camera) {
  const float depth = -point_camera.z;
  if (!(depth > std::min(0.0f, camera.near_clip))) return kMinCentrality;
  const float scale = camera.projection == Projection::perspective ? depth : 1.0f;
  const float x = 2.0f * (point_camera.x / scale - camera.left) / (camera.right - camera.left) - 1;
  const float y =
      2.0f * (point_camera.y / scale - camera.bottom) / (camera.top - camera.bottom) - 1;
  const float radius_ndc = std::sqrt(x * x + y * y);
  return (radius_ndc < 1.0f ? 1.0f - radius_ndc : 0.0f) * (1.0f - kMinCentrality) + kMinCentrality;
}

/// Fills P and D; a box that is not finite counts as infinitely far.
void locate(const Camera& camera, const Bounds& bounds_ws, UnitSelection& unit) {
  const vec3 from_camera_ws = bounds_ws.center() - camera.world_from_camera[3];
  if (!is_finite(from_camera_ws)) {
    unit.centrality = kMinCentrality;
    unit.distance = std::numeric_limits<float>::infinity();
    return;
  }
  // The camera's matrix is rigid: its transposed rotation is the inverse one.
  unit.centrality = centrality(camera, from_camera_ws * mat3(camera.world_from_camera));
  unit.distance = std::max(glm::length(from_camera_ws), kMinDistance);
}

// ---- Candidates ------------------------------------------------------------------------------

/// Visible units of which some effect is left to decide, and what those cost that leave nothing.
struct Candidates {
  std::vector<SelectionNode> nodes;
  std::vector<uint32_t> units;   // by node
  std::vector<uint8_t> effects;  // by node: EffectBits to decide on
  double cost_of_always = 0.0;   // milliseconds
};

/// Also gives every visible unit its `always` effects; one that has no others is thereby selected.
Candidates grant_always(const Scene& scene, double ms_per_ray, Selection& selection) {
  const size_t lights = shadow_light_count(scene);
  Candidates candidates;
  for (size_t i = 0; i < selection.units.size(); ++i) {
    UnitSelection& u = selection.units[i];
    const WantedEffects wanted = wanted_effects(scene.units[i], lights);
    if (u.area == 0 || wanted.all() == 0) continue;
    u.effects = wanted.always;
    u.selected = wanted.automatic == 0;
    const double cost_of_q = static_cast<double>(u.area) * u.estimated_cost * ms_per_ray;
    candidates.cost_of_always += rays_per_pixel(wanted.always, lights) * cost_of_q;
    if (wanted.automatic == 0) continue;
    candidates.nodes.push_back({rays_per_pixel(wanted.automatic, lights) * cost_of_q, u.relevance});
    candidates.units.push_back(static_cast<uint32_t>(i));
    candidates.effects.push_back(wanted.automatic);
  }
  return candidates;
}

}  // namespace

// ---- The stage -------------------------------------------------------------------------------

void count_areas(const FrameInputs& inputs, const GBuffer& gbuffer, Areas& areas) {
  const size_t id_count = inputs.scene.objects.size() + 1;
  areas.resize(id_count, 0);
  const size_t width = static_cast<size_t>(inputs.region.width);
  const auto count_row = [&](int y, auto& counts) {
    for (size_t i = y * width; i < (y + 1) * width;) {
      const uint32_t id = gbuffer.object[i];
      const size_t first = i;
      while (i < (y + 1) * width && gbuffer.object[i] == id) ++i;
      assert(id < id_count);
      counts[id] += i - first;
    }
  };
  if (is_tile(inputs.region)) {
    for_rows(inputs.region, [&](int y) { count_row(y, areas); });
    return;
  }
  tbb::enumerable_thread_specific<Areas> partial([id_count] { return Areas(id_count, 0); });
  for_rows(inputs.region, [&](int y) { count_row(y, partial.local()); });
  for (const Areas& counts : partial) {
    for (size_t id = 0; id < id_count; ++id) areas[id] += counts[id];
  }
}

void write_heuristic_mask(const FrameInputs& inputs, const Selection& selection, GBuffer& gbuffer) {
  gbuffer.heuristic_mask.resize(gbuffer.object.size());
  const size_t width = static_cast<size_t>(inputs.region.width);
  for_rows(inputs.region, [&](int y) {
    for (size_t i = y * width; i < (y + 1) * width; ++i) {
      const uint32_t id = gbuffer.object[i];
      const int unit = id == 0 ? kNone : inputs.scene.objects[id - 1].unit;
      gbuffer.heuristic_mask[i] = unit != kNone && selection.units[unit].effects ? 1.0f : 0.0f;
    }
  });
}

Selection HeuristicStage::select(const FrameInputs& inputs, const Areas& areas) {
  match_units(inputs.scene.units);
  if (starved_frames_ >= kMaxStarvedFrames) {
    ray_cost_.forget();
    starved_frames_ = 0;
  }
  Selection selection;
  selection.units.resize(inputs.scene.units.size());
  measure_areas(inputs.scene, areas, selection);
  estimate(inputs, selection);
  choose(inputs, selection);
  return selection;
}

void HeuristicStage::remember(const Selection& selection) {
  bool left_out = false, traced = false;
  for (size_t i = 0; i < memory_.size(); ++i) {
    const UnitSelection& u = selection.units[i];
    memory_[i].was_selected = u.selected;
    traced |= u.effects != 0;
    left_out |= u.area > 0 && !u.selected;
  }
  starved_frames_ = left_out && !traced ? starved_frames_ + 1 : 0;
}

void HeuristicStage::match_units(const std::vector<Unit>& units) {
  if (std::equal(units.begin(), units.end(), memory_.begin(), memory_.end(),
                 [](const Unit& u, const UnitMemory& m) { return u.name == m.name; })) {
    return;
  }
  // Each memory goes to one unit only: of units that share a name, the first keeps it.
  std::unordered_map<std::string_view, const UnitMemory*> known;
  for (const UnitMemory& m : memory_) known.emplace(m.name, &m);
  std::vector<UnitMemory> matched(units.size());
  for (size_t i = 0; i < units.size(); ++i) {
    const auto found = known.find(units[i].name);
    if (found != known.end()) {
      matched[i] = *found->second;
      known.erase(found);
    }
    matched[i].name = units[i].name;
  }
  memory_ = std::move(matched);
}

/// Table 3 for every unit, from A on. What is not visible stays out: V, C and R are 0.
void HeuristicStage::estimate(const FrameInputs& inputs, Selection& selection) const {
  const Scene& scene = inputs.scene;
  const size_t lights = shadow_light_count(scene);
  for (size_t i = 0; i < selection.units.size(); ++i) {
    const Unit& unit = scene.units[i];
    UnitSelection& u = selection.units[i];
    locate(scene.camera, unit.bounds, u);
    u.rays = rays_per_pixel(wanted_effects(unit, lights).all(), lights);
    u.estimated_cost = unit.settings.cost > 0.0f ? unit.settings.cost
                       : memory_[i].cost > 0.0f  ? memory_[i].cost
                                                 : 1.0f;
    u.was_selected = memory_[i].was_selected;
    if (u.area == 0) continue;
    const double area = static_cast<double>(u.area);
    u.visibility = static_cast<float>(area * u.centrality / u.distance);
    u.cost = static_cast<float>(area * u.rays * u.estimated_cost * ray_cost_.ms_per_ray());
    u.relevance = (u.was_selected * scene.settings.selection_inertia + u.visibility) *
                  unit.settings.relevance;
  }
}

/// Fills `selected` and `effects`.
void HeuristicStage::choose(const FrameInputs& inputs, Selection& selection) const {
  const SelectionPolicy policy = inputs.scene.settings.selection;
  const bool limited = policy == SelectionPolicy::graph && inputs.budget_ms > 0.0f;
  Candidates candidates = grant_always(inputs.scene, ray_cost_.ms_per_ray(), selection);
  if (policy == SelectionPolicy::none) candidates.nodes.clear();

  const double budget = limited && calibrated()
                            ? inputs.budget_ms / ray_cost_.headroom() - candidates.cost_of_always
                            : std::numeric_limits<double>::infinity();
  const std::vector<bool> chosen = select_nodes(candidates.nodes, budget);
  for (size_t n = 0; n < chosen.size(); ++n) {
    if (!chosen[n]) continue;
    UnitSelection& u = selection.units[candidates.units[n]];
    u.selected = true;
    u.effects |= candidates.effects[n];
  }
}

// ---- Learning --------------------------------------------------------------------------------

void HeuristicStage::learn(const FrameInputs& inputs, Selection& selection,
                           const TraceCounts& counts, double trace_ms, double coverage) {
  const Scene& scene = inputs.scene;
  assert(selection.units.size() == memory_.size());
  assert(counts.rays_by_unit.size() == selection.units.size());
  uint64_t traced_rays = 0;
  for (const uint64_t rays : counts.rays_by_unit) traced_rays += rays;
  const size_t lights = shadow_light_count(scene);
  double predicted_rays = 0.0;  // before anything is learned from this frame
  for (size_t i = 0; i < selection.units.size(); ++i) {
    UnitSelection& u = selection.units[i];
    u.traced_rays = counts.rays_by_unit[i];
    u.ms = traced_rays ? trace_ms * static_cast<double>(u.traced_rays) / traced_rays : 0.0;
    predicted_rays += static_cast<double>(u.area) * rays_per_pixel(u.effects, lights) *
                      u.estimated_cost * coverage;
  }
  if (traced_rays == 0) return;
  const double rays = learn_unit_costs(scene, selection, coverage);
  ray_cost_.observe(
      {trace_ms, rays, predicted_rays * ray_cost_.ms_per_ray(), scene.settings.budget_ms});
}

/// Returns Σ A Q E over what was traced, times the coverage, with E as it now is.
double HeuristicStage::learn_unit_costs(const Scene& scene, const Selection& selection,
                                        double coverage) {
  const size_t lights = shadow_light_count(scene);
  double rays = 0.0;
  for (size_t i = 0; i < selection.units.size(); ++i) {
    const UnitSelection& u = selection.units[i];
    const double pixels = static_cast<double>(u.area) * coverage;
    const double q = rays_per_pixel(u.effects, lights);
    if (pixels == 0.0 || q == 0.0) continue;
    float cost = u.estimated_cost;
    // E stands for all of a unit's effects together: part of them would say something else.
    const bool traced_whole = u.effects == wanted_effects(scene.units[i], lights).all();
    if (scene.units[i].settings.cost <= 0.0f && traced_whole) {
      // Coverage below 1 is a sample of the pixels, the smaller the less it is to be trusted.
      const double prior = kPriorPixels * std::max(1.0 - coverage, 0.0);
      const double measured = (u.traced_rays / q + prior * cost) / (pixels + prior);
      const float weight = memory_[i].cost > 0.0f ? kCostSmoothing : 1.0f;
      cost += weight * (static_cast<float>(measured) - cost);
      cost = std::clamp(cost, kMinCost, kMaxCost);
      memory_[i].cost = cost;
    }
    rays += pixels * q * cost;
  }
  return rays;
}

}  // namespace kestrel
