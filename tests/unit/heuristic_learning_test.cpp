// SPDX-License-Identifier: GPL-3.0-or-later
// What stage 2 learns from traced frames: E of a unit, and milliseconds.
#include <gtest/gtest.h>

#include <cmath>

#include "stages/heuristic.h"
#include "unit/heuristic_fixture.h"

namespace kestrel {
namespace {

TEST(Heuristic, AProbeComesFirstAndDoesNotCountAsSelected) {
  Scene scene = make_scene();
  scene.settings.budget_ms = 20.0f;
  add_unit(scene, "a", {0, 0, -5});
  add_unit(scene, "b", {0, 0, -5});
  HeuristicStage stage;
  Selection s = run(stage, scene, {2560, 1024});
  EXPECT_FALSE(stage.calibrated());
  EXPECT_EQ(selected(s), (Flags{1, 1})) << "the probe needs all that is visible";
  learn(stage, scene, s, {10, 4}, 0.14, 1.0 / 256.0);  // one ray a pixel as predicted, 0.01 ms each
  EXPECT_TRUE(stage.calibrated());
  s = run(stage, scene, {2560, 1024});
  EXPECT_FALSE(s.units[0].was_selected);
  EXPECT_NEAR(s.units[0].cost, 25.6f, 0.01f);
  EXPECT_EQ(selected(s), (Flags{0, 1})) << "25.6 ms do not fit, 10.2 ms do";
}

TEST(Heuristic, AProbesFewPixelsDoNotDecideAUnitsCost) {
  Scene scene = make_scene();
  scene.settings.budget_ms = 20.0f;
  add_unit(scene, "small", {0, 0, -5});
  add_unit(scene, "large", {0, 0, -5});
  HeuristicStage stage;
  GBuffer gbuffer = make_gbuffer({300, 512000}, 1024, 512);
  const FrameInputs inputs{scene, 1024, 512, vec2(0.0f), 20.0f};
  Selection s = run(stage, inputs, gbuffer);
  TraceCounts effects;
  effects.rays_by_unit = {0, 4000};  // the small one was missed, the large one needs twice Q
  stage.learn(inputs, s, effects, 1.0, 1.0 / 256.0);
  s = run(stage, inputs, gbuffer);
  EXPECT_GT(s.units[0].estimated_cost, 0.5f);
  EXPECT_NEAR(s.units[1].estimated_cost, 2.0f, 0.01f);
}

TEST(Heuristic, LearnFillsWhatWasMeasured) {
  Scene scene = make_scene();
  for (const char* name : {"a", "b", "c"}) add_unit(scene, name, {0, 0, -5});
  HeuristicStage stage;
  Selection s = run(stage, scene, {100, 50, 0});
  learn(stage, scene, s, {300, 100, 0}, 8.0);
  EXPECT_DOUBLE_EQ(s.units[0].ms, 6.0);
  EXPECT_DOUBLE_EQ(s.units[1].ms, 2.0);
  EXPECT_DOUBLE_EQ(s.units[2].ms, 0.0);
  EXPECT_EQ(s.units[0].traced_rays, 300u);
  EXPECT_EQ(s.units[1].traced_rays, 100u);
}

TEST(Heuristic, LearnedCostOfAUnitIsRaysOverPredictedRays) {
  Scene scene = make_scene(2);
  add_unit(scene, "glass", {0, 0, -5}, true, true);  // Q = 2 + 3 + 6 = 11
  add_unit(scene, "wall", {0, 0, -5});               // Q = 2
  scene.units[1].settings.cost = 5.0f;
  HeuristicStage stage;
  Selection s = run(stage, scene, {100, 100});
  learn(stage, scene, s, {2200, 200}, 60.0);
  s = run(stage, scene, {100, 100});
  EXPECT_FLOAT_EQ(s.units[0].estimated_cost, 2.0f);
  EXPECT_FLOAT_EQ(s.units[1].estimated_cost, 5.0f) << "a setting is not learned over";
  EXPECT_NEAR(total_cost(s), 60.0, 1e-3) << "together they cost what was measured";
  EXPECT_NEAR(s.units[0].cost / s.units[1].cost, 2200.0 / 1000.0, 1e-4);
}

TEST(Heuristic, SamplesCountAsCoverage) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  HeuristicStage stage;
  Selection s = run(stage, scene, {100});
  learn(stage, scene, s, {2400}, 48.0, 16.0);  // 16 samples: 150 rays and 3 ms each
  s = run(stage, scene, {100});
  EXPECT_FLOAT_EQ(s.units[0].estimated_cost, 1.5f);
  EXPECT_NEAR(s.units[0].cost, 3.0, 1e-4);
}

TEST(Heuristic, ALearnedCostIsRememberedWhileTheUnitIsNotTraced) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  add_unit(scene, "b", {0, 0, -5});
  HeuristicStage stage;
  Selection s = run(stage, scene, {100, 100});
  learn(stage, scene, s, {400, 100}, 5.0);
  for (int frame = 0; frame < 20; ++frame) {
    s = run(stage, scene, {0, 100});
    learn(stage, scene, s, {0, 100}, 1.0);
  }
  EXPECT_FLOAT_EQ(run(stage, scene, {100, 100}).units[0].estimated_cost, 4.0f);
}

TEST(Heuristic, PartOfAUnitsEffectsTeachesNothingAboutTheRest) {
  Scene scene = make_scene();
  add_unit(scene, "mirror", {0, 0, -5}, true);
  scene.units[0].settings.shadows = EffectMode::always;
  HeuristicStage stage;
  Selection s = run(stage, scene, {100});
  learn(stage, scene, s, {900}, 9.0);  // Q = 3: E = 3
  scene.settings.selection = SelectionPolicy::none;
  s = run(stage, scene, {100});
  ASSERT_EQ(s.units[0].effects, kShadows);
  learn(stage, scene, s, {10}, 0.1);
  EXPECT_FLOAT_EQ(run(stage, scene, {100}).units[0].estimated_cost, 3.0f);
}

TEST(Heuristic, OneStalledFrameHardlyChangesTheCost) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  HeuristicStage stage;
  const auto frame = [&](double ms) {
    Selection s = run(stage, scene, {1000});
    learn(stage, scene, s, {1000}, ms);
    return run(stage, scene, {1000}).units[0].cost;
  };
  for (int i = 0; i < 10; ++i) frame(10.0);
  EXPECT_LT(frame(500.0), 14.0f);
  for (int i = 0; i < 9; ++i) frame(10.0);
  EXPECT_NEAR(frame(10.0), 10.0f, 0.5f);
}

TEST(Heuristic, BrokenTimesTeachNothing) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  HeuristicStage stage;
  for (const double ms : {0.0, -1.0, double(NAN), double(INFINITY)}) {
    Selection s = run(stage, scene, {100});
    learn(stage, scene, s, {100}, ms);
    EXPECT_FALSE(stage.calibrated());
  }
}

}  // namespace
}  // namespace kestrel
