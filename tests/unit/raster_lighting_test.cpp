// SPDX-License-Identifier: GPL-3.0-or-later
// The lighting pass against numbers worked out by hand (paper, listing 5).
#include <cmath>

#include "raster_fixture.h"

namespace kestrel {
namespace {

using test::rectangle;
using test::SceneMaker;

class RasterLighting : public test::RasterTest {
 protected:
  /// L of a wall in the plane z = 0 at the picture's only pixel, which lies at the origin.
  vec3 lit(SceneMaker& maker, const Material& material) {
    maker.object("wall", rectangle(-1, -1, 1, 1), maker.material(material));
    return render(maker, 1, 1).lighting[0];
  }

  static Material matte(const vec3& color) {
    Material m;
    m.diffuse = vec4(color, 1.0f);
    return m;
  }
};

// One ulp of a 16-bit float is 1 / 1024 of the value at most.
#define EXPECT_LIGHT(actual, expected)                                                           \
  do {                                                                                           \
    const vec3 light_actual = (actual), light_expected = (expected);                             \
    for (int k = 0; k < 3; ++k) {                                                                \
      EXPECT_NEAR(light_actual[k], light_expected[k], 1e-3 * std::abs(light_expected[k]) + 1e-6) \
          << "channel " << k;                                                                    \
    }                                                                                            \
  } while (false)

TEST_F(RasterLighting, NoLightsLeaveEmissionAndAmbient) {
  SceneMaker maker;
  maker.scene->settings.ambient = vec3(0.5f, 1.0f, 2.0f);
  Material m = matte(vec3(1));
  m.emission = vec3(3.0f, 0.0f, 0.25f);
  m.ambient = vec3(0.5f, 0.25f, 0.25f);
  EXPECT_LIGHT(lit(maker, m), vec3(3.25f, 0.25f, 0.75f));
}

TEST_F(RasterLighting, DirectionalLightFollowsTheCosine) {
  SceneMaker maker;
  // 60 degrees off the normal: half the light, however far.
  maker.light(LightType::directional, vec3(2, 4, 8), vec3(std::sqrt(3.0f), 0, -1));
  EXPECT_LIGHT(lit(maker, matte({0.5f, 0.5f, 0.25f})), vec3(0.5f, 1.0f, 1.0f));
}

TEST_F(RasterLighting, LightFromBehindTheSurfaceDoesNotReachIt) {
  SceneMaker maker;
  maker.light(LightType::directional, vec3(1), vec3(0, 0, 1));
  maker.light(LightType::point, vec3(1), vec3(0, 0, -2));
  EXPECT_EQ(lit(maker, matte(vec3(1))), vec3(0.0f));
}

TEST_F(RasterLighting, PointLightFallsOffWithTheSquareOfTheDistance) {
  SceneMaker maker;
  maker.light(LightType::point, vec3(1), vec3(0, 3, 4));  // 5 m away, cosine 4/5
  EXPECT_LIGHT(lit(maker, matte(vec3(1))), vec3(0.8f / 25.0f));
}

TEST_F(RasterLighting, AttenuationHasThreeTerms) {
  SceneMaker maker;
  maker.light(LightType::point, vec3(1), vec3(0, 0, 2)).attenuation = vec3(1.0f, 0.5f, 0.25f);
  EXPECT_LIGHT(lit(maker, matte(vec3(1))), vec3(1.0f / 3.0f));
}

TEST_F(RasterLighting, LightOnTheSurfaceItselfIsNoTrouble) {
  SceneMaker maker;
  maker.light(LightType::point, vec3(1), vec3(0, 0, 0));
  maker.light(LightType::point, vec3(1), vec3(0, 0, 1)).attenuation = vec3(0.0f);
  EXPECT_EQ(lit(maker, matte(vec3(1))), vec3(0.0f));
}

class RasterSpot : public RasterLighting {
 protected:
  /// L of a white wall under a spot 1 m above it, aimed `off_axis` degrees away from the point.
  float spot(float off_axis, float half_angle, float blend) {
    SceneMaker maker;
    Light& light = maker.light(LightType::spot, vec3(1), vec3(0, 0, 1));
    const float turn = glm::radians(off_axis);
    light.direction = vec3(std::sin(turn), 0.0f, -std::cos(turn));
    light.cos_outer = std::cos(glm::radians(half_angle));
    light.blend = blend;
    return lit(maker, matte(vec3(1))).x;
  }
};

TEST_F(RasterSpot, HardEdgeIsAllOrNothing) {
  EXPECT_NEAR(spot(0.0f, 30.0f, 0.0f), 1.0f, 1e-3);
  EXPECT_NEAR(spot(29.5f, 30.0f, 0.0f), 1.0f, 1e-3);
  EXPECT_EQ(spot(30.5f, 30.0f, 0.0f), 0.0f);
  EXPECT_EQ(spot(180.0f, 30.0f, 0.0f), 0.0f);
}

TEST_F(RasterSpot, BlendSoftensTheEdgeInwards) {
  // Half angle 60 degrees, blend 0.4: the edge runs from cosine 0.5 to 0.5 + 0.4 * 0.5 = 0.7.
  const auto degrees_of = [](double cosine) {
    return static_cast<float>(glm::degrees(std::acos(cosine)));
  };
  EXPECT_EQ(spot(61.0f, 60.0f, 0.4f), 0.0f);
  EXPECT_NEAR(spot(degrees_of(0.55), 60.0f, 0.4f), 0.15625, 1e-3);  // smoothstep(1/4)
  EXPECT_NEAR(spot(degrees_of(0.60), 60.0f, 0.4f), 0.5, 1e-3);      // smoothstep(1/2)
  EXPECT_NEAR(spot(degrees_of(0.65), 60.0f, 0.4f), 0.84375, 1e-3);  // smoothstep(3/4)
  EXPECT_NEAR(spot(degrees_of(0.75), 60.0f, 0.4f), 1.0, 1e-3);
}

TEST_F(RasterLighting, HighlightIsBlinnsWithTheExponentOfTable1) {
  // Viewer straight above, light 60 degrees off: the half vector leans 30 degrees.
  for (const float a : {0.0f, 7.0f / 254.0f, 1.0f}) {
    SceneMaker maker;
    maker.light(LightType::directional, vec3(1, 2, 4), vec3(std::sqrt(3.0f), 0, -1));
    Material m = matte(vec3(0));
    m.specular = vec4(0.5f, 0.5f, 0.5f, a);
    const double exponent = 1.0 + 254.0 * a;  // 1, 8, 255
    const float highlight = static_cast<float>(std::pow(std::sqrt(0.75), exponent));
    const vec3 actual = lit(maker, m);
    // The 16-bit exponent in the target moves the power a little.
    EXPECT_NEAR(actual.x, 0.5f * highlight, 2e-3 * highlight + 1e-6) << "exponent " << exponent;
    EXPECT_NEAR(actual.z, 2.0f * highlight, 8e-3 * highlight + 1e-6) << "exponent " << exponent;
  }
}

TEST_F(RasterLighting, SpecularFactorScalesTheHighlightAlone) {
  SceneMaker maker;
  maker.light(LightType::directional, vec3(1), vec3(0, 0, -1)).specular_factor = 0.25f;
  Material m = matte(vec3(0.5f));
  m.specular = vec4(1, 1, 1, 0.5f);
  EXPECT_LIGHT(lit(maker, m), vec3(0.75f));
}

TEST_F(RasterLighting, SurfaceFacesTheViewerFromBothSides) {
  for (const bool from_behind : {false, true}) {
    SceneMaker maker;
    maker.light(LightType::directional, vec3(1), vec3(0, 0, -1));
    auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
    if (from_behind) {
      for (uvec3& t : mesh->triangles) std::swap(t.y, t.z);
    }
    maker.object("wall", mesh, maker.material(matte(vec3(0.5f))));
    EXPECT_LIGHT(render(maker, 1, 1).lighting[0], vec3(0.5f));
  }
}

TEST_F(RasterLighting, PerspectiveViewerStandsAtTheCamera) {
  SceneMaker maker = test::perspective_scene();
  maker.scene->camera.world_from_camera[3] = vec3(0, 0, 1);
  // Light from straight above; the only pixel sees the point (3/4, 0, 0), view at cosine 4/5.
  maker.scene->camera.left = 0.5f;
  maker.scene->camera.right = 1.0f;
  maker.scene->camera.bottom = -0.25f;
  maker.scene->camera.top = 0.25f;
  maker.light(LightType::directional, vec3(1), vec3(0, 0, -1));
  Material m = matte(vec3(0));
  m.specular = vec4(1, 1, 1, 0);  // exponent 1
  // cos of half the angle whose cosine is 4/5: sqrt(0.9).
  EXPECT_LIGHT(lit(maker, m), vec3(std::sqrt(0.9f)));
}

TEST_F(RasterLighting, LightsAddUpBeyondThePapersLimits) {
  SceneMaker maker;
  for (int i = 0; i < 100; ++i) {
    maker.light(LightType::directional, vec3(0.01f), vec3(0, 0, -1));
    maker.light(LightType::point, vec3(0.02f), vec3(0, 0, 1));
    Light& spot = maker.light(LightType::spot, vec3(0.03f), vec3(0, 0, 1));
    spot.cos_outer = 0.5f;
  }
  EXPECT_LIGHT(lit(maker, matte(vec3(0.5f))), vec3(3.0f));
}

TEST_F(RasterLighting, BlindingLightStaysFinite) {
  SceneMaker maker;
  maker.light(LightType::directional, vec3(1e9f, 1.0f, 0.0f), vec3(0, 0, -1));
  const vec3 radiance = lit(maker, matte(vec3(1)));
  EXPECT_EQ(radiance.x, 65504.0f);
  EXPECT_LIGHT(vec3(radiance.y), vec3(1.0f));
}

TEST_F(RasterLighting, ChangedLightShowsInTheNextFrame) {
  SceneMaker maker;
  maker.light(LightType::directional, vec3(1), vec3(0, 0, -1));
  EXPECT_LIGHT(lit(maker, matte(vec3(0.5f))), vec3(0.5f));
  maker.scene = std::make_shared<Scene>(*maker.scene);
  maker.scene->lights[0].color = vec3(0.25f);
  EXPECT_LIGHT(render(maker, 1, 1).lighting[0], vec3(0.125f));
  maker.scene = std::make_shared<Scene>(*maker.scene);
  maker.scene->lights.clear();
  EXPECT_EQ(render(maker, 1, 1).lighting[0], vec3(0.0f));
}

}  // namespace
}  // namespace kestrel
