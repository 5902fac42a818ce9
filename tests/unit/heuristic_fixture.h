// SPDX-License-Identifier: GPL-3.0-or-later
// Views for stage 2, made of nothing but units and the pixels that they cover.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "stages/heuristic.h"

namespace kestrel {

inline constexpr int kWidth = 100;
inline constexpr int kHeight = 50;

/// A unit of one object, as a cube of 2 cm around `center`.
inline void add_unit(Scene& scene, const std::string& name, const vec3& center,
                     bool reflective = false, bool refractive = false) {
  Unit unit;
  unit.name = name;
  unit.bounds = {center - vec3(0.01f), center + vec3(0.01f)};
  unit.reflective = reflective;
  unit.refractive = refractive;
  Object object;
  object.name = name;
  object.unit = static_cast<int>(scene.units.size());
  scene.units.push_back(unit);
  scene.objects.push_back(object);
}

inline void add_lights(Scene& scene, int casting, int others = 0) {
  for (int i = 0; i < casting + others; ++i) {
    Light light;
    light.casts_shadow = i < casting;
    scene.lights.push_back(light);
  }
}

/// Looks along -Z from the origin; the picture shows x from -2 to 2 and y from -1 to 1 at z = -1.
inline Scene make_scene(int lights = 1) {
  Scene scene;
  scene.camera.left = -2.0f;
  scene.camera.right = 2.0f;
  add_lights(scene, lights);
  return scene;
}

/// The given number of pixels for each object, one object after the other. Only the plane of object
/// ids is made, as stage 2 reads no other.
inline GBuffer make_gbuffer(const std::vector<int>& areas, int width = kWidth,
                            int height = kHeight) {
  GBuffer gbuffer;
  gbuffer.width = width;
  gbuffer.height = height;
  gbuffer.object.reserve(static_cast<size_t>(width) * height);
  for (size_t object = 0; object < areas.size(); ++object) {
    gbuffer.object.insert(gbuffer.object.end(), areas[object], static_cast<uint32_t>(object + 1));
  }
  if (gbuffer.object.size() > static_cast<size_t>(width) * height) {
    throw std::logic_error("the picture is too small for these areas");
  }
  gbuffer.object.resize(static_cast<size_t>(width) * height, 0);
  return gbuffer;
}

/// Stage 2 of one frame. What is selected for a probe, while costs are unknown, is not remembered.
inline Selection run(HeuristicStage& stage, const FrameInputs& inputs, GBuffer& gbuffer) {
  Areas areas;
  count_areas(inputs, gbuffer, areas);
  const Selection selection = stage.select(inputs, areas);
  write_heuristic_mask(inputs, selection, gbuffer);
  const bool limited =
      inputs.scene.settings.selection == SelectionPolicy::graph && inputs.budget_ms > 0.0f;
  if (!limited || stage.calibrated()) stage.remember(selection);
  return selection;
}

inline Selection run(HeuristicStage& stage, const Scene& scene, const std::vector<int>& areas) {
  GBuffer gbuffer = make_gbuffer(areas);
  return run(stage, {scene, kWidth, kHeight, vec2(0.0f), scene.settings.budget_ms}, gbuffer);
}

inline Selection run_once(const Scene& scene, const std::vector<int>& areas) {
  HeuristicStage stage;
  return run(stage, scene, areas);
}

inline void learn(HeuristicStage& stage, const Scene& scene, Selection& selection,
                  const std::vector<uint64_t>& rays, double ms, double coverage = 1.0) {
  TraceCounts effects;
  effects.rays_by_unit = rays;
  stage.learn({scene, kWidth, kHeight}, selection, effects, ms, coverage);
}

/// Teaches `ms` per ray where every visible unit needs just the Q rays per pixel it was given.
inline void calibrate(HeuristicStage& stage, Scene scene, const std::vector<int>& areas,
                      double ms) {
  scene.settings.selection = SelectionPolicy::all;
  Selection selection = run(stage, scene, areas);
  std::vector<uint64_t> rays;
  double sum = 0.0;
  for (const UnitSelection& u : selection.units) {
    rays.push_back(static_cast<uint64_t>(std::lround(u.area * u.rays)));
    sum += static_cast<double>(rays.back());
  }
  learn(stage, scene, selection, rays, ms * sum);
}

inline std::vector<bool> selected(const Selection& selection) {
  std::vector<bool> flags;
  for (const UnitSelection& u : selection.units) flags.push_back(u.selected);
  return flags;
}

inline double total_cost(const Selection& selection) {
  double sum = 0.0;
  for (const UnitSelection& u : selection.units) sum += u.selected ? u.cost : 0.0;
  return sum;
}

using Flags = std::vector<bool>;

}  // namespace kestrel
