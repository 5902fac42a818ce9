// SPDX-License-Identifier: GPL-3.0-or-later
// What stage 2 takes of a frame at 1280x720: all of it, and its parts, by number of objects.
// Run with --benchmark_repetitions=9 and read the median.
#include <benchmark/benchmark.h>

#include <random>
#include <string>

#include "stages/heuristic.h"

namespace kestrel {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

/// A crowd of units, every fourth reflective and every seventh refractive, below three lights.
Scene make_scene(int units) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> side(-10.0f, 10.0f);
  std::uniform_real_distribution<float> depth(-60.0f, -2.0f);
  Scene scene;
  scene.lights.resize(3);
  scene.units.resize(units);
  scene.objects.resize(units);
  for (int i = 0; i < units; ++i) {
    Unit& unit = scene.units[i];
    unit.name = "Collection instance of something." + std::to_string(i);
    const vec3 center(side(random), side(random), depth(random));
    unit.bounds = {center - vec3(0.5f), center + vec3(0.5f)};
    unit.reflective = i % 4 == 0;
    unit.refractive = i % 7 == 0;
    scene.objects[i].name = unit.name;
    scene.objects[i].unit = i;
  }
  scene.settings.budget_ms = 20.0f;
  return scene;
}

/// Tiles of `size` pixels, each of one object: 8 puts all of 10,000 objects in view, as a crowd.
GBuffer make_gbuffer(int units, int size) {
  GBuffer gbuffer;
  gbuffer.width = kWidth;
  gbuffer.height = kHeight;
  gbuffer.object.resize(static_cast<size_t>(kWidth) * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int tile = y / size * (kWidth / size) + x / size;
      gbuffer.object[y * kWidth + x] = static_cast<uint32_t>(tile * 7919L % (units + 1));
    }
  }
  return gbuffer;
}

/// What a tracer would report that needs the predicted number of rays.
TraceCounts predicted_effects(const Selection& selection) {
  TraceCounts effects;
  for (const UnitSelection& u : selection.units) {
    effects.rays_by_unit.push_back(
        u.effects ? static_cast<uint64_t>(static_cast<double>(u.area) * u.rays) : 0);
  }
  return effects;
}

Selection run(HeuristicStage& stage, const FrameInputs& inputs, GBuffer& gbuffer) {
  Areas areas;
  count_areas(inputs, gbuffer, areas);
  Selection selection = stage.select(inputs, areas);
  write_heuristic_mask(inputs, selection, gbuffer);
  stage.remember(selection);
  return selection;
}

void BM_Frame(benchmark::State& state) {
  const int units = static_cast<int>(state.range(0));
  const Scene scene = make_scene(units);
  GBuffer gbuffer = make_gbuffer(units, 8);
  const FrameInputs inputs{scene, kWidth, kHeight, vec2(0.0f), scene.settings.budget_ms};
  HeuristicStage stage;
  Selection selection = run(stage, inputs, gbuffer);
  stage.learn(inputs, selection, predicted_effects(selection), 50.0);
  for (auto _ : state) {
    selection = run(stage, inputs, gbuffer);
    state.PauseTiming();
    const TraceCounts effects = predicted_effects(selection);
    state.ResumeTiming();
    stage.learn(inputs, selection, effects, 20.0);
  }
  int selected = 0;
  for (const UnitSelection& u : selection.units) selected += u.selected;
  state.counters["selected"] = selected;
}
BENCHMARK(BM_Frame)
    ->Arg(30)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_Walk(benchmark::State& state) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(0.0, 1.0);
  std::vector<SelectionNode> nodes(state.range(0));
  double sum = 0.0;
  for (SelectionNode& n : nodes) {
    n = {value(random), value(random)};
    sum += n.cost;
  }
  for (auto _ : state) benchmark::DoNotOptimize(select_nodes(nodes, 0.5 * sum));
}
BENCHMARK(BM_Walk)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kestrel
