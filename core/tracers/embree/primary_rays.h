// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 1 without OpenGL: fills the same G-buffer by primary rays (the paper's "ray tracing only"
// baseline), and lights it.
#pragma once

#include "frame/frame.h"
#include "scene/rt_scene.h"

namespace kestrel {

class PrimaryRays {
 public:
  /// `scene` must outlive it and be up to date.
  explicit PrimaryRays(const RtScene& scene) : scene_(scene) {}

  /// Fills every plane of `out` except heuristic_mask. Returns the number of rays.
  uint64_t run(const FrameInputs& inputs, GBuffer& out);

 private:
  const RtScene& scene_;
};

}  // namespace kestrel
