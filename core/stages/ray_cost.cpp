// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ray_cost.h"

#include <algorithm>
#include <cmath>

namespace kestrel {
namespace {

constexpr double kSmoothing = 0.3;    // weight of a new measurement once some are known
constexpr double kLargestJump = 2.0;  // a measurement further off than this factor is an outlier
constexpr double kHold = 0.03;        // relative change below which the values in use stay

// A frame that used less than this share of its budget mostly shows the stage's fixed time, which
// makes rays look dear. It counts only where they turn out cheaper than this share of the estimate.
constexpr double kIdleShareOfBudget = 0.25;
constexpr double kGrosslyCheaper = 0.5;

constexpr double kQuantile = 0.95;  // share of frames that shall stay within the budget
constexpr double kQuantileStep = 0.02;
constexpr double kMaxHeadroom = 1.5;

bool usable(double value) {
  return std::isfinite(value) && value > 0.0;
}

}  // namespace

void RayCost::observe(const TraceMeasurement& m) {
  if (!usable(m.ms) || !usable(m.rays)) return;
  const double measured = m.ms / m.rays;
  const bool idle = m.budget_ms > 0.0 && m.ms < kIdleShareOfBudget * m.budget_ms;
  if (known() && idle && measured > kGrosslyCheaper * latest_ms_per_ray_) return;
  follow(measured);
  if (usable(m.predicted_ms)) widen(m.ms / m.predicted_ms);
  publish();
}

void RayCost::follow(double measured) {
  // The mean of the first few, then an exponential moving average.
  const double weight = std::max(kSmoothing, 1.0 / ++measurements_);
  if (latest_ms_per_ray_ > 0.0) {
    measured =
        std::clamp(measured, latest_ms_per_ray_ / kLargestJump, latest_ms_per_ray_ * kLargestJump);
  }
  latest_ms_per_ray_ += weight * (measured - latest_ms_per_ray_);
}

void RayCost::widen(double actual_to_predicted) {
  // Stochastic approximation of a quantile: at rest, steps up and down balance. Only the side on
  // which a frame falls counts, so one that stalled moves it no further than one just too slow.
  latest_headroom_ += kQuantileStep * (kQuantile - (actual_to_predicted <= latest_headroom_));
  latest_headroom_ = std::clamp(latest_headroom_, 1.0, kMaxHeadroom);
}

void RayCost::publish() {
  const double change = latest_ms_per_ray_ * latest_headroom_ / (ms_per_ray_ * headroom_);
  if (known() && std::abs(change - 1.0) < kHold) return;
  ms_per_ray_ = latest_ms_per_ray_;
  headroom_ = latest_headroom_;
}

}  // namespace kestrel
