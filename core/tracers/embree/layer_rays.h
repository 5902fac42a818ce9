// SPDX-License-Identifier: GPL-3.0-or-later
// What can be seen straight through surfaces that do not cover all of what is behind them: alpha,
// and transparency that does not bend the view. For passes that list or weigh whatever shows.
#pragma once

#include "frame/frame.h"
#include "scene/rt_scene.h"

namespace kestrel {

class LayerRays {
 public:
  /// `scene` must outlive it and be up to date.
  explicit LayerRays(const RtScene& scene) : scene_(scene) {}

  /// Fills `gbuffer.behind`; all other planes are there. Returns the number of rays.
  uint64_t run(const FrameInputs& inputs, GBuffer& gbuffer);

 private:
  const RtScene& scene_;
};

}  // namespace kestrel
