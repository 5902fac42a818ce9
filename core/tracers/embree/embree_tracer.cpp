// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/embree_tracer.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "tracers/embree/tile_tracer.h"

namespace kestrel {

void EmbreeTracer::trace(const TraceRequest& request, EffectBuffers& effects) {
  constexpr int kTile = TileTracer::kSize;
  const int columns = (request.inputs.width + kTile - 1) / kTile;
  const int rows = (request.inputs.rows + kTile - 1) / kTile;
  std::atomic<int> done = 0;
  std::atomic<bool> cancelled = false;
  tbb::enumerable_thread_specific<TileTracer> tracers(
      [&] { return TileTracer(request, scene_, effects); });

  tbb::parallel_for(0, columns * rows, [&](int tile) {
    if (cancelled.load(std::memory_order_relaxed)) return;
    if (request.cancelled && request.cancelled()) cancelled = true;
    tracers.local().trace(tile % columns * kTile, tile / columns * kTile);
    const int finished = ++done;
    if (request.progress) {
      request.progress(static_cast<float>(finished) / static_cast<float>(columns * rows));
    }
  });
  for (const TileTracer& t : tracers) {
    effects.rays += t.rays();
    effects.trace_calls_ms += t.trace_calls_ms();
    for (size_t i = 0; i < effects.rays_by_unit.size(); ++i) {
      effects.rays_by_unit[i] += t.rays_by_unit()[i];
    }
  }
}

}  // namespace kestrel
