// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 3: shadows, reflections and refractions of the selected units (paper, section 3.3).
#pragma once

#include "tracers/tracer.h"

namespace kestrel {

class TraceStage {
 public:
  /// `tracer` must outlive the stage.
  explicit TraceStage(Tracer& tracer) : tracer_(tracer) {}

  /// Resets `effects` to "nothing traced", lets the tracer fill it, and adds to `counts`. Throws
  /// Error(cancelled).
  void run(const TraceRequest& request, EffectBuffers& effects, TraceCounts& counts);

 private:
  Tracer& tracer_;
};

}  // namespace kestrel
