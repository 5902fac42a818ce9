// SPDX-License-Identifier: GPL-3.0-or-later
// The frame's uniform block, and the largest value of a 16-bit float target.
#include "common/gpu_structs.glsl"

layout(std140, binding = 0) uniform FrameBlock {
  GpuFrame frame;
};

const float kLargestHalf = 65504.0;
