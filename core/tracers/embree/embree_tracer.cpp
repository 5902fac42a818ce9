// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/embree_tracer.h"

#include <atomic>
#include <mutex>

#include "frame/region_loops.h"

namespace kestrel {

void EmbreeTracer::trace(const TraceRequest& request, EffectBuffers& effects, TraceCounts& counts) {
  const Region& region = request.inputs.region;
  const float tiles = static_cast<float>(tile_count(region));
  std::atomic<int> done = 0;
  std::atomic<bool> cancelled = false;
  std::mutex merging;
  for_tiles(region, [&](const Region& tile) {
    if (cancelled.load(std::memory_order_relaxed)) return;
    if (request.cancelled && request.cancelled()) cancelled = true;
    TileTracer tracer(request, scene_, buffers_.local(), effects);
    tracer.trace({tile.x - region.x, tile.y - region.y, tile.width, tile.height});
    const int finished = ++done;
    if (request.progress) request.progress(static_cast<float>(finished) / tiles);
    const std::lock_guard lock(merging);
    tracer.add_counts(counts);
  });
}

}  // namespace kestrel
