// SPDX-License-Identifier: GPL-3.0-or-later
// How far what a pixel shows has moved since the frame before, and moves until the next one: the
// pass Vector, as Cycles and Blender's compositor have it.
#pragma once

#include "frame/frame.h"
#include "scene/rt_scene.h"

namespace kestrel {

class MotionVectors {
 public:
  /// `scene` must outlive it and be up to date.
  explicit MotionVectors(const RtScene& scene) : rt_(scene) {}

  /// Fills GBuffer::motion from the rest: XY is the place in the first state less that of now, ZW
  /// that of now less the one in the last state, pixels, X to the right, Y up. 0 where nothing
  /// moves, nothing is seen, or the point is behind the camera in one of the states.
  void run(const FrameInputs& inputs, GBuffer& gbuffer);

 private:
  vec4 at(const FrameInputs& inputs, const GBuffer& gbuffer, int x, int y) const;

  const RtScene& rt_;
};

}  // namespace kestrel
