// SPDX-License-Identifier: GPL-3.0-or-later
// Where a direction lands in the world's images. The shaders hold the same formulas.
#pragma once

#include <cmath>

#include "base/math.h"

namespace kestrel {

/// Blender's equirectangular mapping of a unit direction: u = 0.5 - atan2(y, x) / 2π,
/// v = 0.5 + asin(z) / π. The image's middle lies towards +X, its top is up.
inline vec2 equirectangular_uv(const vec3& direction) {
  return {0.5f - std::atan2(direction.y, direction.x) / (2.0f * kPi),
          0.5f + std::asin(glm::clamp(direction.z, -1.0f, 1.0f)) / kPi};
}

struct CubeUv {
  int face;  // 0…5: +X -X +Y -Y +Z -Z
  vec2 uv;   // 0…1, v up in an image whose row 0 is at the bottom
};

/// OpenGL's cube map selection (specification 8.13, table 8.19). GL's t runs down the image, so v
/// is turned for textures stored with row 0 at the bottom.
inline CubeUv cube_uv(const vec3& d) {
  const vec3 a = glm::abs(d);
  int face;
  float sc, tc, ma;
  if (a.x >= a.y && a.x >= a.z) {
    face = d.x > 0.0f ? 0 : 1;
    sc = d.x > 0.0f ? -d.z : d.z;
    tc = -d.y;
    ma = a.x;
  } else if (a.y >= a.z) {
    face = d.y > 0.0f ? 2 : 3;
    sc = d.x;
    tc = d.y > 0.0f ? d.z : -d.z;
    ma = a.y;
  } else {
    face = d.z > 0.0f ? 4 : 5;
    sc = d.z > 0.0f ? d.x : -d.x;
    tc = -d.y;
    ma = a.z;
  }
  if (ma == 0.0f) return {0, vec2(0.5f)};
  return {face, vec2(0.5f * (sc / ma + 1.0f), 1.0f - 0.5f * (tc / ma + 1.0f))};
}

}  // namespace kestrel
