// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/optics.h"

#include <gtest/gtest.h>

namespace kestrel {
namespace {

vec3 incoming_at(float degrees) {
  const float a = glm::radians(degrees);
  return {std::sin(a), 0.0f, -std::cos(a)};
}

const vec3 kUp(0.0f, 0.0f, 1.0f);

TEST(Optics, MirrorsAtTheNormal) {
  const vec3 r = reflect_outward(incoming_at(30.0f), kUp, kUp);
  EXPECT_NEAR(r.x, 0.5f, 1e-6);
  EXPECT_NEAR(r.z, std::sqrt(3.0f) / 2.0f, 1e-6);
}

TEST(Optics, BentNormalNeverReflectsBelowTheSurface) {
  const vec3 bent = glm::normalize(vec3(1.0f, 0.0f, 0.3f));
  const vec3 r = reflect_outward(incoming_at(-80.0f), bent, kUp);
  EXPECT_GT(r.z, 0.0f);
  EXPECT_NEAR(glm::length(r), 1.0f, 1e-5);
}

TEST(Optics, SnellsLaw) {
  // From air into glass of 1.5 at 45 degrees: sin t = sin 45 / 1.5, so 28.1255 degrees.
  const vec3 t = refract_or_reflect(incoming_at(45.0f), kUp, 1.0f / 1.5f);
  EXPECT_NEAR(glm::degrees(std::asin(t.x)), 28.1255f, 1e-3);
  EXPECT_LT(t.z, 0.0f);
  // And back out into air: the first angle again.
  const vec3 out = refract_or_reflect(t, kUp, 1.5f);
  EXPECT_NEAR(glm::degrees(std::asin(out.x)), 45.0f, 1e-3);
}

TEST(Optics, StraightThroughEqualMedia) {
  const vec3 d = incoming_at(63.0f);
  EXPECT_NEAR(glm::length(refract_or_reflect(d, kUp, 1.0f) - d), 0.0f, 1e-6);
}

TEST(Optics, TotalInternalReflectionBeyondTheCriticalAngle) {
  // Glass 1.5 to air: critical angle asin(1 / 1.5) = 41.81 degrees.
  const vec3 below = refract_or_reflect(incoming_at(41.7f), kUp, 1.5f);
  EXPECT_LT(below.z, 0.0f);
  const vec3 beyond = refract_or_reflect(incoming_at(41.9f), kUp, 1.5f);
  EXPECT_NEAR(beyond.z, std::cos(glm::radians(41.9f)), 1e-5);  // mirrored, not negated
  EXPECT_NEAR(beyond.x, std::sin(glm::radians(41.9f)), 1e-5);
}

}  // namespace
}  // namespace kestrel
