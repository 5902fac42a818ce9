// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/trace.h"

#include <algorithm>

#include "base/error.h"
#include "frame/region_loops.h"

namespace kestrel {
namespace {

/// "Nothing traced".
void reset(EffectBuffers& effects, const Region& region, bool has_alpha) {
  for (auto* plane : {&effects.shadow, &effects.reflection, &effects.refraction}) {
    plane->resize(region.pixels());
  }
  effects.clear.resize(has_alpha ? region.pixels() : 0);
  const size_t width = static_cast<size_t>(region.width);
  for_rows(region, [&](int y) {
    const auto fill_row = [&](auto& plane, const auto& value) {
      std::fill_n(plane.begin() + static_cast<ptrdiff_t>(y * width), width, value);
    };
    fill_row(effects.shadow, vec3(1.0f));
    fill_row(effects.reflection, vec3(0.0f));
    fill_row(effects.refraction, vec3(0.0f));
    if (has_alpha) fill_row(effects.clear, 0.0f);
  });
}

}  // namespace

void TraceStage::run(const TraceRequest& request, EffectBuffers& effects, TraceCounts& counts) {
  reset(effects, request.inputs.region, request.inputs.scene.has_alpha());
  const auto& units = request.selection.units;
  const bool anything =
      std::any_of(units.begin(), units.end(), [](const auto& unit) { return unit.effects != 0; });
  if (anything) tracer_.trace(request, effects, counts);
  if (request.cancelled && request.cancelled()) {
    fail(ErrorCode::cancelled, "The render was cancelled.");
  }
}

}  // namespace kestrel
