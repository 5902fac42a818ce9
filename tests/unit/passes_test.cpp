// SPDX-License-Identifier: GPL-3.0-or-later
// Passes for compositing: mist, indices, UVs, normals and Cryptomatte of scenes with known answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "raster_fixture.h"
#include "renderer.h"
#include "tracers/embree/primary_rays.h"

namespace kestrel {
namespace {

using test::placed;
using test::quad_mesh;
using test::SceneMaker;
using test::sphere_mesh;

constexpr int kSize = 16;

/// A frame of 16 x 16 pixels by primary rays.
struct Frame {
  std::unique_ptr<Renderer> renderer;

  Frame(const SceneMaker& maker, const std::vector<std::string>& passes) {
    static const auto device = std::make_shared<Device>();
    renderer = std::make_unique<Renderer>(device);
    renderer->set_passes(passes);
    renderer->render_frame(maker.scene, kSize, kSize, {});
  }
  /// The channels of a pixel.
  std::vector<float> at(const char* pass, int x, int y) const {
    const std::vector<float> values = renderer->film().pass(pass);
    const size_t channels = values.size() / (kSize * kSize);
    const auto first = values.begin() + static_cast<ptrdiff_t>(channels * (y * kSize + x));
    return {first, first + static_cast<ptrdiff_t>(channels)};
  }
  /// What a pixel lists of a kind of Cryptomatte: weight by id.
  std::map<float, float> mattes(const std::string& layer, int x, int y) const {
    std::map<float, float> found;
    for (const char* depth : {"00", "01", "02"}) {
      const std::vector<float> slots = at((layer + depth).c_str(), x, y);
      for (const size_t i : {0, 2}) {
        if (slots[i] != 0.0f) found[slots[i]] = slots[i + 1];
      }
    }
    return found;
  }
};

using Values = std::vector<float>;

TEST(Passes, MistRisesWithTheDistance) {
  SceneMaker s;  // the camera looks down from z = 10
  s.scene->world.mist = {4.0f, 12.0f, 2.0f};
  s.object("floor", quad_mesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), 0);
  const Frame half(s, {"Mist"});
  EXPECT_NEAR(half.at("Mist", 3, 8)[0], 0.25f, 1e-5f);  // half way, squared
  EXPECT_EQ(half.at("Mist", 12, 8), Values{1.0f});      // nothing
  s.scene->world.mist = {15.0f, 12.0f, 1.0f};
  EXPECT_EQ(Frame(s, {"Mist"}).at("Mist", 3, 8), Values{0.0f});
  s.scene->world.mist.depth = 0.0f;
  EXPECT_EQ(Frame(s, {"Mist"}).at("Mist", 3, 8), Values{0.0f});
}

TEST(Passes, MistOfPerspectiveViewsGoesByTheDistanceFromTheCamera) {
  SceneMaker s = test::perspective_scene();
  s.scene->world.mist = {0.0f, 100.0f, 1.0f};
  s.object("floor", quad_mesh({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}), 0);
  const float along = 1.0f / 16.0f * 15.0f;  // pixel (15, 8): the window reaches from -1 to 1
  const float off = 1.0f / 16.0f;
  const float distance = 10.0f * std::sqrt(1.0f + along * along + off * off);
  EXPECT_NEAR(Frame(s, {"Mist"}).at("Mist", 15, 8)[0], distance / 100.0f, 1e-5f);
}

TEST(Passes, IndicesAreTheHosts) {
  SceneMaker s;
  Material m;
  m.pass_index = 41;
  s.object("floor", quad_mesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), s.material(m));
  s.scene->objects[0].pass_index = 30000;
  const Frame f(s, {"ObjectIndex", "MaterialIndex"});
  EXPECT_EQ(f.at("ObjectIndex", 3, 8), Values{30000.0f});
  EXPECT_EQ(f.at("MaterialIndex", 3, 8), Values{41.0f});
  EXPECT_EQ(f.at("ObjectIndex", 12, 8), Values{0.0f});
  EXPECT_EQ(f.at("MaterialIndex", 12, 8), Values{0.0f});
}

TEST(Passes, UvIsTheMeshsOwn) {
  SceneMaker s;
  Material m;
  m.tiling = vec2(7.0f);  // of the material's textures alone
  s.object("mapped", quad_mesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), s.material(m));
  const auto bare = quad_mesh({0, -1, 0}, {0.5f, 0, 0}, {0, 2, 0});
  bare->corner_uvs.clear();
  s.object("bare", bare, 0);
  const Frame f(s, {"UV"});
  const Values uv = f.at("UV", 2, 3);  // the centre of pixel 2 of 8, 3 of 16
  EXPECT_NEAR(uv[0], 2.5f / 8.0f, 1e-5f);
  EXPECT_NEAR(uv[1], 3.5f / 16.0f, 1e-5f);
  EXPECT_EQ(uv[2], 1.0f);
  EXPECT_EQ(f.at("UV", 9, 8), (Values{0.0f, 0.0f, 0.0f}));
  EXPECT_EQ(f.at("UV", 14, 8), (Values{0.0f, 0.0f, 0.0f}));
}

TEST(Passes, NormalsFaceTheViewer) {
  SceneMaker s;
  s.object("front", quad_mesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), 0);
  s.object("back", quad_mesh({0, -1, 0}, {0, 2, 0}, {1, 0, 0}), 0);  // its own normal is -Z
  const Frame f(s, {"Normal", "DenoisingNormal"});
  for (const int x : {3, 12}) {
    EXPECT_EQ(f.at("Normal", x, 8), (Values{0.0f, 0.0f, 1.0f}));
    EXPECT_EQ(f.at("DenoisingNormal", x, 8), (Values{0.0f, 0.0f, -1.0f}));
  }
}

TEST(Passes, DenoisingAlbedoOfMirrorsAndGlassIsTheirTint) {
  SceneMaker s;
  Material m;
  m.diffuse = {0.0f, 0.0f, 0.0f, 1.0f};
  m.optical = {1.0f, 1.0f, 1.0f};
  m.reflection_color = {0.9f, 0.6f, 0.3f};
  s.object("mirror", quad_mesh({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), s.material(m));
  m.optical = {0.0f, 1.5f, 0.0f};
  m.transmission_color = {0.2f, 0.4f, 5.0f};
  s.object("glass", quad_mesh({0, -1, 0}, {1, 0, 0}, {0, 2, 0}), s.material(m));
  const Frame f(s, {"DenoisingAlbedo"});
  EXPECT_EQ(f.at("DenoisingAlbedo", 3, 8), (Values{0.9f, 0.6f, 0.3f}));
  EXPECT_EQ(f.at("DenoisingAlbedo", 12, 8), (Values{0.2f, 0.4f, 1.0f}));
}

TEST(Cryptomatte, HashesAreMurmurHash3) {
  // Published test vectors, seed 0.
  EXPECT_EQ(murmur_hash3(""), 0u);
  EXPECT_EQ(murmur_hash3("test"), 0xba6bd213u);
  EXPECT_EQ(murmur_hash3("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(murmur_hash3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, IdsAreOrdinaryNumbers) {
  EXPECT_EQ(std::bit_cast<uint32_t>(matte_id("test")), 0xba6bd213u);
  EXPECT_EQ(std::bit_cast<uint32_t>(matte_id("")), 1u << 23);  // hash 0 would mean nothing
  int changed = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string name = "object " + std::to_string(i);
    EXPECT_TRUE(std::isnormal(matte_id(name))) << name;
    changed += std::bit_cast<uint32_t>(matte_id(name)) != murmur_hash3(name);
  }
  EXPECT_GT(changed, 80);  // 2 of 256 exponents
  EXPECT_LT(changed, 240);
}

TEST(Cryptomatte, PixelsListWhatCoversThem) {
  SceneMaker s;  // pixels are 1/8 m wide
  s.scene->settings.samples = 64;
  s.scene->settings.pixel_filter = PixelFilter::box;
  s.scene->settings.filter_width = 1.0f;
  const float edge = 0.25f / 8.0f;  // a quarter into pixel 8
  s.object("left", quad_mesh({-1, -1, 0}, {1 + edge, 0, 0}, {0, 1, 0}), 0);
  s.object("right", quad_mesh({edge, -1, 0}, {1 - edge, 0, 0}, {0, 1, 0}), 0);
  s.scene->objects[0].asset = s.scene->objects[1].asset = "wall";
  const Frame f(s, {"CryptoObject02", "CryptoAsset02"});
  const auto both = f.mattes("CryptoObject", 8, 3);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_NEAR(both.at(matte_id("left")), 0.25f, 0.03f);
  EXPECT_NEAR(both.at(matte_id("right")), 0.75f, 0.03f);
  EXPECT_EQ(f.at("CryptoObject00", 8, 3)[0], matte_id("right"));  // the largest first
  EXPECT_EQ(f.mattes("CryptoObject", 3, 3), (std::map<float, float>{{matte_id("left"), 1.0f}}));
  EXPECT_EQ(f.mattes("CryptoAsset", 8, 3), (std::map<float, float>{{matte_id("wall"), 1.0f}}));
  EXPECT_TRUE(f.mattes("CryptoObject", 8, 12).empty());
  const auto manifest = nlohmann::json::parse(*f.renderer->film().manifest(MatteKind::object));
  EXPECT_EQ(manifest.size(), 2u);
  EXPECT_EQ(manifest["left"], fmt::format("{:08x}", std::bit_cast<uint32_t>(matte_id("left"))));
  EXPECT_EQ(f.renderer->film().manifest(MatteKind::material), nullptr);
}

TEST(Passes, WhatShowsThroughAVeilCountsByItsShare) {
  // From the camera at z = 10: a veil of alpha 0.75 at 2, a clear pane of 0.5 at 1, the floor at 0.
  SceneMaker s;
  Material veil, pane;
  veil.diffuse.w = 0.75f;
  veil.alpha_mode = AlphaMode::blend;
  veil.optical.y = s.scene->settings.environment_ior;
  pane.optical = {0.0f, s.scene->settings.environment_ior, 0.5f};
  s.object("floor", quad_mesh({-1, -1, 0}, {2, 0, 0}, {0, 1, 0}), 0);
  s.object("pane", quad_mesh({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}), s.material(pane));
  s.object("veil", quad_mesh({-1, -1, 2}, {1, 0, 0}, {0, 2, 0}), s.material(veil));
  s.scene->world.mist = {0.0f, 20.0f, 1.0f};
  const Frame f(s, {"CryptoObject02", "Mist"});
  const auto expect = [&](int x, int y, const std::map<std::string, float>& shares, float mist) {
    const auto found = f.mattes("CryptoObject", x, y);
    EXPECT_EQ(found.size(), shares.size()) << x << ", " << y;
    for (const auto& [name, share] : shares) {
      ASSERT_TRUE(found.contains(matte_id(name))) << name;
      EXPECT_NEAR(found.at(matte_id(name)), share, 1e-5f) << name;
    }
    EXPECT_NEAR(f.at("Mist", x, y)[0], mist, 1e-5f) << x << ", " << y;
  };
  expect(3, 3, {{"veil", 0.75f}, {"pane", 0.125f}, {"floor", 0.125f}},
         0.75f * 0.4f + 0.125f * 0.45f + 0.125f * 0.5f);
  expect(3, 12, {{"veil", 0.75f}, {"pane", 0.125f}}, 0.75f * 0.4f + 0.125f * 0.45f + 0.125f);
  expect(12, 3, {{"pane", 0.5f}, {"floor", 0.5f}}, 0.5f * 0.45f + 0.5f * 0.5f);
}

TEST(Cryptomatte, MoreThanItsSlotsIsLeftOut) {
  std::vector<float> plane(4, 0.0f);
  const MatteSlots slots({plane.data()});
  slots.add(0, 5.0f, 1.0f);
  slots.add(0, 6.0f, 1.0f);
  slots.add(0, 7.0f, 1.0f);
  slots.add(0, 6.0f, 1.0f);
  slots.finish(0, 0.25f);
  EXPECT_EQ(plane, (Values{6.0f, 0.5f, 5.0f, 0.25f}));
}

TEST(Passes, AllLeavesOutWhatFewWant) {
  SceneMaker s;
  const Renderer renderer(std::make_shared<Device>());
  Frame f(s, {"Combined"});
  EXPECT_FALSE(f.renderer->film().has("UV"));
  EXPECT_FALSE(f.renderer->film().has("CryptoObject00"));
  const auto depth_of = [](const char* name) {
    const auto& table = pass_table();
    const auto found = std::find_if(table.begin(), table.end(), [&](const auto& pass) {
      return !std::strcmp(pass.name, name);
    });
    return in_all(*found);
  };
  EXPECT_TRUE(depth_of("CryptoAsset02"));
  EXPECT_FALSE(depth_of("CryptoAsset03"));
}

class RasterPassesTest : public test::RasterTest {};

TEST_F(RasterPassesTest, UvsAreThoseOfPrimaryRays) {
  SceneMaker s = test::perspective_scene();
  const auto ball = sphere_mesh(32, 16);
  for (const uvec3& t : ball->triangles) {
    for (int c = 0; c < 3; ++c) ball->corner_uvs.emplace_back(ball->positions[t[c]]);
  }
  s.object("ball", ball, 0, placed({0, 0, 0}, 6.0f));
  FrameInputs inputs{*s.scene, 64, 64};
  inputs.keep_uv = true;
  stage_->update(s.scene);
  GBuffer rastered, traced;
  stage_->run(inputs, rastered);
  const Device device;
  RtScene rt(device.embree());
  rt.update(s.scene);
  PrimaryRays(rt).run(inputs, traced);
  int compared = 0;
  for (size_t i = 0; i < traced.object.size(); ++i) {
    if (traced.object[i] == 0 || rastered.object[i] == 0) continue;
    EXPECT_VEC_NEAR(rastered.uv[i], traced.uv[i], 2e-3f);
    ++compared;
  }
  EXPECT_GT(compared, 500);
  inputs.keep_uv = false;
  stage_->run(inputs, rastered);
  PrimaryRays(rt).run(inputs, traced);
  EXPECT_TRUE(rastered.uv.empty());
  EXPECT_TRUE(traced.uv.empty());
}

}  // namespace
}  // namespace kestrel
