// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 2 against numbers worked out by hand: the factors of Table 3, and who is selected.
#include "stages/heuristic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "unit/heuristic_fixture.h"

namespace kestrel {
namespace {

// ---- Equations -------------------------------------------------------------------------------

TEST(Heuristic, EquationsOneToThreeByHand) {
  Scene scene = make_scene(2);
  add_unit(scene, "vase", vec3(0, 0, -5), true);
  scene.units[0].settings.relevance = 3.0f;
  scene.units[0].settings.cost = 1.5f;
  scene.settings.selection_inertia = 100.0f;
  HeuristicStage stage;
  Selection s = run(stage, scene, {200});
  const UnitSelection& first = s.units[0];
  EXPECT_EQ(first.area, 200u);
  EXPECT_FLOAT_EQ(first.centrality, 1.0f);
  EXPECT_FLOAT_EQ(first.distance, 5.0f);
  EXPECT_FLOAT_EQ(first.visibility, 40.0f);  // 200 · 1 / 5
  EXPECT_FLOAT_EQ(first.rays, 5.0f);         // 2 + 1 + 2
  EXPECT_FLOAT_EQ(first.relevance, 120.0f);  // (0 · 100 + 40) · 3
  EXPECT_FLOAT_EQ(first.estimated_cost, 1.5f);
  EXPECT_EQ(first.cost, 0.0f) << "milliseconds are not known yet";
  EXPECT_TRUE(first.selected);
  EXPECT_FALSE(first.was_selected);
  EXPECT_EQ(first.effects, kShadows | kReflections);

  learn(stage, scene, s, {1000}, 30.0);  // 200 · 5 · 1.5 = 1500 rays in the paper's measure
  s = run(stage, scene, {100});
  EXPECT_FLOAT_EQ(s.units[0].cost, 100 * 5 * 1.5f * 30.0f / 1500.0f);
  EXPECT_TRUE(s.units[0].was_selected);
  EXPECT_FLOAT_EQ(s.units[0].relevance, (100.0f + 20.0f) * 3.0f);
}

TEST(Heuristic, CentralityFallsFromTheMiddleToTheEdge) {
  Scene scene = make_scene();
  const auto centrality = [&](const vec3& at) {
    scene.units.clear();
    scene.objects.clear();
    add_unit(scene, "it", at);
    return run_once(scene, {10}).units[0].centrality;
  };
  EXPECT_FLOAT_EQ(centrality({0, 0, -7}), 1.0f);
  EXPECT_FLOAT_EQ(centrality({2, 0, -2}), 0.505f);           // half way to the right edge
  EXPECT_FLOAT_EQ(centrality({0, -1, -2}), 0.505f);          // half way to the lower edge
  EXPECT_NEAR(centrality({1.2f, 0.8f, -2}), 0.505f, 1e-6f);  // NDC (0.3, 0.4)
  EXPECT_FLOAT_EQ(centrality({4, 0, -2}), 0.01f);            // on the edge
  EXPECT_FLOAT_EQ(centrality({3.9f, 1.9f, -2}), 0.01f);      // in a corner
  EXPECT_FLOAT_EQ(centrality({9, 0, -2}), 0.01f);            // outside
  EXPECT_FLOAT_EQ(centrality({0, 0, 5}), 0.01f);             // behind
  EXPECT_FLOAT_EQ(centrality({0, 0, 0}), 0.01f);             // in the camera
}

TEST(Heuristic, CentralityInAWindowOffTheAxis) {
  Scene scene = make_scene();
  scene.camera.left = 0.0f;  // shifted lens: the middle of the picture looks along (1, 0, -1)
  add_unit(scene, "it", {3, 0, -3});
  EXPECT_FLOAT_EQ(run_once(scene, {10}).units[0].centrality, 1.0f);
}

TEST(Heuristic, CentralityInAnOrthographicView) {
  Scene scene = make_scene();
  scene.camera.projection = Projection::orthographic;
  add_unit(scene, "near", {1, 0, -2});
  add_unit(scene, "far", {1, 0, -200});
  add_unit(scene, "behind", {0, 0, 3});
  Selection s = run_once(scene, {10, 10, 10});
  EXPECT_FLOAT_EQ(s.units[0].centrality, 0.505f) << "1 of 2 metres to the edge";
  EXPECT_FLOAT_EQ(s.units[1].centrality, 0.505f) << "depth does not matter";
  EXPECT_FLOAT_EQ(s.units[2].centrality, 0.01f);
  scene.camera.near_clip = -10.0f;  // as in an editor's orthographic viewport
  EXPECT_FLOAT_EQ(run_once(scene, {10, 10, 10}).units[2].centrality, 1.0f);
}

TEST(Heuristic, CameraPositionAndRotationCount) {
  Scene scene = make_scene();
  // At (10, 20, 30), looking along +X with Z up.
  scene.camera.world_from_camera =
      mat4x3(vec3(0, -1, 0), vec3(0, 0, 1), vec3(-1, 0, 0), vec3(10, 20, 30));
  add_unit(scene, "ahead", {14, 20, 30});
  add_unit(scene, "left", {12, 22, 30});  // camera (-2, 0, -2): NDC x = -0.5
  add_unit(scene, "behind", {6, 20, 30});
  const Selection s = run_once(scene, {10, 10, 10});
  EXPECT_FLOAT_EQ(s.units[0].centrality, 1.0f);
  EXPECT_FLOAT_EQ(s.units[0].distance, 4.0f);
  EXPECT_FLOAT_EQ(s.units[1].centrality, 0.505f);
  EXPECT_NEAR(s.units[1].distance, std::sqrt(8.0f), 1e-5f);
  EXPECT_FLOAT_EQ(s.units[2].centrality, 0.01f);
}

TEST(Heuristic, DistanceStaysAboveZero) {
  Scene scene = make_scene();
  add_unit(scene, "around the camera", {0, 0, 0});
  const UnitSelection u = run_once(scene, {10}).units[0];
  EXPECT_GT(u.distance, 0.0f);
  EXPECT_TRUE(std::isfinite(u.visibility));
  EXPECT_TRUE(std::isfinite(u.relevance));
}

TEST(Heuristic, AreaIsThePixelsOfAllObjectsOfAUnit) {
  Scene scene = make_scene();
  add_unit(scene, "tree", {0, 0, -5});
  add_unit(scene, "leaves", {0, 0, -5});
  add_unit(scene, "house", {0, 0, -5});
  scene.objects[1].unit = 0;  // instances of one instancer
  const Selection s = run_once(scene, {100, 1500, 7});
  EXPECT_EQ(s.units[0].area, 1600u);
  EXPECT_EQ(s.units[1].area, 0u);
  EXPECT_EQ(s.units[2].area, 7u);
}

TEST(Heuristic, AreasOfALargePictureAreCountedExactly) {
  Scene scene = make_scene();
  std::mt19937 random(7);
  std::vector<uint64_t> expected(500, 0);
  for (int i = 0; i < 500; ++i) add_unit(scene, "unit " + std::to_string(i), {0, 0, -5});
  GBuffer gbuffer = make_gbuffer({}, 1283, 721);
  for (uint32_t& id : gbuffer.object) {
    id = random() % 501;
    if (id > 0) ++expected[id - 1];
  }
  HeuristicStage stage;
  const Selection s = run(stage, {scene, 1283, 721}, gbuffer);
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(s.units[i].area, expected[i]);
}

// ---- Q and effects ---------------------------------------------------------------------------

struct RaysCase {
  int lights;
  bool reflective, refractive;
  EffectMode shadows, reflections, refractions;
  float rays;
  int effects;
};

TEST(Heuristic, RaysPerPixelForEveryKindOfUnit) {
  constexpr auto kAuto = EffectMode::automatic;
  constexpr auto kAlways = EffectMode::always;
  constexpr auto kNever = EffectMode::never;
  const RaysCase cases[] = {
      {0, false, false, kAuto, kAuto, kAuto, 0, 0},
      {1, false, false, kAuto, kAuto, kAuto, 1, kShadows},
      {3, false, false, kAuto, kAuto, kAuto, 3, kShadows},
      {0, true, false, kAuto, kAuto, kAuto, 1, kReflections},
      {0, false, true, kAuto, kAuto, kAuto, 4, kRefractions},
      {3, true, false, kAuto, kAuto, kAuto, 7, kShadows | kReflections},
      {3, false, true, kAuto, kAuto, kAuto, 10, kShadows | kRefractions},
      {3, true, true, kAuto, kAuto, kAuto, 14, kShadows | kReflections | kRefractions},
      {3, true, true, kNever, kAuto, kAuto, 11, kReflections | kRefractions},
      {3, true, true, kAuto, kNever, kAuto, 10, kShadows | kRefractions},
      {3, true, true, kAuto, kAuto, kNever, 7, kShadows | kReflections},
      {3, true, true, kNever, kNever, kNever, 0, 0},
      {3, true, true, kAlways, kAuto, kNever, 7, kShadows | kReflections},
      {3, true, true, kAlways, kAlways, kAlways, 14, kShadows | kReflections | kRefractions},
      {0, false, false, kAlways, kAlways, kAlways, 0, 0},  // a mode cannot add what is not there
  };
  for (const RaysCase& c : cases) {
    Scene scene = make_scene(0);
    add_lights(scene, c.lights, 2);  // two that cast no shadow, so that no ray goes to them
    add_unit(scene, "it", {0, 0, -5}, c.reflective, c.refractive);
    scene.units[0].settings.shadows = c.shadows;
    scene.units[0].settings.reflections = c.reflections;
    scene.units[0].settings.refractions = c.refractions;
    const UnitSelection u = run_once(scene, {10}).units[0];
    const auto index = &c - cases;
    EXPECT_EQ(u.rays, c.rays) << "case " << index;
    EXPECT_EQ(u.effects, c.effects) << "case " << index;
    EXPECT_EQ(u.selected, c.effects != 0) << "case " << index;
  }
}

// ---- Selection -------------------------------------------------------------------------------

TEST(Heuristic, WithoutABudgetEverythingVisibleIsSelected) {
  Scene scene = make_scene();
  for (int i = 0; i < 4; ++i) add_unit(scene, std::string(1, 'a' + i), {0, 0, -5});
  HeuristicStage stage;
  calibrate(stage, scene, {10, 20, 30, 0}, 1e6);
  EXPECT_EQ(selected(run(stage, scene, {10, 20, 30, 0})), (Flags{1, 1, 1, 0}));
}

TEST(Heuristic, TheBudgetGoesToTheMostRelevantThatFit) {
  // One ray a pixel and 1 ms a ray: C = A ms. All as central and as far: R = A K / 5.
  Scene scene = make_scene();
  for (int i = 0; i < 4; ++i) add_unit(scene, std::string(1, 'a' + i), {0, 0, -5});
  scene.units[2].settings.relevance = 100.0f;
  HeuristicStage stage;
  calibrate(stage, scene, {500, 300, 100, 80}, 1.0);
  run(stage, scene, {0, 0, 0, 0});  // nothing was selected
  scene.settings.budget_ms = 390.0f;
  // 500 does not fit. 300 does, but 100 is more relevant: 290 left. 300 does not fit; 80 does.
  EXPECT_EQ(selected(run(stage, scene, {500, 300, 100, 80})), (Flags{0, 0, 1, 1}));
  scene.units[2].settings.relevance = 1.0f;
  run(stage, scene, {0, 0, 0, 0});  // nothing was selected
  // 300 is the most relevant that fits: 90 left. 100 does not fit; 80 does.
  EXPECT_EQ(selected(run(stage, scene, {500, 300, 100, 80})), (Flags{0, 1, 0, 1}));
}

TEST(Heuristic, TheBudgetIsTheSamplesShareOfTheFrames) {
  Scene scene = make_scene();
  add_unit(scene, "it", {0, 0, -5});
  HeuristicStage stage;
  calibrate(stage, scene, {100}, 1.0);
  scene.settings.budget_ms = 120.0f;
  GBuffer gbuffer = make_gbuffer({100});
  EXPECT_TRUE(run(stage, {scene, kWidth, kHeight, vec2(0), 120.0f}, gbuffer).units[0].selected);
  EXPECT_FALSE(run(stage, {scene, kWidth, kHeight, vec2(0), 60.0f}, gbuffer).units[0].selected);
}

TEST(Heuristic, InertiaKeepsWhatWasSelected) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  add_unit(scene, "b", {0, 0, -5});
  HeuristicStage stage;
  calibrate(stage, scene, {100, 100}, 1.0);
  run(stage, scene, {0, 0});  // both unselected
  scene.settings.budget_ms = 130.0f;
  for (const float inertia : {0.0f, 1000.0f}) {
    scene.settings.selection_inertia = inertia;
    EXPECT_EQ(selected(run(stage, scene, {120, 100})), (Flags{1, 0}));
    // b now shows more, and wins unless a is held.
    EXPECT_EQ(selected(run(stage, scene, {100, 120})), inertia > 0 ? (Flags{1, 0}) : (Flags{0, 1}));
    run(stage, scene, {0, 0});
  }
}

TEST(Heuristic, WhatIsOutOfSightIsForgottenAsSelected) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  HeuristicStage stage;
  EXPECT_TRUE(run(stage, scene, {10}).units[0].selected);
  const UnitSelection hidden = run(stage, scene, {0}).units[0];
  EXPECT_TRUE(hidden.was_selected);
  EXPECT_FALSE(hidden.selected);
  EXPECT_EQ(hidden.effects, 0);
  EXPECT_EQ(hidden.visibility, 0.0f);
  EXPECT_EQ(hidden.cost, 0.0f);
  EXPECT_FALSE(run(stage, scene, {10}).units[0].was_selected);
}

TEST(Heuristic, RelevanceSettingDecidesBetweenAlikeUnits) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  add_unit(scene, "b", {0, 0, -5});
  scene.units[1].settings.relevance = 1.1f;
  HeuristicStage stage;
  calibrate(stage, scene, {100, 100}, 1.0);
  scene.settings.budget_ms = 150.0f;
  EXPECT_EQ(selected(run(stage, scene, {100, 100})), (Flags{0, 1}));
}

TEST(Heuristic, CentralAndNearUnitsComeFirst) {
  Scene scene = make_scene();
  add_unit(scene, "aside", {3, 0, -2});
  add_unit(scene, "central", {0, 0, -3});
  add_unit(scene, "far", {0, 0, -9});
  HeuristicStage stage;
  calibrate(stage, scene, {100, 100, 100}, 1.0);
  scene.settings.budget_ms = 150.0f;
  EXPECT_EQ(selected(run(stage, scene, {100, 100, 100})), (Flags{0, 1, 0}));
}

TEST(Heuristic, PoliciesAllAndNoneBypassTheGraph) {
  Scene scene = make_scene();
  add_unit(scene, "plain", {0, 0, -5});
  add_unit(scene, "mirror", {0, 0, -5}, true);
  add_unit(scene, "hidden", {0, 0, -5});
  scene.units[1].settings.reflections = EffectMode::always;
  HeuristicStage stage;
  calibrate(stage, scene, {100, 100, 0}, 1.0);
  scene.settings.budget_ms = 1.0f;
  scene.settings.selection = SelectionPolicy::all;
  EXPECT_EQ(selected(run(stage, scene, {100, 100, 0})), (Flags{1, 1, 0}));
  scene.settings.selection = SelectionPolicy::none;
  const Selection none = run(stage, scene, {100, 100, 0});
  EXPECT_EQ(selected(none), (Flags{0, 0, 0}));
  EXPECT_EQ(none.units[0].effects, 0);
  EXPECT_EQ(none.units[1].effects, kReflections) << "`always` holds whatever is selected";
}

TEST(Heuristic, AlwaysEffectsAreTracedFirstAndPaidFromTheBudget) {
  // 1 ms a ray, one light. The mirror's reflection: 100 pixels · (1 + 1) = 200 ms.
  Scene scene = make_scene();
  add_unit(scene, "mirror", {0, 0, -5}, true);
  add_unit(scene, "wall", {0, 0, -5});
  scene.units[0].settings.reflections = EffectMode::always;
  HeuristicStage stage;
  calibrate(stage, scene, {100, 250}, 1.0);
  scene.settings.budget_ms = 10.0f;
  Selection s = run(stage, scene, {100, 250});
  EXPECT_EQ(s.units[0].effects, kReflections) << "beyond the budget, yet traced";
  EXPECT_FALSE(s.units[0].selected) << "its shadows were left to the heuristic";
  EXPECT_FALSE(s.units[1].selected);
  scene.settings.budget_ms = 320.0f;  // 120 after the mirror: its shadows (100), not the wall
  s = run(stage, scene, {100, 250});
  EXPECT_EQ(s.units[0].effects, kReflections | kShadows);
  EXPECT_TRUE(s.units[0].selected);
  EXPECT_FALSE(s.units[1].selected);
  EXPECT_FLOAT_EQ(s.units[0].cost, 300.0f);
  scene.units[0].settings.reflections = EffectMode::automatic;
  // Without the override the wall may have it: 250 of 320 ms.
  run(stage, scene, {0, 0});
  EXPECT_EQ(selected(run(stage, scene, {100, 250})), (Flags{0, 1}));
}

TEST(Heuristic, TheMaskShowsThePixelsOfWhatIsTraced) {
  Scene scene = make_scene();
  add_unit(scene, "chosen", {0, 0, -5});
  add_unit(scene, "too dear", {0, 0, -5});
  add_unit(scene, "always", {0, 0, -5}, true);
  scene.units[2].settings.reflections = EffectMode::always;
  HeuristicStage stage;
  calibrate(stage, scene, {100, 900, 50}, 1.0);
  scene.settings.budget_ms = 210.0f;
  GBuffer gbuffer = make_gbuffer({100, 900, 50});
  gbuffer.heuristic_mask.assign(gbuffer.object.size(), 0.5f);
  run(stage, {scene, kWidth, kHeight, vec2(0.0f), 210.0f}, gbuffer);
  for (size_t i = 0; i < gbuffer.object.size(); ++i) {
    const uint32_t id = gbuffer.object[i];
    ASSERT_EQ(gbuffer.heuristic_mask[i], id == 1 || id == 3 ? 1.0f : 0.0f) << "object id " << id;
  }
}

TEST(Heuristic, NothingVisibleAndEmptySceneAreFine) {
  Scene scene = make_scene();
  EXPECT_TRUE(run_once(scene, {}).units.empty());
  add_unit(scene, "a", {0, 0, -5});
  for (const float budget : {0.0f, 20.0f}) {
    scene.settings.budget_ms = budget;
    HeuristicStage stage;
    Selection s = run(stage, scene, {0});
    EXPECT_EQ(selected(s), Flags{0});
    learn(stage, scene, s, {0}, 3.0);
    EXPECT_FALSE(stage.calibrated()) << "no rays, nothing to learn";
    EXPECT_EQ(s.units[0].ms, 0.0);
  }
}

TEST(Heuristic, UnitsAreMatchedByNameWhenTheSceneChanges) {
  Scene scene = make_scene();
  for (const char* name : {"a", "b", "c"}) add_unit(scene, name, {0, 0, -5});
  HeuristicStage stage;
  Selection s = run(stage, scene, {100, 0, 100});
  learn(stage, scene, s, {50, 0, 300}, 1.0);  // E: a 0.5, c 3

  Scene changed = make_scene();
  for (const char* name : {"new", "c", "b", "a"}) add_unit(changed, name, {0, 0, -5});
  s = run(stage, changed, {10, 10, 10, 10});
  const std::vector<float> costs = {1.0f, 3.0f, 1.0f, 0.5f};
  for (size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(s.units[i].estimated_cost, costs[i]) << i;
  EXPECT_FALSE(s.units[0].was_selected);
  EXPECT_TRUE(s.units[1].was_selected);
  EXPECT_FALSE(s.units[2].was_selected);
  EXPECT_TRUE(s.units[3].was_selected);
}

TEST(Heuristic, UnitsOfOneNameDoNotShareWhatIsKnown) {
  Scene scene = make_scene();
  add_unit(scene, "twin", {0, 0, -5});
  add_unit(scene, "twin", {0, 0, -5});
  HeuristicStage stage;
  Selection s = run(stage, scene, {100, 0});
  learn(stage, scene, s, {200, 0}, 1.0);
  s = run(stage, scene, {100, 100});
  EXPECT_FLOAT_EQ(s.units[0].estimated_cost, 2.0f);
  EXPECT_FLOAT_EQ(s.units[1].estimated_cost, 1.0f);
  EXPECT_TRUE(s.units[0].was_selected);
  EXPECT_FALSE(s.units[1].was_selected);
  add_unit(scene, "other", {0, 0, -5});
  s = run(stage, scene, {100, 100, 100});
  EXPECT_FLOAT_EQ(s.units[0].estimated_cost, 2.0f);
  EXPECT_FLOAT_EQ(s.units[1].estimated_cost, 1.0f);
}

TEST(Heuristic, ResetForgets) {
  Scene scene = make_scene();
  add_unit(scene, "a", {0, 0, -5});
  HeuristicStage stage;
  calibrate(stage, scene, {100}, 1.0);
  ASSERT_TRUE(stage.calibrated());
  stage.reset();
  EXPECT_FALSE(stage.calibrated());
  EXPECT_FALSE(run(stage, scene, {100}).units[0].was_selected);
}

}  // namespace
}  // namespace kestrel
