// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 2: which units are ray traced this frame (paper, section 3.2, equations 1 to 3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frame/frame.h"
#include "stages/ray_cost.h"
#include "stages/selection_graph.h"

namespace kestrel {

/// Visible pixels by G-buffer object id, nothing (0) included.
using Areas = std::vector<uint64_t>;

/// Adds a histogram of the region's object ids. The same whatever the number of threads.
void count_areas(const FrameInputs& inputs, const GBuffer& gbuffer, Areas& areas);

/// 1 on the pixels of units of which some effect is traced, 0 elsewhere.
void write_heuristic_mask(const FrameInputs& inputs, const Selection& selection, GBuffer& gbuffer);

class HeuristicStage {
 public:
  /// Chooses units by their visible pixels (A). `Settings::selection` may bypass the graph (all,
  /// none); EffectMode overrides are honoured: `always` effects are traced whatever the budget and
  /// their cost is taken off it first, `never` ones are neither traced nor counted in Q.
  /// `selected` says whether the effects that a unit leaves to the heuristic are traced; of a unit
  /// that leaves it none, whether there are any.
  /// A budget needs costs: while they are unknown, all visible units are selected, for the probe
  /// to measure.
  Selection select(const FrameInputs& inputs, const Areas& areas);

  /// Makes a frame's selection the next one's S. Once a frame.
  void remember(const Selection& selection);

  /// Learns from a traced frame: milliseconds per ray (T is in milliseconds) and, where a unit's
  /// cost setting is 0, its own E from the rays it really needed; afterwards Σ C over what was
  /// traced is its time, smoothed. Fills `ms` and `traced_rays` of each unit. `selection` is that
  /// of the last select(); `trace_ms` is stage 3's wall time; `coverage` is how often it traced
  /// each selected pixel: the number of samples, or the share of pixels that a probe took.
  void learn(const FrameInputs& inputs, Selection& selection, const TraceCounts& counts,
             double trace_ms, double coverage = 1.0);

  /// Whether costs are known; while they are not, a probe should come first. They are given up as
  /// out of date after a second or so in which nothing fitted the budget and so nothing was
  /// learned.
  bool calibrated() const { return ray_cost_.known(); }

  /// Forgets what was selected and learned (another scene).
  void reset() { *this = HeuristicStage(); }

 private:
  /// What outlives a frame, by unit.
  struct UnitMemory {
    std::string name;           // matches units of one frame with those of the next
    bool was_selected = false;  // S
    float cost = 0.0f;          // E as learned, 0 = not yet known
  };

  void match_units(const std::vector<Unit>& units);
  void estimate(const FrameInputs& inputs, Selection& selection) const;
  void choose(const FrameInputs& inputs, Selection& selection) const;
  double learn_unit_costs(const Scene& scene, const Selection& selection, double coverage);

  RayCost ray_cost_;
  std::vector<UnitMemory> memory_;  // parallel to the scene's units
  int starved_frames_ = 0;          // frames in a row in which nothing fitted
};

}  // namespace kestrel
