// SPDX-License-Identifier: GPL-3.0-or-later
// Exact effects on the processor: Whitted ray tracing of the scene's triangles with Embree.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include "scene/rt_scene.h"
#include "tracers/embree/tile_tracer.h"
#include "tracers/tracer.h"

namespace kestrel {

class EmbreeTracer : public Tracer {
 public:
  /// `scene` must outlive it and be up to date.
  explicit EmbreeTracer(const RtScene& scene) : scene_(scene) {}

  /// Tiles in parallel; the result does not depend on how many threads there are.
  void trace(const TraceRequest& request, EffectBuffers& effects, TraceCounts& counts) override;

 private:
  const RtScene& scene_;
  tbb::enumerable_thread_specific<TileTracer::Buffers> buffers_;
};

}  // namespace kestrel
