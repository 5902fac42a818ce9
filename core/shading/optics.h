// SPDX-License-Identifier: GPL-3.0-or-later
// Directions after a mirror or a boundary between two media.
#pragma once

#include "base/math.h"

namespace kestrel {

/// Mirror direction of an incoming unit direction at a normal that faces it. A bent normal may
/// send it below the surface; it is then lifted until it grazes it.
inline vec3 reflect_outward(const vec3& incoming, const vec3& normal,
                            const vec3& normal_geometric) {
  const vec3 r = glm::reflect(incoming, normal);
  const float height = glm::dot(r, normal_geometric);
  constexpr float kGrazing = 1e-3f;
  return height >= kGrazing ? r : glm::normalize(r + (kGrazing - height) * normal_geometric);
}

/// Snell's law: `eta` is the index of refraction on the incoming side over that on the other, the
/// normal faces the incoming unit direction. Total internal reflection gives the mirror direction.
inline vec3 refract_or_reflect(const vec3& incoming, const vec3& normal, float eta) {
  const float cos_in = glm::max(-glm::dot(incoming, normal), 0.0f);
  const float k = 1.0f - eta * eta * (1.0f - cos_in * cos_in);
  if (k < 0.0f) return glm::reflect(incoming, normal);
  return glm::normalize(eta * incoming + (eta * cos_in - glm::sqrt(k)) * normal);
}

}  // namespace kestrel
