// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace kestrel {

/// What the average of equations 5 and 6 weighs each part with; they add up to 1.
struct BlendWeights {
  float surface;     // (1 - O_M) (1 - O_R)
  float reflection;  // O_M (1 - O_R / 2)
  float refraction;  // O_R (1 - O_M / 2)
};

inline BlendWeights blend_weights(float reflectivity, float transparency) {
  return {(1.0f - reflectivity) * (1.0f - transparency),
          reflectivity * (1.0f - 0.5f * transparency), transparency * (1.0f - 0.5f * reflectivity)};
}

}  // namespace kestrel
