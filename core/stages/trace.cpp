// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/trace.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/error.h"

namespace kestrel {
namespace {

/// "Nothing traced".
void reset(EffectBuffers& effects, size_t width, int height) {
  for (auto* plane : {&effects.shadow, &effects.reflection, &effects.refraction}) {
    plane->resize(width * static_cast<size_t>(height));
  }
  tbb::parallel_for(0, height, [&](int y) {
    const auto fill_row = [&](Plane<vec3>& plane, const vec3& value) {
      std::fill_n(plane.begin() + static_cast<ptrdiff_t>(y * width), width, value);
    };
    fill_row(effects.shadow, vec3(1.0f));
    fill_row(effects.reflection, vec3(0.0f));
    fill_row(effects.refraction, vec3(0.0f));
  });
}

}  // namespace

void TraceStage::run(const TraceRequest& request, EffectBuffers& effects) {
  reset(effects, static_cast<size_t>(request.inputs.width), request.inputs.rows);
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
