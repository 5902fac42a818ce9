// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's aperture: with one, every sample looks through another point of it.
#pragma once

#include "frame/frame.h"

namespace kestrel {

/// Whether the camera blurs what is out of focus.
inline bool has_aperture(const Camera& camera) {
  return camera.aperture_radius > 0.0f;
}

/// The point of the aperture, in metres along the camera's X and Y, that belongs to one of the unit
/// square: areas keep their proportions. The square's middle is a round aperture's centre.
vec2 aperture_point(const Camera& camera, const vec2& square);

/// The same through which pixel (x, y) of the picture looks in a frame's sample; (0, 0) for a
/// pinhole.
vec2 aperture_point(const Camera& camera, const LensSample& sample, int x, int y);

/// The pinhole camera that looks through a point of the aperture and shows the plane in focus as
/// the whole camera does. In orthographic views its Z axis leans, and its length is that of a step
/// of one metre in depth.
Camera seen_through(const Camera& camera, const vec2& aperture_point);

}  // namespace kestrel
