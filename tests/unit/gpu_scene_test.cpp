// SPDX-License-Identifier: GPL-3.0-or-later
// What the rasteriser prepares on the processor: vertex streams, normal matrices, texels, culling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "raster_fixture.h"
#include "scene/gpu_mesh.h"
#include "scene/gpu_scene.h"
#include "scene/gpu_texture.h"
#include "stages/raster_view.h"

namespace kestrel {
namespace {

TEST(ExpandMesh, GroupsTrianglesBySlotInTheirOrder) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}};
  mesh.corner_uvs = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {7, 0}, {8, 0}};
  mesh.triangle_materials = {4, 1, 4};
  const VertexStreams streams = expand_mesh(mesh);
  ASSERT_EQ(streams.ranges.size(), 2u);
  EXPECT_EQ(streams.ranges[0].slot, 1u);
  EXPECT_EQ(streams.ranges[0].first_vertex, 0);
  EXPECT_EQ(streams.ranges[0].vertex_count, 3);
  EXPECT_EQ(streams.ranges[1].slot, 4u);
  EXPECT_EQ(streams.ranges[1].first_vertex, 3);
  EXPECT_EQ(streams.ranges[1].vertex_count, 6);
  const float expected[] = {3, 4, 5, 0, 1, 2, 6, 7, 8};
  for (size_t i = 0; i < 9; ++i) EXPECT_EQ(streams.uvs[i].x, expected[i]);
  EXPECT_EQ(streams.positions[2], vec3(0, 0, 1));
  EXPECT_VEC_NEAR(streams.face_normals[3], vec3(0, 0, 1), 0);
  EXPECT_VEC_NEAR(streams.face_normals[6], glm::normalize(vec3(1, 1, 1)), 1e-7);
  EXPECT_EQ(streams.bounds.lower, vec3(0.0f));
  EXPECT_EQ(streams.bounds.upper, vec3(1.0f));
}

TEST(NormalMatrix, IsTheInverseTransposeUpToAPositiveFactor) {
  std::mt19937 random(3);
  std::normal_distribution<float> gauss;
  for (const float size : {1e-12f, 1.0f, 1e9f}) {
    for (int k = 0; k < 50; ++k) {
      mat4x3 m;
      for (int i = 0; i < 3; ++i) m[i] = size * vec3(gauss(random), gauss(random), gauss(random));
      const glm::dmat3 expected = glm::transpose(glm::inverse(glm::dmat3(mat3(m))));
      const mat3 actual = normal_matrix(m);
      const vec3 n = glm::normalize(vec3(gauss(random), gauss(random), gauss(random)));
      EXPECT_VEC_NEAR(glm::normalize(actual * n), vec3(glm::normalize(expected * glm::dvec3(n))),
                      2e-6);
    }
  }
}

TEST(FrustumCulling, NeverDropsABoxThatHoldsAVisiblePoint) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  const auto random_vec = [&] { return vec3(unit(random), unit(random), unit(random)); };
  int dropped = 0, kept_for_a_reason = 0;
  for (int k = 0; k < 20000; ++k) {
    Scene scene;
    Camera& camera = scene.camera;
    camera.projection = k % 2 ? Projection::perspective : Projection::orthographic;
    const vec3 back = glm::normalize(random_vec());
    const vec3 right = glm::normalize(glm::cross(random_vec(), back));
    camera.world_from_camera = mat4x3(right, glm::cross(back, right), back, 5.0f * random_vec());
    camera.left = unit(random);
    camera.right = camera.left + 0.1f + std::abs(unit(random));
    camera.bottom = unit(random);
    camera.top = camera.bottom + 0.1f + std::abs(unit(random));
    camera.near_clip = 0.5f;
    camera.far_clip = 12.0f;
    const glm::dmat4 view = clip_from_world(scene, {scene, 100, 60, vec2(0.4f, -0.3f)});
    Bounds box;
    box.extend(6.0f * random_vec());
    box.extend(box.lower + 3.0f * random_vec());
    const bool kept = may_be_visible(box, view);
    dropped += !kept;
    for (int s = 0; s < 20; ++s) {
      const vec3 share = 0.5f * random_vec() + 0.5f;
      const vec3 p = glm::mix(box.lower, box.upper, share);
      const glm::dvec4 c = view * glm::dvec4(p, 1.0);
      const bool seen = std::abs(c.x) <= c.w && std::abs(c.y) <= c.w && c.z >= 0 && c.z <= c.w;
      kept_for_a_reason += seen;
      ASSERT_TRUE(kept || !seen) << "box " << k;
    }
  }
  EXPECT_GT(dropped, 5000);
  EXPECT_GT(kept_for_a_reason, 2000);
}

Texture gray_texture(int width, int height, bool srgb, uint8_t (*texel)(int x, int y)) {
  Texture t{"texture", width, height, srgb};
  t.texels8.resize(4 * static_cast<size_t>(width * height), 255);
  for (int i = 0; i < width * height; ++i) {
    std::fill_n(&t.texels8[4 * static_cast<size_t>(i)], 3, texel(i % width, i / width));
  }
  return t;
}

TEST(FitTexture, LeavesWhatFits) {
  const Texture t = gray_texture(4, 3, true, [](int x, int y) { return uint8_t(10 * x + y); });
  const Texture fitted = fit_texture(t, 4);
  EXPECT_EQ(fitted.width, 4);
  EXPECT_EQ(fitted.height, 3);
  EXPECT_EQ(fitted.texels8, t.texels8);
}

TEST(FitTexture, AveragesBlocksAndKeepsTheProportions) {
  const Texture t =
      gray_texture(8, 4, false, [](int x, int) { return uint8_t(x < 4 ? 100 : 20 * x); });
  const Texture fitted = fit_texture(t, 4);
  ASSERT_EQ(fitted.width, 4);
  ASSERT_EQ(fitted.height, 2);
  // Columns of the left half are 100; then 80 and 100, 120 and 140 in pairs.
  const int expected[] = {100, 100, 90, 130};
  for (size_t i = 0; i < 8; ++i) EXPECT_EQ(fitted.texels8[4 * i], expected[i % 4]) << i;
  EXPECT_EQ(fitted.texels8[3], 255);
}

TEST(FitTexture, AveragesSrgbAsLight) {
  // Half black, half white: half the light is 188 in sRGB, not 128.
  const Texture t = gray_texture(2, 2, true, [](int x, int) { return uint8_t(255 * x); });
  EXPECT_EQ(fit_texture(t, 1).texels8, (std::vector<uint8_t>{188, 188, 188, 255}));
}

TEST(FitTexture, ThinImagesKeepOneRow) {
  const Texture t = gray_texture(1000, 1, false, [](int, int) { return uint8_t(7); });
  const Texture fitted = fit_texture(t, 10);
  EXPECT_EQ(fitted.width, 10);
  EXPECT_EQ(fitted.height, 1);
  EXPECT_EQ(fitted.texels8[4 * 9], 7);
}

TEST(FitTexture, FloatTexelsStayFloat) {
  Texture t{"hdr", 2, 1};
  t.texels_float = {1000, 0, 0, 1, 3000, 0, 2, 0};
  EXPECT_EQ(fit_texture(t, 1).texels_float, (std::vector<float>{2000, 0, 1, 0.5f}));
}

TEST(TextureFormat, LosesNothing) {
  Texture t{"texture", 1, 1, true};
  t.texels8 = {1, 2, 3, 4};
  EXPECT_EQ(texture_format(t), static_cast<GLenum>(GL_SRGB8_ALPHA8));
  t.srgb = false;
  EXPECT_EQ(texture_format(t), static_cast<GLenum>(GL_RGBA8));
  t.texels8.clear();
  t.texels_float = {0.5f, 1.0f / 1024, -3.25f, 60000.0f};  // halves
  EXPECT_EQ(texture_format(t), static_cast<GLenum>(GL_RGBA16F));
  t.texels_float[3] = 1e6f;  // beyond half's range
  EXPECT_EQ(texture_format(t), static_cast<GLenum>(GL_RGBA32F));
  t.texels_float[3] = 0.1f;  // no half
  EXPECT_EQ(texture_format(t), static_cast<GLenum>(GL_RGBA32F));
}

}  // namespace
}  // namespace kestrel
