// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame.h"

#include <algorithm>

namespace kestrel {

void GBuffer::resize(const FrameInputs& inputs) {
  width = inputs.region.width;
  height = inputs.region.height;
  const size_t n = static_cast<size_t>(width) * static_cast<size_t>(height);
  position.resize(n);
  normal.resize(n);
  normal_geometric.resize(n);
  emission.resize(n);
  ambient.resize(n);
  diffuse.resize(n);
  specular.resize(n);
  optical.resize(n);
  heuristic_mask.resize(n);
  depth.resize(n);
  object.resize(n);
  material.resize(n);
  lighting.resize(n);
  uv.resize(inputs.keep_uv ? n : 0);
}

std::span<const SurfaceLayer> layers_behind(const GBuffer& gbuffer, size_t pixel) {
  const auto& all = gbuffer.behind;
  const auto first = std::partition_point(all.begin(), all.end(),
                                          [&](const auto& layer) { return layer.pixel < pixel; });
  const auto last =
      std::find_if(first, all.end(), [&](const auto& layer) { return layer.pixel != pixel; });
  return {first, last};
}

void TraceCounts::reset(size_t units) {
  *this = {};
  rays_by_unit.resize(units, 0);
}

TraceCounts& TraceCounts::operator+=(const TraceCounts& o) {
  rays += o.rays;
  trace_calls_ms += o.trace_calls_ms;
  rays_by_unit.resize(std::max(rays_by_unit.size(), o.rays_by_unit.size()), 0);
  for (size_t i = 0; i < o.rays_by_unit.size(); ++i) rays_by_unit[i] += o.rays_by_unit[i];
  return *this;
}

}  // namespace kestrel
