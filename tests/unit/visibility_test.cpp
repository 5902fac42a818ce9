// SPDX-License-Identifier: GPL-3.0-or-later
// Which rays meet an object, holdouts and the transparent film: whole frames with known answers,
// found by rays and by rasterising.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "renderer.h"
#include "scenes.h"

namespace kestrel {
namespace {

using test::quad_mesh;
using test::SceneMaker;

constexpr int kSize = 16;
const vec3 kRed{1.0f, 0.0f, 0.0f};
const vec3 kWorld{0.25f, 0.5f, 0.75f};

/// A sheet 2 m wide in the plane z, from x = `left` to `right`.
std::shared_ptr<Mesh> sheet(float left, float right, float z) {
  return quad_mesh({left, -1.0f, z}, {right - left, 0.0f, 0.0f}, {0.0f, 2.0f, 0.0f});
}

Material matte(const vec3& color) {
  Material m;
  m.diffuse = vec4(color, 1.0f);
  return m;
}

Material glowing(const vec3& color) {
  Material m = matte(vec3(0.0f));
  m.emission = color;
  return m;
}

Material see_through(float alpha) {
  Material m = glowing(kRed);
  m.diffuse.w = alpha;
  m.alpha_mode = AlphaMode::blend;
  return m;
}

Material optical(float reflectivity, float ior, float opacity) {
  Material m = matte(vec3(0.0f));
  m.optical = {reflectivity, ior, opacity};
  return m;
}

class Visibility : public ::testing::TestWithParam<Primary> {
 protected:
  SceneMaker maker_;

  Visibility() {
    maker_.scene->settings.primary = GetParam();
    maker_.scene->world.color = kWorld;
  }

  Object& add(const std::string& name, std::shared_ptr<const Mesh> mesh, const Material& material) {
    maker_.object(name, std::move(mesh), maker_.material(material));
    return maker_.scene->objects.back();
  }
  void add_holdout(std::shared_ptr<const Mesh> mesh) {
    add("holdout", std::move(mesh), matte(vec3(0.5f))).holdout = true;
    maker_.scene->has_holdouts = true;
  }

  void render() {
    static const auto device = std::make_shared<Device>();
    renderer_ = std::make_unique<Renderer>(device);
    renderer_->render_frame(maker_.scene, kSize, kSize, {});
  }
  /// Combined at the pixel around a place of the floor, metres.
  vec4 seen(float x, float y = 0.1f) {
    const std::vector<float> p = renderer_->film().pass("Combined");
    const float* c = &p[4 * pixel(x, y)];
    return {c[0], c[1], c[2], c[3]};
  }
  float value(const char* pass, float x, float y = 0.1f) {
    return renderer_->film().pass(pass)[pixel(x, y)];
  }
  void expect(float x, const vec4& rgba) {
    const vec4 actual = seen(x);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(actual[c], rgba[c], 1e-3f) << "channel " << c;
  }

 private:
  static size_t pixel(float x, float y) {
    const auto along = [](float at) { return static_cast<size_t>((at + 1.0f) * kSize / 2.0f); };
    return along(y) * kSize + along(x);
  }
  std::unique_ptr<Renderer> renderer_;
};

INSTANTIATE_TEST_SUITE_P(Primaries, Visibility, ::testing::Values(Primary::rays, Primary::raster),
                         [](const auto& param) {
                           return param.param == Primary::rays ? "rays" : "raster";
                         });

TEST_P(Visibility, CameraAndShadow) {
  const float lit = std::sqrt(0.5f);
  add("floor", sheet(-4, 4, 0), matte(vec3(1.0f)));
  add("card", sheet(-1, 0, 1), matte(kRed));
  maker_.light(LightType::directional, vec3(1.0f), {1.0f, 0.0f, -1.0f});  // shadow at 0 < x < 1
  render();
  expect(-0.5f, {lit, 0, 0, 1});
  expect(0.5f, {0, 0, 0, 1});

  maker_.scene->objects[1].hidden_from = kCameraRays;
  render();
  expect(-0.5f, {lit, lit, lit, 1});
  expect(0.5f, {0, 0, 0, 1});

  maker_.scene->objects[1].hidden_from = kShadowRays;
  render();
  expect(-0.5f, {lit, 0, 0, 1});
  expect(0.5f, {lit, lit, lit, 1});
}

TEST_P(Visibility, Reflection) {
  add("mirror", sheet(-1, 1, 0), optical(1.0f, 1.0f, 1.0f));
  Object& lamp = add("lamp", sheet(-1, 1, 20), glowing(kRed));  // behind the camera
  lamp.hidden_from = kCameraRays | kShadowRays | kRefractionRays;
  render();
  expect(0.0f, {kRed, 1});
  lamp.hidden_from = kReflectionRays;
  render();
  expect(0.0f, {kWorld, 1});
}

TEST_P(Visibility, Refraction) {
  add("glass", sheet(-1, 1, 0), optical(0.0f, 1.5f, 0.0f));
  Object& lamp = add("lamp", sheet(-1, 1, -1), glowing(kRed));
  lamp.hidden_from = kCameraRays | kShadowRays | kReflectionRays;
  render();
  expect(0.0f, {kRed, 1});
  lamp.hidden_from = kRefractionRays;
  render();
  expect(0.0f, {kWorld, 1});
}

TEST_P(Visibility, StraightThroughAlphaTheCameraStillLooks) {
  add("veil", sheet(-1, 1, 0), see_through(0.0f));
  Object& lamp = add("lamp", sheet(-1, 1, -1), glowing(kRed));
  lamp.hidden_from = kRefractionRays;
  render();
  expect(0.0f, {kRed, 1});
  lamp.hidden_from = kCameraRays;
  render();
  expect(0.0f, {kWorld, 1});
}

TEST_P(Visibility, OneOfTwoInstances) {
  add("left", sheet(-1, 0, 0), glowing(kRed)).hidden_from = kCameraRays;
  Object right = maker_.scene->objects.back();
  right.name = "right";
  right.hidden_from = 0;
  right.world_from_object = test::placed({1, 0, 0});
  maker_.scene->objects.push_back(right);
  render();
  expect(-0.5f, {kWorld, 1});
  expect(0.5f, {kRed, 1});
}

TEST_P(Visibility, UnseenObjectsHaveNoArea) {
  add("floor", sheet(-4, 4, 0), matte(vec3(1.0f)));
  add("card", sheet(-1, 0, 1), matte(kRed)).hidden_from = kCameraRays;
  maker_.scene->settings.validate_areas = true;
  render();
  for (const float x : {-0.5f, 0.5f}) EXPECT_EQ(value("ObjectId", x), 1.0f);
}

TEST_P(Visibility, HoldoutIsAHole) {
  add_holdout(sheet(-1, 0, 1));
  add("floor", sheet(-4, 4, 0), matte(vec3(1.0f)));
  maker_.light(LightType::directional, vec3(1.0f), {1.0f, 0.0f, -1.0f});
  render();
  expect(-0.5f, vec4(0.0f));
  EXPECT_EQ(value("Depth", -0.5f), 1e10f);
  EXPECT_EQ(value("ObjectId", -0.5f), 0.0f);
  expect(0.5f, {0, 0, 0, 1});  // it casts its shadow
}

TEST_P(Visibility, HoldoutShowsInMirrors) {
  add("mirror", sheet(-1, 1, 0), optical(1.0f, 1.0f, 1.0f));
  add_holdout(sheet(-1, 1, 20));
  maker_.scene->settings.ambient = vec3(1.0f);
  maker_.scene->materials.back().ambient = vec3(0.5f);
  render();
  expect(0.0f, {0.5f, 0.5f, 0.5f, 1});
}

TEST_P(Visibility, HoldoutBehindAlpha) {
  add("veil", sheet(-1, 1, 1), see_through(0.25f));
  add_holdout(sheet(-1, 0, 0));
  render();
  expect(-0.5f, {0.25f, 0, 0, 0.25f});
  expect(0.5f, {0.25f * kRed + 0.75f * kWorld, 1});
}

TEST_P(Visibility, TransparentFilm) {
  maker_.scene->settings.film_transparent = true;
  add("solid", sheet(-1.0f, -0.5f, 0), glowing(kRed));
  add("veil", sheet(-0.5f, 0.0f, 0), see_through(0.25f));
  add("glass", sheet(0.0f, 0.5f, 0), optical(0.0f, 1.5f, 0.0f));
  render();
  expect(-0.75f, {kRed, 1});
  expect(-0.25f, {0.25f, 0, 0, 0.25f});
  expect(0.25f, {kWorld, 1});  // as Cycles does without Transparent Glass
  expect(0.75f, vec4(0.0f));
}

TEST_P(Visibility, EdgesOnATransparentFilmArePremultiplied) {
  maker_.scene->settings.film_transparent = true;
  maker_.scene->settings.pixel_filter = PixelFilter::box;
  maker_.scene->settings.filter_width = 1.0f;
  maker_.scene->settings.samples = 64;
  const float pixel = 2.0f / kSize;
  add("half", sheet(-1.0f, 0.25f * pixel, 0), glowing(kRed));
  render();
  const vec4 edge = seen(0.5f * pixel);
  EXPECT_NEAR(edge.w, 0.25f, 1.0f / 64.0f);
  EXPECT_EQ(edge.x, edge.w);
  EXPECT_EQ(edge.z, 0.0f);
}

TEST_P(Visibility, MirrorsShowTheWorldOnATransparentFilm) {
  maker_.scene->settings.film_transparent = true;
  add("mirror", sheet(-1, 1, 0), optical(1.0f, 1.0f, 1.0f));
  render();
  expect(0.0f, {kWorld, 1});
}

}  // namespace
}  // namespace kestrel
