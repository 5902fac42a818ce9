// SPDX-License-Identifier: GPL-3.0-or-later
// The camera as the rasteriser needs it.
#pragma once

#include "frame/frame.h"
#include "gl/shared_structs.h"

namespace kestrel {

/// Clip space of the frame's sample: x and y in [-w, w], z in [0, w] with 1 at the near plane and 0
/// at the far one after the division (reversed z). The sample lies FrameInputs::subpixel off the
/// pixel's centre, so the picture moves the other way.
glm::dmat4 clip_from_world(const Scene& scene, const FrameInputs& inputs);

/// False only where the box lies wholly outside one plane of the view.
bool may_be_visible(const Bounds& bounds_ws, const glm::dmat4& clip_from_world);

/// Everything of the frame that the shaders read.
gpu::GpuFrame gpu_frame(const Scene& scene, const FrameInputs& inputs);

}  // namespace kestrel
