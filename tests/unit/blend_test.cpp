// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/blend.h"

#include <gtest/gtest.h>

#include <random>

namespace kestrel {
namespace {

/// Equations 4 to 6 as the paper prints them, in double precision.
double literal(double l, double s, double m, double r, double om, double o_r) {
  const double c = l - (1.0 - s);
  const double cm = om * m + (1.0 - om) * (o_r * r + (1.0 - o_r) * c);
  const double cr = o_r * r + (1.0 - o_r) * (om * m + (1.0 - om) * c);
  return 0.5 * (cm + cr);
}

TEST(Blend, HandComputedNumbers) {
  // C = 0.8 - (1 - 0.7) = 0.5; C_M = 0.25*2 + 0.75*(0.5*1 + 0.5*0.5) = 1.0625;
  // C_R = 0.5*1 + 0.5*(0.25*2 + 0.75*0.5) = 0.9375; average 1.0.
  EXPECT_FLOAT_EQ(blend_pixel(vec3(0.8f), vec3(0.7f), vec3(2.0f), vec3(1.0f), 0.25f, 0.5f).x, 1.0f);
  // Only a mirror: M. Only glass: R. Neither: lighting less shadow.
  EXPECT_FLOAT_EQ(blend_pixel(vec3(0.8f), vec3(1.0f), vec3(2.0f), vec3(9.0f), 1.0f, 0.0f).x, 2.0f);
  EXPECT_FLOAT_EQ(blend_pixel(vec3(0.8f), vec3(1.0f), vec3(9.0f), vec3(3.0f), 0.0f, 1.0f).x, 3.0f);
  EXPECT_FLOAT_EQ(blend_pixel(vec3(0.8f), vec3(0.7f), vec3(9.0f), vec3(9.0f), 0.0f, 0.0f).x, 0.5f);
}

TEST(Blend, BrightLightsKeepTheirShadow) {
  // L = 5 from one light of 5, wholly blocked: S = 1 - 5 = -4, and the shadow is black.
  EXPECT_FLOAT_EQ(blend_pixel(vec3(5.0f), vec3(-4.0f), vec3(0.0f), vec3(0.0f), 0.0f, 0.0f).x, 0.0f);
}

TEST(Blend, FollowsEquationsFourToSix) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  for (int i = 0; i < 10000; ++i) {
    const float s = u(random), l = 1.0f - s + u(random), m = 4 * u(random), r = 4 * u(random);
    const float om = u(random), o_r = u(random);
    EXPECT_NEAR(blend_pixel(vec3(l), vec3(s), vec3(m), vec3(r), om, o_r).x,
                literal(l, s, m, r, om, o_r), 2e-6);
  }
}

TEST(Blend, FurnaceKeepsUniformRadiance) {
  // Where everything around has radiance 1, every surface must show 1, whatever its properties.
  for (float om = 0.0f; om <= 1.0f; om += 0.125f) {
    for (float o_r = 0.0f; o_r <= 1.0f; o_r += 0.125f) {
      EXPECT_NEAR(blend_pixel(vec3(1.0f), vec3(1.0f), vec3(1.0f), vec3(1.0f), om, o_r).x, 1.0f,
                  1e-6);
      const BlendWeights w = blend_weights(om, o_r);
      EXPECT_NEAR(w.surface + w.reflection + w.refraction, 1.0f, 1e-6);
    }
  }
}

}  // namespace
}  // namespace kestrel
