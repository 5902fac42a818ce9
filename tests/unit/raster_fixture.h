// SPDX-License-Identifier: GPL-3.0-or-later
// Rasterising small scenes in tests: one OpenGL context a program.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>

#include "base/error.h"
#include "gl/context.h"
#include "scenes.h"
#include "stages/raster.h"

namespace kestrel::test {

/// Rasterises scenes. Where the machine has no OpenGL every test is skipped, saying why.
class RasterTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    try {
      context_ = std::make_shared<gl::Context>();
    } catch (const Error& error) {
      why_not_ = error.what();
    }
  }
  static void TearDownTestSuite() { context_.reset(); }

  void SetUp() override {
    if (!context_) GTEST_SKIP() << "No OpenGL here: " << why_not_;
    stage_ = std::make_unique<RasterStage>(context_);
  }
  void TearDown() override { stage_.reset(); }

  GBuffer render(const SceneMaker& maker, int width, int height, const vec2& subpixel = vec2(0)) {
    stage_->update(maker.scene);
    GBuffer out;
    stage_->run({*maker.scene, width, height, subpixel}, out);
    return out;
  }

  inline static std::shared_ptr<gl::Context> context_;
  inline static std::string why_not_;
  std::unique_ptr<RasterStage> stage_;
};

/// Index of a pixel, row 0 at the bottom.
inline size_t at(const GBuffer& g, int x, int y) {
  return static_cast<size_t>(y) * static_cast<size_t>(g.width) + static_cast<size_t>(x);
}

/// A scene seen by a perspective camera at (0, 0, 10) that looks down the -Z axis with a right
/// angle of view: the plane z = 0 shows from -10 to 10.
inline SceneMaker perspective_scene() {
  SceneMaker maker;
  maker.scene->camera.projection = Projection::perspective;
  return maker;
}

/// A rectangle in the plane z, facing +Z.
inline std::shared_ptr<Mesh> rectangle(float x0, float y0, float x1, float y1, float z = 0.0f) {
  return quad_mesh(vec3(x0, y0, z), vec3(x1 - x0, 0, 0), vec3(0, y1 - y0, 0));
}

#define EXPECT_VEC_NEAR(actual, expected, tolerance)                             \
  do {                                                                           \
    const auto actual_value = (actual);                                          \
    const decltype(actual_value) expected_value = (expected);                    \
    for (int component = 0; component < actual_value.length(); ++component) {    \
      EXPECT_NEAR(actual_value[component], expected_value[component], tolerance) \
          << #actual << ", component " << component;                             \
    }                                                                            \
  } while (false)

}  // namespace kestrel::test
