// SPDX-License-Identifier: GPL-3.0-or-later
// How long a ray takes on this machine, learned from frame to frame. It turns the paper's cost
// C = A Q E, a number of rays (equation 2), into milliseconds, the unit of the budget T.
#pragma once

namespace kestrel {

/// What one traced frame, or a probe, tells of the cost of rays.
struct TraceMeasurement {
  double ms = 0.0;            // stage 3's wall time
  double rays = 0.0;          // Σ A Q E of what was traced, with what is now known of E
  double predicted_ms = 0.0;  // what was expected before; 0: nothing was
  double budget_ms = 0.0;     // T; 0: no limit
};

class RayCost {
 public:
  /// Without a positive, finite time and number of rays nothing is learned.
  void observe(const TraceMeasurement& measurement);

  /// The smoothed time of a ray, in milliseconds; 0 before the first measurement. The stage's fixed
  /// time is part of it: its share is learned where the budget makes the stage work.
  double ms_per_ray() const { return ms_per_ray_; }

  /// By how much 95 of 100 frames stay below, as a factor on the predicted time: 1 … 1.5. Spending
  /// budget / headroom() keeps that many frames within the budget, however noisy the machine.
  double headroom() const { return headroom_; }

  bool known() const { return ms_per_ray_ > 0.0; }
  void forget() { *this = RayCost(); }

 private:
  void follow(double measured_ms_per_ray);
  void widen(double actual_to_predicted);
  void publish();

  // Both values follow every frame; those in use stay until the two have moved apart, so that noise
  // alone does not push objects in and out of the budget in a view that stands still.
  double ms_per_ray_ = 0.0;
  double headroom_ = 1.0;
  double latest_ms_per_ray_ = 0.0;
  double latest_headroom_ = 1.0;
  int measurements_ = 0;
};

}  // namespace kestrel
