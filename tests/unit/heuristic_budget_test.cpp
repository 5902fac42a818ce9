// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the budget is used and kept, on simulated machines of which the true costs are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "stages/heuristic.h"
#include "unit/heuristic_fixture.h"

namespace kestrel {
namespace {

/// A view of many units on a machine of which the true cost of every ray is known.
class Simulation {
 public:
  explicit Simulation(int units, double noise, double fixed_ms = 0.0)
      : noise_(noise), fixed_ms_(fixed_ms) {
    scene = make_scene(2);
    for (int i = 0; i < units; ++i) {
      const vec3 at(uniform(-2, 2), uniform(-1, 1), -uniform(2, 20));
      add_unit(scene, "unit " + std::to_string(i), at, i % 4 == 0, i % 7 == 0);
      areas.push_back(static_cast<int>(std::exp(uniform(3, 7))));
      true_cost_.push_back(uniform(0.3, 3.0));
    }
  }

  /// Milliseconds of tracing everything, without noise.
  double full_ms() {
    Scene all = scene;
    all.settings.selection = SelectionPolicy::all;
    HeuristicStage other;
    GBuffer gbuffer = make_gbuffer(areas, kPictureWidth, kPictureHeight);
    Selection s = run(other, {all, kPictureWidth, kPictureHeight}, gbuffer);
    TraceCounts effects;
    return trace(s, 1.0, effects, 0.0);
  }

  struct Frame {
    double predicted_ms, actual_ms;
    Flags selected;
  };

  /// As the renderer does it: a probe while costs are unknown, then the frame.
  Frame frame() {
    GBuffer gbuffer = make_gbuffer(areas, kPictureWidth, kPictureHeight);
    const FrameInputs inputs{scene, kPictureWidth, kPictureHeight, vec2(0.0f),
                             scene.settings.budget_ms};
    Selection s = run(stage, inputs, gbuffer);
    TraceCounts effects;
    if (inputs.budget_ms > 0.0f && !stage.calibrated()) {
      ++probes;
      const double probe_ms = trace(s, 1.0 / 256.0, effects, noise_);
      stage.learn(inputs, s, effects, probe_ms, 1.0 / 256.0);
      s = run(stage, inputs, gbuffer);
    }
    const double ms = trace(s, 1.0, effects, noise_);
    const double predicted = total_cost(s);
    stage.learn(inputs, s, effects, ms);
    return {predicted, ms, kestrel::selected(s)};
  }

  /// The view changes a little: every unit grows or shrinks.
  void drift(double amount) {
    for (int& area : areas) {
      area = std::clamp(static_cast<int>(area * (1.0 + uniform(-amount, amount))), 20, 1100);
    }
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  Scene scene;
  std::vector<int> areas;
  HeuristicStage stage;
  double ms_per_ray = 2e-4;
  int probes = 0;

 private:
  static constexpr int kPictureWidth = 512;
  static constexpr int kPictureHeight = 256;

  double trace(const Selection& s, double coverage, TraceCounts& effects, double noise) {
    effects.rays_by_unit.clear();
    double rays = 0.0;
    for (size_t i = 0; i < s.units.size(); ++i) {
      const UnitSelection& u = s.units[i];
      const double r = u.effects ? u.area * u.rays * true_cost_[i] * coverage : 0.0;
      effects.rays_by_unit.push_back(static_cast<uint64_t>(std::lround(r)));
      rays += r;
    }
    return (fixed_ms_ + rays * ms_per_ray) *
           std::exp(std::normal_distribution<>(0.0, noise)(random_));
  }

  std::vector<double> true_cost_;
  double noise_;  // standard deviation of the logarithm
  double fixed_ms_;
  std::mt19937 random_{11};
};

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * (values.size() - 1))];
}

TEST(Budget, PredictionMeetsTheTrueTime) {
  Simulation sim(200, 0.0);
  sim.scene.settings.budget_ms = static_cast<float>(0.5 * sim.full_ms());
  for (int i = 0; i < 10; ++i) sim.frame();
  for (int i = 0; i < 20; ++i) {
    const Simulation::Frame f = sim.frame();
    EXPECT_NEAR(f.predicted_ms / f.actual_ms, 1.0, 0.04);
    EXPECT_LE(f.actual_ms, 1.05 * sim.scene.settings.budget_ms);
    EXPECT_GE(f.actual_ms, 0.9 * sim.scene.settings.budget_ms);
  }
}

TEST(Budget, IsUsedAndKeptOnANoisyMachineInAMovingView) {
  for (const double noise : {0.0, 0.02, 0.05, 0.1}) {
    for (const double share : {0.25, 0.5, 0.75}) {
      Simulation sim(300, noise, 1.0);
      sim.scene.settings.budget_ms = static_cast<float>(share * sim.full_ms());
      std::vector<double> used;
      for (int i = 0; i < 400; ++i) {
        sim.drift(0.02);
        const double ms = sim.frame().actual_ms;
        if (i >= 20) used.push_back(ms / sim.scene.settings.budget_ms);
      }
      const double p95 = percentile(used, 0.95);
      EXPECT_GE(p95, 0.9) << "noise " << noise << ", budget " << share;
      EXPECT_LE(p95, 1.05) << "noise " << noise << ", budget " << share;
      EXPECT_GE(percentile(used, 0.5), 0.8) << "noise " << noise << ", budget " << share;
    }
  }
}

TEST(Budget, FollowsAMachineThatBecomesSlower) {
  Simulation sim(200, 0.02);
  sim.scene.settings.budget_ms = static_cast<float>(0.5 * sim.full_ms());
  for (int i = 0; i < 30; ++i) sim.frame();
  sim.ms_per_ray *= 3.0;
  for (int i = 0; i < 15; ++i) sim.frame();
  EXPECT_NEAR(sim.frame().actual_ms / sim.scene.settings.budget_ms, 0.95, 0.12);
  sim.ms_per_ray /= 3.0;
  for (int i = 0; i < 15; ++i) sim.frame();
  EXPECT_NEAR(sim.frame().actual_ms / sim.scene.settings.budget_ms, 0.95, 0.12);
}

TEST(Budget, NoiseAloneChangesLittleInAViewThatStandsStill) {
  Simulation sim(200, 0.02);
  sim.scene.settings.budget_ms = static_cast<float>(0.5 * sim.full_ms());
  for (int i = 0; i < 60; ++i) sim.frame();
  Flags before = sim.frame().selected;
  int changes = 0;
  for (int i = 0; i < 100; ++i) {
    const Flags now = sim.frame().selected;
    for (size_t u = 0; u < now.size(); ++u) changes += now[u] != before[u];
    before = now;
  }
  EXPECT_LE(changes, 40) << "of 200 units in 100 frames";
}

TEST(Budget, AnEmptyCornerDoesNotMakeRaysLookDear) {
  Simulation sim(200, 0.02, 2.0);
  sim.scene.settings.budget_ms = static_cast<float>(0.5 * sim.full_ms());
  for (int i = 0; i < 30; ++i) sim.frame();
  const std::vector<int> view = sim.areas;
  std::fill(sim.areas.begin() + 1, sim.areas.end(), 0);
  sim.areas[0] = 100;
  for (int i = 0; i < 200; ++i) sim.frame();  // of 2 ms each, nearly all of them fixed
  sim.areas = view;
  EXPECT_GE(sim.frame().actual_ms, 0.8 * sim.scene.settings.budget_ms);
}

TEST(Budget, CostsAreProbedAgainWhenNothingFitsForLong) {
  Simulation sim(50, 0.0);
  sim.ms_per_ray *= 1000.0;  // measured in a bad moment
  const double full_ms = sim.full_ms();
  sim.scene.settings.budget_ms = static_cast<float>(full_ms / 1e5);
  sim.frame();
  sim.ms_per_ray /= 1000.0;
  for (int i = 0; i < 200; ++i) sim.frame();
  EXPECT_GE(sim.frame().actual_ms, 0.5 * sim.scene.settings.budget_ms);
  EXPECT_EQ(sim.probes, 2);
}

TEST(Budget, WhatNeverFitsStaysUnselected) {
  Simulation sim(1, 0.0);
  sim.scene.settings.budget_ms = static_cast<float>(0.5 * sim.full_ms());
  for (int i = 0; i < 300; ++i) EXPECT_EQ(sim.frame().selected, Flags{0});
  EXPECT_LE(sim.probes, 10) << "probing goes on, but seldom";
}

}  // namespace
}  // namespace kestrel
