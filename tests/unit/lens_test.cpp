// SPDX-License-Identifier: GPL-3.0-or-later
// Depth of field: the size and shape of the circle of confusion, from exact geometry.
#include <gtest/gtest.h>

#include <cmath>

#include "frame/camera_rays.h"
#include "frame/sampling.h"
#include "renderer.h"
#include "scenes.h"

namespace kestrel {
namespace {

using test::quad_mesh;
using test::SceneMaker;

constexpr int kSize = 64;
constexpr float kExtent = 4.0f;  // metres that the picture shows of the plane z = 0

/// A camera 10 m above the plane z = 0, with an aperture of this radius.
void look_down(Camera& camera, Projection projection, float focus_distance, float radius) {
  camera.projection = projection;
  camera.world_from_camera[3] = {0.0f, 0.0f, 10.0f};
  const float half = projection == Projection::perspective ? kExtent / 20.0f : kExtent / 2.0f;
  camera.left = camera.bottom = -half;
  camera.right = camera.top = half;
  camera.focus_distance = focus_distance;
  camera.aperture_radius = radius;
}

/// A white half-plane x < 0 at z = 0, seen by many samples.
SceneMaker edge_scene(Primary primary, Projection projection, float focus_distance, float radius) {
  SceneMaker maker;
  Material white;
  white.diffuse = vec4(0, 0, 0, 1);
  white.emission = vec3(1.0f);
  maker.object("edge", quad_mesh({-9, -9, 0}, {9, 0, 0}, {0, 18, 0}), maker.material(white));
  look_down(maker.scene->camera, projection, focus_distance, radius);
  maker.scene->settings.primary = primary;
  maker.scene->settings.samples = 256;
  maker.scene->settings.pixel_filter = PixelFilter::box;
  maker.scene->settings.filter_width = 1.0f;
  return maker;
}

/// Combined's red of each column, mean over the rows.
std::vector<float> profile(const SceneMaker& maker) {
  static const auto device = std::make_shared<Device>();
  Renderer renderer(device);
  renderer.render_frame(maker.scene, kSize, kSize, {});
  const std::vector<float> p = renderer.film().pass("Combined");
  std::vector<float> columns(kSize, 0.0f);
  for (size_t i = 0; i < p.size() / 4; ++i) columns[i % kSize] += p[4 * i] / kSize;
  return columns;
}

/// Share of a disk of this radius that lies on the side x < `at` of its centre.
float disk_share(float at, float radius) {
  const float t = glm::clamp(at / radius, -1.0f, 1.0f);
  return 0.5f + (t * std::sqrt(1.0f - t * t) + std::asin(t)) / kPi;
}

struct LensCase {
  Primary primary;
  Projection projection;
};

class Lens : public ::testing::TestWithParam<LensCase> {};

INSTANTIATE_TEST_SUITE_P(Views, Lens,
                         ::testing::Values(LensCase{Primary::rays, Projection::perspective},
                                           LensCase{Primary::rays, Projection::orthographic},
                                           LensCase{Primary::raster, Projection::perspective},
                                           LensCase{Primary::raster, Projection::orthographic}));

TEST_P(Lens, EdgeOutOfFocusIsBlurredByTheCircleOfConfusion) {
  // Similar triangles: a cone from the aperture to the point in focus at 5 m, 10 m down the view,
  // is as wide there as at the lens.
  const float focus = 5.0f, radius = 0.6f;
  const float circle = radius * std::abs(10.0f - focus) / focus;
  const auto columns =
      profile(edge_scene(GetParam().primary, GetParam().projection, focus, radius));
  for (int x = 0; x < kSize; ++x) {
    const float at = (static_cast<float>(x) + 0.5f) * kExtent / kSize - kExtent / 2.0f;
    EXPECT_NEAR(columns[x], disk_share(-at, circle), 0.02f) << "column " << x;
  }
}

TEST_P(Lens, EdgeInFocusIsSharp) {
  const auto columns = profile(edge_scene(GetParam().primary, GetParam().projection, 10.0f, 0.6f));
  for (int x = 0; x < kSize; ++x) {
    EXPECT_NEAR(columns[x], x < kSize / 2 ? 1.0f : 0.0f, 0.005f) << "column " << x;
  }
}

TEST(LensPicture, OneSampleWithinABudgetIsSharp) {
  SceneMaker maker = edge_scene(Primary::rays, Projection::perspective, 5.0f, 0.6f);
  maker.scene->settings.samples = 1;
  maker.scene->settings.budget_ms = 20.0f;
  const auto columns = profile(maker);
  EXPECT_EQ(columns[kSize / 2 - 1], 1.0f);
  EXPECT_EQ(columns[kSize / 2], 0.0f);
}

TEST(LensPicture, LightReachesAnEyeAtThePointOfTheLens) {
  // A mirror's world: what it shows depends on where the eye is. Out of the sample's own rays the
  // picture of a mirror is that of its unfolded scene: a lamp behind it, seen through it.
  SceneMaker mirrored = edge_scene(Primary::rays, Projection::perspective, 5.0f, 0.6f);
  SceneMaker unfolded = edge_scene(Primary::rays, Projection::perspective, 5.0f, 0.6f);
  Material lamp;
  lamp.diffuse = vec4(0, 0, 0, 1);
  lamp.emission = vec3(1.0f);
  Material mirror;
  mirror.diffuse = vec4(0, 0, 0, 1);
  mirror.optical = {1.0f, 1.0f, 1.0f};
  for (SceneMaker* maker : {&mirrored, &unfolded}) {
    maker->scene->objects.clear();
    maker->scene->units.clear();
    maker->scene->meshes.clear();
    maker->scene->settings.samples = 64;
  }
  mirrored.object("mirror", quad_mesh({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}),
                  mirrored.material(mirror));
  mirrored.object("lamp", quad_mesh({-9, -9, 3}, {9, 0, 0}, {0, 18, 0}), mirrored.material(lamp));
  mirrored.scene->objects.back().hidden_from = kCameraRays;
  unfolded.object("lamp", quad_mesh({-9, -9, -3}, {9, 0, 0}, {0, 18, 0}), unfolded.material(lamp));
  const auto a = profile(mirrored), b = profile(unfolded);
  for (int x = 0; x < kSize; ++x) EXPECT_NEAR(a[x], b[x], 2e-3f) << "column " << x;
}

TEST(LensPicture, AperturePointsFillTheirShape) {
  Camera camera;
  camera.aperture_radius = 2.0f;
  EXPECT_EQ(aperture_point(camera, {0.5f, 0.5f}), vec2(0.0f));
  const auto mean_square = [&camera] {
    vec2 sum(0.0f);
    for (int i = 0; i < 4096; ++i) {
      const vec2 p = aperture_point(camera, lens_position(i));
      sum += p * p / 4096.0f;
      EXPECT_LE(glm::length(p), 2.0f + 1e-5f);
    }
    return sum;
  };
  EXPECT_NEAR(mean_square().x, 1.0f, 0.01f);  // of a disk: a quarter of the squared radius
  EXPECT_NEAR(mean_square().y, 1.0f, 0.01f);
  camera.aperture_blades = 4;  // a square of side 2 sqrt(2): a twelfth of the squared side
  EXPECT_NEAR(mean_square().x, 8.0f / 12.0f, 0.01f);
  EXPECT_NEAR(mean_square().y, 8.0f / 12.0f, 0.01f);
  camera.aperture_ratio = 2.0f;
  EXPECT_NEAR(mean_square().x, 8.0f / 48.0f, 0.01f);
}

TEST(LensPicture, PictureDoesNotDependOnThreadsOrTiles) {
  SceneMaker maker = edge_scene(Primary::rays, Projection::perspective, 5.0f, 0.6f);
  maker.scene->settings.samples = 4;
  const auto all = profile(maker);
  maker.scene->settings.threads = 1;
  EXPECT_EQ(all, profile(maker));
}

}  // namespace
}  // namespace kestrel
