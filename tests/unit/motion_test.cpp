// SPDX-License-Identifier: GPL-3.0-or-later
// Motion blur and the pass Vector: exact coverage of what moves evenly while the shutter is open.
#include <gtest/gtest.h>

#include <cmath>

#include "renderer.h"
#include "scene/motion.h"
#include "scenes.h"

namespace kestrel {
namespace {

using test::placed;
using test::quad_mesh;
using test::SceneMaker;

constexpr int kSize = 32;       // the picture shows 2 x 2 metres around the origin
constexpr float kWidth = 0.4f;  // of the bar, metres
constexpr float kWay = 1.0f;    // that it moves while the shutter is open, metres

/// The bar half-way through its motion: |x| < kWidth / 2.
std::shared_ptr<Mesh> bar(float z = 0.0f) {
  return quad_mesh({-kWidth / 2.0f, -4, z}, {kWidth, 0, 0}, {0, 8, 0});
}

Material glowing() {
  Material m;
  m.diffuse = vec4(0, 0, 0, 1);
  m.emission = vec3(1.0f);
  return m;
}

std::shared_ptr<const ObjectMotion> motion(const std::vector<vec3>& places) {
  std::vector<mat4x3> matrices;
  for (const vec3& place : places) matrices.push_back(placed(place));
  return motion_from(matrices);
}

struct Picture {
  std::vector<float> combined, vector;

  explicit Picture(const SceneMaker& maker) {
    static const auto device = std::make_shared<Device>();
    Renderer renderer(device);
    renderer.render_frame(maker.scene, kSize, kSize, {});
    combined = renderer.film().pass("Combined");
    vector = renderer.film().pass("Vector");
  }
  float red(int x, int y = kSize / 2) const { return combined[4 * (y * kSize + x)]; }
  vec4 motion(int x, int y) const {
    const float* v = &vector[4 * (y * kSize + x)];
    return {v[0], v[1], v[2], v[3]};
  }
};

float center_of(int x) {
  return (static_cast<float>(x) + 0.5f) * 2.0f / kSize - 1.0f;
}

/// Share of the time in which the bar, moving along X by `way`, covers a place.
float covered(float x, float way = kWay) {
  const float enter = (x - kWidth / 2.0f) / way + 0.5f, leave = (x + kWidth / 2.0f) / way + 0.5f;
  return glm::clamp(leave, 0.0f, 1.0f) - glm::clamp(enter, 0.0f, 1.0f);
}

void expect_trapezoid(const SceneMaker& maker) {
  const Picture picture(maker);
  for (int x = 0; x < kSize; ++x) {
    EXPECT_NEAR(picture.red(x), covered(center_of(x)), 0.015f) << "column " << x;
  }
}

class Motion : public ::testing::TestWithParam<Primary> {
 protected:
  SceneMaker maker_;

  Motion() {
    Settings& settings = maker_.scene->settings;
    settings.primary = GetParam();
    settings.samples = 144;
    settings.pixel_filter = PixelFilter::box;
    settings.filter_width = 0.01f;
    settings.motion_blur = true;
  }
};

INSTANTIATE_TEST_SUITE_P(Primaries, Motion, ::testing::Values(Primary::rays, Primary::raster));

TEST_P(Motion, OfAnObject) {
  maker_.object("bar", bar(), maker_.material(glowing()));
  maker_.scene->objects[0].motion = motion({{-0.5f, 0, 0}, {0, 0, 0}, {0.5f, 0, 0}});
  expect_trapezoid(maker_);
}

TEST_P(Motion, OfTheCamera) {
  maker_.object("bar", bar(), maker_.material(glowing()));
  for (const float x : {0.5f, -0.5f}) {
    Camera state = maker_.scene->camera;
    state.world_from_camera[3].x = x;
    maker_.scene->camera_motion.push_back(state);
  }
  expect_trapezoid(maker_);
}

TEST_P(Motion, OfAShape) {
  const auto mesh = bar();
  MeshMotion shapes;
  for (const float x : {-0.5f, 0.0f, 0.5f}) {
    MeshShape shape{mesh->positions, {}};
    for (vec3& p : shape.positions) p.x += x;
    shapes.push_back(shape);
  }
  mesh->motion = std::make_shared<const MeshMotion>(shapes);
  maker_.object("bar", mesh, maker_.material(glowing()));
  expect_trapezoid(maker_);
}

TEST_P(Motion, OfAShadow) {
  Material white;
  white.diffuse = vec4(1.0f);
  maker_.object("floor", quad_mesh({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}), maker_.material(white));
  maker_.object("bar", bar(1.0f), 0);
  maker_.scene->objects[1].hidden_from = kCameraRays;
  maker_.scene->objects[1].motion = motion({{-0.5f, 0, 0}, {0.5f, 0, 0}});
  maker_.light(LightType::directional, vec3(1.0f), {0, 0, -1});
  const Picture picture(maker_);
  for (int x = 0; x < kSize; ++x) {
    EXPECT_NEAR(picture.red(x), 1.0f - covered(center_of(x)), 0.015f) << "column " << x;
  }
}

TEST_P(Motion, TurningKeepsTheSize) {
  // Half a turn about the origin, of a bar that reaches 0.9 m from it: in between it is no shorter.
  maker_.object("hand", quad_mesh({0, -0.05f, 0}, {0.9f, 0, 0}, {0, 0.1f, 0}),
                maker_.material(glowing()));
  std::vector<mat4x3> matrices;
  for (const float angle : {0.0f, kPi / 2.0f, kPi}) {
    const float c = std::cos(angle), s = std::sin(angle);
    matrices.push_back(mat4x3(vec3(c, s, 0), vec3(-s, c, 0), vec3(0, 0, 1), vec3(0)));
  }
  maker_.scene->objects[0].motion = motion_from(matrices);
  const Picture picture(maker_);
  const int along = kSize / 2 + static_cast<int>(0.8f * std::sqrt(0.5f) * kSize / 2);
  EXPECT_GT(picture.red(along, along), 0.02f);  // 0.8 m along the diagonal
  EXPECT_EQ(picture.red(kSize / 2, 2), 0.0f);
}

TEST_P(Motion, StillScenesAreTheSameToTheBit) {
  maker_.object("bar", bar(), maker_.material(glowing()));
  maker_.scene->settings.samples = 4;
  const Picture blurred(maker_);
  maker_.scene->settings.motion_blur = false;
  EXPECT_EQ(blurred.combined, Picture(maker_).combined);
}

TEST_P(Motion, VectorsArePixelsBeforeAndAfter) {
  Settings& settings = maker_.scene->settings;
  settings.motion_blur = false;
  settings.samples = 1;
  maker_.object("bar", bar(), maker_.material(glowing()));
  maker_.scene->objects[0].motion = motion({{-0.25f, 0.5f, 0}, {0, 0, 0}, {0.125f, 0, 0}});
  const Picture moved(maker_);
  const float pixels = kSize / 2.0f;  // a metre
  const vec4 v = moved.motion(kSize / 2, kSize / 2);
  EXPECT_NEAR(v.x, -0.25f * pixels, 1e-3f);
  EXPECT_NEAR(v.y, 0.5f * pixels, 1e-3f);
  EXPECT_NEAR(v.z, -0.125f * pixels, 1e-3f);
  EXPECT_NEAR(v.w, 0.0f, 1e-3f);
  EXPECT_EQ(moved.motion(1, 1), vec4(0.0f));
  EXPECT_EQ(moved.red(kSize / 2), 1.0f);  // the picture itself is that of the moment
}

TEST_P(Motion, VectorsOfAShape) {
  Settings& settings = maker_.scene->settings;
  settings.motion_blur = false;
  settings.samples = 1;
  const auto mesh = bar();
  MeshMotion shapes(3, MeshShape{mesh->positions, {}});
  for (vec3& p : shapes[0].positions) p.x *= 2.0f;  // it was twice as wide, and will be as it is
  mesh->motion = std::make_shared<const MeshMotion>(shapes);
  maker_.object("bar", mesh, maker_.material(glowing()));
  const int x = kSize / 2 + 2;
  const vec4 v = Picture(maker_).motion(x, kSize / 2);
  EXPECT_NEAR(v.x, center_of(x) * kSize / 2.0f, 1e-2f);
  EXPECT_NEAR(v.z, 0.0f, 1e-3f);
}

TEST(Pose, InBetweenTwoMatrices) {
  mat4x3 a(1.0f), b(2.0f);
  b[3] = {4, 0, 0};
  const mat4x3 half = in_between(poses_from({a, b}), 0.5f);
  EXPECT_NEAR(half[0].x, 1.5f, 1e-6f);
  EXPECT_NEAR(half[3].x, 2.0f, 1e-6f);
  a[0] = -a[0];  // a mirror image stays one
  b[0] = -b[0];
  EXPECT_NEAR(in_between(poses_from({a, b}), 0.5f)[0].x, -1.5f, 1e-5f);
  b[1] = vec3(0.0f);  // no inverse: a weighted mean
  EXPECT_NEAR(in_between(poses_from({a, b}), 0.5f)[1].y, 0.5f, 1e-6f);
}

}  // namespace
}  // namespace kestrel
