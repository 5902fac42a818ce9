// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "base/math.h"
#include "tracers/embree/embree_api.h"

namespace kestrel::embree {

/// What a shadow ray has met so far.
struct ShadowState {
  /// A ray through an edge meets both triangles; the light is to be taken off once. Crossings of
  /// one object at practically the same distance count as one.
  static constexpr uint32_t kRemembered = 8;

  vec3 transmitted;
  uint32_t crossings;
  float distances[kRemembered];
  int objects[kRemembered];

  /// Before the ray starts.
  void reset() {
    transmitted = vec3(1.0f);
    crossings = 0;
  }

  /// Whether this crossing is new; remembers it.
  bool enter(int object, float distance) {
    constexpr float kSame = 2e-6f;  // relative; a few roundings of the intersection
    const uint32_t known = glm::min(crossings, kRemembered);
    for (uint32_t i = 0; i < known; ++i) {
      if (objects[i] == object && std::abs(distances[i] - distance) <= kSame * distance) {
        return false;
      }
    }
    distances[crossings % kRemembered] = distance;
    objects[crossings % kRemembered] = object;
    ++crossings;
    return true;
  }
};

/// Query with what the filter of shadow rays needs: their states, by RTCRay::id.
struct ShadowQuery : Query {
  ShadowState* states;
  explicit ShadowQuery(ShadowState* states_by_id) : states(states_by_id) {}
};

}  // namespace kestrel::embree
