// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/trace.h"

#include "base/error.h"

namespace kestrel {

void TraceStage::run(const TraceRequest& request, EffectBuffers& effects) {
  const size_t n = request.inputs.pixels();
  effects.shadow.assign(n, vec3(1.0f));
  effects.reflection.assign(n, vec3(0.0f));
  effects.refraction.assign(n, vec3(0.0f));
  effects.rays = {};
  effects.trace_calls_ms = 0.0;
  effects.rays_by_unit.assign(request.inputs.scene.units.size(), 0);

  bool anything = false;
  for (const UnitSelection& unit : request.selection.units) anything |= unit.effects != 0;
  if (anything) tracer_.trace(request, effects);
  if (request.cancelled && request.cancelled()) {
    fail(ErrorCode::cancelled, "The render was cancelled.");
  }
}

}  // namespace kestrel
