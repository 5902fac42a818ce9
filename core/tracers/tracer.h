// SPDX-License-Identifier: GPL-3.0-or-later
// The seam of stage 3: whoever can trace the effects of selected units.
#pragma once

#include <functional>

#include "frame/frame.h"

namespace kestrel {

struct TraceRequest {
  const FrameInputs& inputs;
  const GBuffer& gbuffer;
  const Selection& selection;
  int pixel_stride = 1;                 // only every n-th pixel in x and y: a probe of the cost
  std::function<bool()> cancelled;      // asked now and then; true leaves the rest untraced
  std::function<void(float)> progress;  // share of the region done, from any thread
};

class Tracer {
 public:
  virtual ~Tracer() = default;

  /// Fills `effects`, whose planes have the region's size, where the selection asks for it, and
  /// adds to `counts`. Different regions may be traced at the same time.
  virtual void trace(const TraceRequest& request, EffectBuffers& effects, TraceCounts& counts) = 0;
};

}  // namespace kestrel
