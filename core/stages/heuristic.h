// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 2: which units are ray traced this frame (paper, section 3.2, equations 1 to 3).
#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"

namespace kestrel {

/// A node of the selection graph: what one unit costs and how relevant it is.
struct SelectionNode {
  double cost = 0.0;       // C, same unit as the budget
  double relevance = 0.0;  // R
};

/// The greedy walk over the graph of section 3.2: repeatedly take the costliest node left; drop it
/// if it does not fit what is left of the budget; else select the most relevant node among it and
/// those of smaller or equal cost. Ties: lower index first (cost: listed first). Returns one flag a
/// node. O(n log n).
std::vector<bool> select_nodes(const std::vector<SelectionNode>& nodes, double budget);

class HeuristicStage {
 public:
  /// Chooses units from what the G-buffer shows, and writes its heuristic mask.
  /// `Settings::selection` may bypass the graph (all, none); EffectMode overrides are honoured:
  /// `always` effects are traced whatever the budget and their cost is taken off it first, `never`
  /// ones are neither traced nor counted in Q.
  Selection run(const FrameInputs& inputs, GBuffer& gbuffer);

  /// Learns from a traced frame: milliseconds per ray (T is in milliseconds) and, where a unit's
  /// cost setting is 0, its own E from the rays it really needed. `trace_ms` is stage 3's wall
  /// time, or a probe's, and `coverage` the share of the selected pixels it traced (0…1].
  void learn(const FrameInputs& inputs, Selection& selection, const EffectBuffers& effects,
             double trace_ms, double coverage = 1.0);

  /// Whether costs were measured at least once; before that, a probe should come first.
  bool calibrated() const { return ms_per_ray_ > 0.0; }

  /// Forgets what was selected and learned (another scene).
  void reset();

 private:
  double ms_per_ray_ = 0.0;
  std::vector<bool> was_selected_;    // by unit: S
  std::vector<float> learned_cost_;   // by unit: E, 0 = not yet known
  std::vector<std::string> names_;    // units of the last frame, to match S and E by name
};

}  // namespace kestrel
