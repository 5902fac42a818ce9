// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 4: lighting and effects become the picture (paper, section 3.4, equations 4 to 6).
#pragma once

#include <vector>

#include "frame/blend_weights.h"
#include "frame/frame.h"

namespace kestrel {

/// One pixel: lighting L, shadow S, reflection M, refraction R, and the optical properties.
///   C   = L - (1 - S)                                                  (eq. 4)
///   C_M = O_M M + (1 - O_M) (O_R R + (1 - O_R) C)                      (eq. 5)
///   C_R = O_R R + (1 - O_R) (O_M M + (1 - O_M) C)                      (eq. 6)
/// and their average. C is kept from falling below 0, where L was rounded.
vec3 blend_pixel(const vec3& lighting, const vec3& shadow, const vec3& reflection,
                 const vec3& refraction, float reflectivity, float transparency);

class BlendStage {
 public:
  /// Combined: linear RGB, premultiplied by alpha, which is 1 but for holdouts and, on a
  /// transparent film, where the camera sees the world, straight through surfaces too. Effects that
  /// were not traced leave the lighting as it is: an untraced reflection or refraction counts as
  /// lighting in its place.
  void run(const FrameInputs& inputs, const GBuffer& gbuffer, const Selection& selection,
           const EffectBuffers& effects, Plane<vec4>& combined);
};

}  // namespace kestrel
