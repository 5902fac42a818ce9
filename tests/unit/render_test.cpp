// SPDX-License-Identifier: GPL-3.0-or-later
// Whole frames of small scenes with known answers, found by rays: no OpenGL is needed.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "base/error.h"
#include "renderer.h"
#include "scenes.h"

namespace kestrel {
namespace {

using test::placed;
using test::quad_mesh;
using test::SceneMaker;
using test::sphere_mesh;

constexpr int kSize = 16;

const auto kFloor = [] { return quad_mesh({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}); };

Material matte(const vec3& color) {
  Material m;
  m.diffuse = vec4(color, 1.0f);
  return m;
}

struct Picture {
  std::unique_ptr<Renderer> renderer;

  explicit Picture(const SceneMaker& maker, int width = kSize, int height = kSize) {
    static const auto device = std::make_shared<Device>();
    renderer = std::make_unique<Renderer>(device);
    renderer->render_frame(maker.scene, width, height, {});
  }
  vec3 at(int x, int y, const char* pass = "Combined") const {
    const Film& film = renderer->film();
    const std::vector<float> p = film.pass(pass);
    const size_t channels = p.size() / (static_cast<size_t>(film.width()) * film.height());
    const float* c = &p[channels * (static_cast<size_t>(y) * film.width() + x)];
    return channels >= 3 ? vec3(c[0], c[1], c[2]) : vec3(c[0]);
  }
  nlohmann::json stats() const { return nlohmann::json::parse(renderer->stats_json()); }
};

void expect_near(const vec3& a, const vec3& b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Render, DirectionalLightOnMatteFloor) {
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte({0.5f, 0.4f, 0.2f})));
  s.light(LightType::directional, vec3(2.0f), {1.0f, 0.0f, -1.0f});  // 45 degrees
  const float cosine = std::sqrt(0.5f);
  expect_near(Picture(s).at(8, 8), vec3(0.5f, 0.4f, 0.2f) * 2.0f * cosine, 1e-5f);
}

TEST(Render, PointLightFallsOffWithTheSquare) {
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte(vec3(1.0f))));
  s.light(LightType::point, vec3(8.0f), {0.0f, 0.0f, 2.0f});
  // Pixel (8, 8) of 16 over 2 m has its centre at x = y = 0.0625.
  const vec3 to_light = vec3(0, 0, 2) - vec3(0.0625f, 0.0625f, 0.0f);
  const float d2 = glm::dot(to_light, to_light);
  expect_near(Picture(s).at(8, 8), vec3(8.0f / d2 * to_light.z / std::sqrt(d2)), 1e-5f);
}

TEST(Render, SpotLightsOnlyItsCone) {
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte(vec3(1.0f))));
  Light& spot = s.light(LightType::spot, vec3(4.0f), {0.0f, 0.0f, 2.0f});
  spot.direction = {0.0f, 0.0f, -1.0f};
  spot.cos_outer = std::cos(std::atan(0.25f));  // radius 0.5 m on the floor
  const Picture p(s);
  EXPECT_GT(p.at(8, 8).x, 0.9f);
  EXPECT_EQ(p.at(14, 8).x, 0.0f);
}

TEST(Render, OpaqueBlockerShadowsItsSideOnly) {
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte(vec3(0.5f))));
  s.object("blocker", quad_mesh({-4, -4, 20}, {4, 0, 0}, {0, 8, 0}), 0);  // above the camera, x < 0
  s.light(LightType::directional, vec3(3.0f), {0.0f, 0.0f, -1.0f});
  const Picture p(s);
  expect_near(p.at(3, 8), vec3(0.0f), 1e-6f);
  expect_near(p.at(12, 8), vec3(1.5f), 1e-6f);
  expect_near(p.at(3, 8, "Shadow"), vec3(1.0f - 1.5f), 1e-6f);  // S is not clamped
  expect_near(p.at(3, 8, "Lighting"), vec3(1.5f), 1e-6f);
}

TEST(Render, InstancesAndMovedObjectsAreWhereTheyAre) {
  // Two objects share a mesh, a third has its own and moves; emission tells them apart.
  SceneMaker s;
  const auto glowing = [&](const vec3& color) {
    Material m = matte(vec3(0.0f));
    m.emission = color;
    return s.material(m);
  };
  const auto tile = quad_mesh({-0.4f, -0.4f, 0}, {0.8f, 0, 0}, {0, 0.8f, 0});
  const vec3 red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1);
  s.object("red", tile, glowing(red), placed({-0.5f, -0.5f, 0}));
  s.object("green", tile, glowing(green), placed({0.5f, -0.5f, 0}));
  s.scene->objects[1].mesh = s.scene->objects[0].mesh;
  s.object("blue", quad_mesh({-0.4f, -0.4f, 0}, {0.8f, 0, 0}, {0, 0.8f, 0}), glowing(blue),
           placed({-0.5f, 0.5f, 0}));
  Picture p(s);
  expect_near(p.at(4, 4), red, 0.0f);
  expect_near(p.at(12, 4), green, 0.0f);
  expect_near(p.at(4, 12), blue, 0.0f);
  for (const float x : {0.5f, -0.5f, 0.5f}) {
    s.scene = std::make_shared<Scene>(*s.scene);
    s.scene->objects[2].world_from_object = placed({x, 0.5f, 0});
    p.renderer->render_frame(s.scene, kSize, kSize, {});
    expect_near(p.at(x > 0 ? 12 : 4, 12), blue, 0.0f);
    expect_near(p.at(x > 0 ? 4 : 12, 12), vec3(0.0f), 0.0f);
    expect_near(p.at(4, 4), red, 0.0f);
    expect_near(p.at(12, 4), green, 0.0f);
  }
}

TEST(Render, OneMeshMayBeGlassInPart) {
  // Slot 0 blocks the light, slot 1 lets half of it through: each triangle keeps its own.
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte(vec3(1.0f))));
  Material pane = matte(vec3(0.0f));
  pane.optical = {0.0f, 1.0f, 0.5f};
  const auto roof = quad_mesh({-4, -4, 20}, {8, 0, 0}, {0, 8, 0});  // diagonal: x = y
  roof->triangle_materials = {0, 1};
  s.object("roof", roof, s.material(matte(vec3(0.0f))));
  s.scene->objects[1].materials.push_back(s.material(pane));
  s.light(LightType::directional, vec3(1.0f), {0.0f, 0.0f, -1.0f});
  const Picture p(s);
  expect_near(p.at(12, 3), vec3(0.0f), 1e-6f);
  expect_near(p.at(3, 12), vec3(0.5f), 1e-6f);
}

TEST(Render, GlassTintsItsShadow) {
  // Listing 8b: transparency * (1 - diffuse), twice for two panes.
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte(vec3(1.0f))));
  Material pane = matte({0.2f, 0.6f, 1.0f});
  pane.optical = {0.0f, 1.5f, 0.5f};
  const int glass = s.material(pane);
  s.object("pane 1", quad_mesh({-4, -4, 20}, {8, 0, 0}, {0, 8, 0}), glass);
  s.object("pane 2", quad_mesh({-4, -4, 21}, {8, 0, 0}, {0, 8, 0}), glass);
  s.light(LightType::directional, vec3(1.0f), {0.0f, 0.0f, -1.0f});
  const vec3 once = 0.5f * (1.0f - vec3(0.2f, 0.6f, 1.0f));
  expect_near(Picture(s).at(8, 8), once * once, 1e-6f);
}

TEST(Render, MaskedTexelsCastNoShadowAndAreNotSeen) {
  SceneMaker s;
  Texture leaf;
  leaf.width = 2;
  leaf.height = 1;
  leaf.nearest = true;
  leaf.texels8 = {255, 0, 0, 255, 255, 0, 0, 0};  // left half solid, right half empty
  Material m = matte(vec3(1.0f));
  m.diffuse_texture = s.texture(leaf);
  m.alpha_mode = AlphaMode::mask;
  s.object("floor", kFloor(), s.material(matte(vec3(1.0f))));
  s.object("leaf", quad_mesh({-1, -0.5f, 5}, {2, 0, 0}, {0, 1, 0}), s.material(m));
  s.light(LightType::directional, vec3(1.0f), {0.0f, 1.0f, -5.0f});
  s.scene->camera.world_from_camera = placed({0, 0, 4});  // below the leaf: sees only the floor
  const Picture below(s);
  EXPECT_NEAR(below.at(3, 15).x, 0.0f, 1e-6f);  // the shadow lies 1 m towards +Y
  EXPECT_GT(below.at(12, 15).x, 0.9f);
  s.scene->camera.world_from_camera = placed({0, 0, 10});
  const Picture above(s);
  EXPECT_NEAR(above.at(3, 8).y, 0.0f, 1e-6f);  // red leaf
  EXPECT_GT(above.at(12, 8).y, 0.9f);          // white floor through the empty half
}

TEST(Render, MaterialThatCastsNoShadow) {
  SceneMaker s;
  s.object("floor", kFloor(), s.material(matte(vec3(1.0f))));
  Material ghost = matte(vec3(0.0f));
  ghost.casts_shadow = false;
  s.object("ghost", quad_mesh({-4, -4, 20}, {8, 0, 0}, {0, 8, 0}), s.material(ghost));
  s.light(LightType::directional, vec3(1.0f), {0.0f, 0.0f, -1.0f});
  expect_near(Picture(s).at(8, 8), vec3(1.0f), 1e-6f);
}

TEST(Render, MirrorShowsTheRightSide) {
  // A floor mirror at 45 degrees sees along +X; a red wall stands at +X, a blue one at -X.
  SceneMaker s;
  Material mirror = matte(vec3(0.0f));
  mirror.optical.x = 1.0f;
  s.object("mirror", quad_mesh({-1, -1, -1}, {2, 0, 2}, {0, 2, 0}), s.material(mirror));
  Material red = matte(vec3(0.0f)), blue = red;
  red.emission = {0.7f, 0, 0};
  blue.emission = {0, 0, 0.7f};
  s.object("right", quad_mesh({5, -9, -9}, {0, 18, 0}, {0, 0, 18}), s.material(red));
  s.object("left", quad_mesh({-5, -9, -9}, {0, 18, 0}, {0, 0, 18}), s.material(blue));
  expect_near(Picture(s).at(8, 8), vec3(0, 0, 0.7f), 1e-6f);  // rises to +X: faces -X
}

TEST(Render, GlassSlabWithTheIndexOfAirIsInvisible) {
  SceneMaker s;
  Material wall = matte(vec3(0.0f));
  wall.emission = {0.3f, 0.5f, 0.7f};
  s.object("floor", kFloor(), s.material(wall));
  Material glass = matte(vec3(0.0f));
  glass.optical = {0.0f, 1.0f, 0.0f};
  s.object("slab", quad_mesh({-1, -1, 3}, {2, 0, 0.5f}, {0, 2, 0}), s.material(glass));
  expect_near(Picture(s).at(8, 8), {0.3f, 0.5f, 0.7f}, 1e-6f);
}

TEST(Render, GlassBallTurnsThePictureUpsideDown) {
  // Seen along -Z, a ball of 1.5 swaps the two halves of a far wall.
  SceneMaker s;
  Camera& camera = s.scene->camera;
  camera.projection = Projection::perspective;
  camera.left = camera.bottom = -0.05f;
  camera.right = camera.top = 0.05f;
  Material low = matte(vec3(0.0f)), high = low;
  low.emission = {0, 0, 1};
  high.emission = {1, 0, 0};
  s.object("low", quad_mesh({-50, -50, -20}, {100, 0, 0}, {0, 50, 0}), s.material(low));
  s.object("high", quad_mesh({-50, 0, -20}, {100, 0, 0}, {0, 50, 0}), s.material(high));
  Material glass = matte(vec3(0.0f));
  glass.optical = {0.0f, 1.5f, 0.0f};
  s.object("ball", sphere_mesh(), s.material(glass));
  const Picture p(s);
  EXPECT_GT(p.at(8, 12).z, 0.9f);  // upper half of the ball: the lower, blue half of the wall
  EXPECT_GT(p.at(8, 3).x, 0.9f);
}

TEST(Render, FacingMirrorsLoseEnergyGeometrically) {
  // The camera looks down between two mirrors of 0.5; the upper one emits 1 as well, and its own
  // light counts half (1 - O_M). Depth 1 sees (0.5 + 0.5 x next) and so on.
  SceneMaker s;
  Material mirror = matte(vec3(0.0f));
  mirror.optical.x = 0.5f;
  const int lower = s.material(mirror);
  mirror.emission = vec3(1.0f);
  const int upper = s.material(mirror);
  s.object("lower", quad_mesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), lower);
  s.object("upper", quad_mesh({-1, -1, 20}, {2, 0, 0}, {0, 2, 0}), upper);
  s.scene->settings.importance_cutoff = 0.0f;
  for (int depth = 1; depth <= 4; ++depth) {
    s.scene->settings.max_depth = depth;
    // Follow the listing: at the last depth the lighting (1 on the upper, 0 on the lower) stands.
    float seen = depth % 2 == 1 ? 1.0f : 0.0f;
    for (int d = depth - 1; d >= 0; --d) {
      const float own = d % 2 == 1 ? 1.0f : 0.0f;
      seen = 0.5f * seen + 0.5f * own;
    }
    EXPECT_NEAR(Picture(s).at(8, 8).x, seen, 1e-6f) << "depth " << depth;
  }
}

TEST(Render, FurnaceOfMirrorsAndGlassStaysUniform) {
  SceneMaker s;
  s.scene->world.color = vec3(1.0f);
  s.scene->settings.ambient = vec3(1.0f);
  s.scene->settings.importance_cutoff = 0.0f;
  Material both = matte(vec3(1.0f));
  both.ambient = vec3(1.0f);
  both.optical = {0.3f, 1.4f, 0.5f};
  const int m = s.material(both);
  s.object("ball 1", sphere_mesh(32, 16), m, placed({-0.4f, 0, 0}, 0.5f));
  s.object("ball 2", sphere_mesh(32, 16), m, placed({0.5f, 0.2f, 1}, 0.5f));
  const Picture p(s);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) expect_near(p.at(x, y), vec3(1.0f), 2e-5f);
  }
}

TEST(Render, UnselectedObjectsKeepTheRasterisedLook) {
  SceneMaker s;
  Material mirror = matte(vec3(0.4f));
  mirror.optical.x = 1.0f;
  s.object("mirror", kFloor(), s.material(mirror));
  s.object("blocker", quad_mesh({-4, -4, 20}, {8, 0, 0}, {0, 8, 0}), 0);
  s.light(LightType::directional, vec3(1.0f), {0.0f, 0.0f, -1.0f});
  s.scene->settings.selection = SelectionPolicy::none;
  const Picture p(s);
  expect_near(p.at(8, 8), vec3(0.4f), 1e-6f);
  EXPECT_EQ(p.stats()["rays"]["shadow"], 0);
  EXPECT_EQ(p.at(8, 8, "HeuristicMask").x, 0.0f);
}

TEST(Render, WorldFillsTheBackgroundAndEmptyScenes) {
  SceneMaker s;
  s.scene->world.color = {0.1f, 0.2f, 0.3f};
  const Picture p(s);
  expect_near(p.at(0, 0), {0.1f, 0.2f, 0.3f}, 0.0f);
  EXPECT_EQ(p.at(0, 0, "ObjectId").x, 0.0f);
  EXPECT_EQ(p.at(0, 0, "Depth").x, 1e10f);
}

TEST(Render, DepthIsLinearAndReversed) {
  SceneMaker s;
  s.object("floor", kFloor(), 0);
  const Picture p(s);
  EXPECT_NEAR(p.at(8, 8, "Depth").x, 10.0f, 1e-4f);
  EXPECT_NEAR(p.at(8, 8, "ReversedDepth").x, (100.0f - 10.0f) / (100.0f - 0.1f), 1e-6f);
  s.scene->camera.projection = Projection::perspective;
  const Picture q(s);
  EXPECT_NEAR(q.at(8, 8, "Depth").x, 10.0f, 1e-4f);
  EXPECT_NEAR(q.at(8, 8, "ReversedDepth").x, 0.1f * 90.0f / (10.0f * 99.9f), 1e-6f);
}

TEST(Render, OrthographicViewsMayBeginBehindTheCamera) {
  SceneMaker s;
  s.object("floor", kFloor(), 0);
  s.scene->camera.near_clip = -50.0f;
  s.scene->camera.world_from_camera[3] -= vec3(0.0f, 0.0f, 15.0f);  // below the floor
  const Picture p(s);
  EXPECT_EQ(p.at(8, 8, "ObjectId").x, 1.0f);
  EXPECT_NEAR(p.at(8, 8, "Depth").x, -5.0f, 1e-4f);
}

/// Many balls of every kind of material under several lights.
SceneMaker crowd() {
  SceneMaker s;
  Camera& camera = s.scene->camera;
  camera.projection = Projection::perspective;
  camera.left = camera.bottom = -0.6f;
  camera.right = camera.top = 0.6f;
  s.scene->world.color = {0.2f, 0.3f, 0.5f};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  s.object("floor", quad_mesh({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}), s.material(matte(vec3(0.6f))));
  const auto ball = sphere_mesh(32, 16);
  for (int i = 0; i < 30; ++i) {
    Material m = matte({u(random), u(random), u(random)});
    m.specular = vec4(0.3f, 0.3f, 0.3f, u(random));
    m.optical = {i % 3 == 0 ? 0.7f : 0.0f, 1.0f + u(random), i % 3 == 1 ? 0.1f : 1.0f};
    s.object(
        "ball " + std::to_string(i), ball, s.material(m),
        placed({8 * u(random) - 4, 8 * u(random) - 4, 2 * u(random)}, 0.2f + 0.6f * u(random)));
  }
  s.light(LightType::directional, vec3(0.5f), {0.3f, 0.2f, -1.0f});
  s.light(LightType::point, vec3(5.0f), {2.0f, 2.0f, 4.0f});
  return s;
}

TEST(Render, SameBitsWhateverTheNumberOfThreads) {
  SceneMaker s = crowd();
  s.scene->settings.samples = 2;
  std::vector<float> first;
  for (const int threads : {1, 2, 3, 8}) {
    s.scene = std::make_shared<Scene>(*s.scene);
    s.scene->settings.threads = threads;
    const Picture p(s, 97, 61);
    const std::vector<float> pixels = p.renderer->film().pass("Combined");
    if (first.empty()) first = pixels;
    EXPECT_EQ(std::memcmp(first.data(), pixels.data(), first.size() * sizeof(float)), 0)
        << threads << " threads";
  }
}

TEST(Render, AmpleBudgetGivesTheSamePicture) {
  // With a budget the stages see the whole picture at once, without one tile after tile.
  SceneMaker s = crowd();
  const Picture tiles(s, 97, 61);
  s.scene = std::make_shared<Scene>(*s.scene);
  s.scene->settings.budget_ms = 1e9f;
  const Picture whole(s, 97, 61);
  for (const char* pass : {"Combined", "Position", "ObjectId", "HeuristicMask", "Refraction"}) {
    EXPECT_EQ(tiles.renderer->film().pass(pass), whole.renderer->film().pass(pass)) << pass;
  }
  for (size_t i = 0; i < tiles.stats()["objects"].size(); ++i) {
    EXPECT_EQ(tiles.stats()["objects"][i]["area_px"], whole.stats()["objects"][i]["area_px"]);
  }
}

TEST(Render, EveryPixelIsTracedOnce) {
  // Tiles share their workers' queues: what one leaves behind must not reach the next.
  SceneMaker s = crowd();
  s.scene->settings.threads = 1;
  const Picture p(s, 97, 61);
  s.scene = std::make_shared<Scene>(*s.scene);
  Camera& camera = s.scene->camera;
  // The lower left 32 x 32 pixels alone: one tile.
  camera.right = camera.left + (camera.right - camera.left) * 32.0f / 97.0f;
  camera.top = camera.bottom + (camera.top - camera.bottom) * 32.0f / 61.0f;
  const Picture q(s, 32, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      expect_near(p.at(x, y, "Refraction"), q.at(x, y, "Refraction"), 1e-2f);
    }
  }
}

TEST(Render, BudgetLeavesOutWhatDoesNotFit) {
  SceneMaker s = crowd();
  const Picture all(s, 320, 320);
  s.scene = std::make_shared<Scene>(*s.scene);
  const double full = all.stats()["stages_ms"]["trace"];
  s.scene->settings.budget_ms = static_cast<float>(0.3 * full);
  const Picture some(s, 320, 320);
  const nlohmann::json stats = some.stats();
  size_t selected = 0;
  for (const auto& o : stats["objects"]) selected += o["selected"].get<bool>();
  EXPECT_GT(selected, 0u);
  EXPECT_LT(stats["rays"]["shadow"].get<uint64_t>(), all.stats()["rays"]["shadow"].get<uint64_t>());
}

TEST(Render, CancelKeepsTheLastPicture) {
  const auto device = std::make_shared<Device>();
  Renderer renderer(device);
  SceneMaker s = crowd();
  renderer.render_frame(s.scene, 64, 64, {});
  const std::vector<float> before = renderer.film().pass("Combined");
  s.scene = std::make_shared<Scene>(*s.scene);
  s.scene->world.color = vec3(9.0f);
  EXPECT_THROW(
      renderer.render_frame(s.scene, 64, 64, [](float, std::string_view) { return false; }), Error);
  EXPECT_EQ(renderer.film().pass("Combined"), before);
  renderer.render_frame(s.scene, 64, 64, {});  // and it goes on working
  EXPECT_NE(renderer.film().pass("Combined"), before);
}

/// What copy_so_far() gives in every progress report of a frame; -1 where it left a pixel alone.
std::vector<std::vector<float>> pictures_so_far(Renderer& renderer, const SceneMaker& maker,
                                                int size) {
  std::vector<std::vector<float>> pictures;
  std::mutex mutex;
  renderer.render_frame(maker.scene, size, size, [&](float, std::string_view) {
    std::vector<float> picture(static_cast<size_t>(4 * size * size), -1.0f);
    renderer.copy_so_far("Combined", picture.data(), picture.size());
    const std::lock_guard lock(mutex);
    pictures.push_back(std::move(picture));
    return true;
  });
  return pictures;
}

TEST(Render, TilesOfOneSampleShowAsTheyGetDone) {
  Renderer renderer(std::make_shared<Device>());
  SceneMaker s = crowd();
  s.scene->settings.max_depth = 8;
  const auto pictures = pictures_so_far(renderer, s, 500);
  const std::vector<float> whole = renderer.film().pass("Combined");
  ASSERT_FALSE(pictures.empty());
  size_t early = 0;
  for (const std::vector<float>& picture : pictures) {
    for (size_t i = 0; i < whole.size(); ++i) {
      if (picture[i] == -1.0f) continue;
      ++early;
      ASSERT_EQ(picture[i], whole[i]);
    }
  }
  EXPECT_GT(early, 0u);
  std::vector<float> last(whole.size(), -1.0f);
  renderer.copy_so_far("Combined", last.data(), last.size());
  EXPECT_EQ(last, whole);
}

TEST(Render, SamplesSoFarAreAveraged) {
  Renderer renderer(std::make_shared<Device>());
  SceneMaker s;
  s.scene->world.color = vec3(0.25f, 0.5f, 2.0f);
  s.scene->settings.samples = 32;
  const auto pictures = pictures_so_far(renderer, s, 300);
  ASSERT_GT(pictures.size(), 1u);
  const float expected[4] = {0.25f, 0.5f, 2.0f, 1.0f};
  for (size_t i = 0; i < pictures.back().size(); ++i) {
    ASSERT_FLOAT_EQ(pictures.back()[i], expected[i % 4]);
  }
}

TEST(Render, CancelledPictureStaysAsFarAsItCame) {
  Renderer renderer(std::make_shared<Device>());
  std::vector<float> picture(4 * 400 * 400, -1.0f);
  EXPECT_THROW(renderer.copy_so_far("Combined", picture.data(), picture.size()), Error);
  SceneMaker s;
  s.scene->world.color = vec3(0.25f);
  s.scene->settings.samples = 4096;
  EXPECT_THROW(renderer.render_frame(s.scene, 400, 400,
                                     [](float share, std::string_view) { return share < 0.002f; }),
               Error);
  renderer.copy_so_far("Combined", picture.data(), picture.size());
  for (size_t i = 0; i < picture.size(); i += 4) ASSERT_FLOAT_EQ(picture[i], 0.25f);
  EXPECT_THROW(renderer.copy_so_far("Combined", picture.data(), 4), Error);
  EXPECT_THROW(renderer.copy_so_far("Nothing", picture.data(), picture.size()), Error);
}

/// The crowd, and meshes that take a while to build, each alone and instanced.
SceneMaker heavy_crowd() {
  SceneMaker s = crowd();
  const int grey = s.material(matte(vec3(0.5f)));
  s.object("heavy", sphere_mesh(400, 200), grey, placed({0, 0, 1}, 0.5f));
  const auto shared = sphere_mesh(400, 200);
  for (int i = 0; i < 3; ++i) {
    s.object("instance " + std::to_string(i), shared, grey, placed({1.0f * i - 1, 2, 1}, 0.4f));
  }
  return s;
}

TEST(Render, CancellingAtAnyMomentIsSoonAndLeavesNoTrace) {
  using Clock = std::chrono::steady_clock;
  const auto device = std::make_shared<Device>();
  SceneMaker s = heavy_crowd();
  s.scene->settings.samples = 4;
  std::chrono::duration<double> whole_time{};
  std::vector<float> whole;
  {
    Renderer renderer(device);
    const auto begin = Clock::now();
    renderer.render_frame(s.scene, 120, 120, {});
    whole_time = Clock::now() - begin;
    whole = renderer.film().pass("Combined");
  }
  std::mt19937 random(11);
  std::vector<double> late;  // seconds from the cancel to the return
  for (int i = 0; i < 8; ++i) {
    Renderer renderer(device);
    const auto wait = whole_time * std::uniform_real_distribution<double>(0.0, 0.9)(random);
    Clock::time_point cancelled;
    std::thread canceller([&] {
      std::this_thread::sleep_for(wait);
      cancelled = Clock::now();
      renderer.cancel();
    });
    bool threw = false;
    try {
      renderer.render_frame(s.scene, 120, 120, {});
    } catch (const Error& error) {
      threw = error.code() == ErrorCode::cancelled;
    }
    const auto returned = Clock::now();
    canceller.join();
    if (threw) late.push_back(std::chrono::duration<double>(returned - cancelled).count());
    renderer.render_frame(s.scene, 120, 120, {});
    ASSERT_EQ(renderer.film().pass("Combined"), whole) << "after a cancel at " << wait.count();
  }
  ASSERT_GE(late.size(), 4u);
  std::nth_element(late.begin(), late.begin() + static_cast<ptrdiff_t>(late.size()) / 2,
                   late.end());
  EXPECT_LT(late[late.size() / 2], 0.1 + 0.2 * whole_time.count());  // also on a busy machine
}

TEST(Render, ARegionHasTheBitsOfTheWhole) {
  SceneMaker s = crowd();
  s.scene->settings.samples = 3;
  Renderer renderer(std::make_shared<Device>());
  renderer.render_frame(s.scene, 150, 110, {});
  const std::map<std::string, size_t> passes = {{"Combined", 4}, {"Depth", 1}, {"Shadow", 3}};
  std::map<std::string, std::vector<float>> whole;
  for (const auto& [name, channels] : passes) whole[name] = renderer.film().pass(name);
  for (const Region& region : {Region{0, 0, 150, 110}, Region{37, 21, 70, 61}, Region{149, 0, 1, 9},
                               Region{2, 3, 5, 107}}) {
    renderer.set_region(region);
    renderer.render_frame(s.scene, 150, 110, {});
    ASSERT_EQ(renderer.film().width(), region.width);
    ASSERT_EQ(renderer.film().height(), region.height);
    for (const auto& [name, channels] : passes) {
      const std::vector<float> part = renderer.film().pass(name);
      const size_t row = region.width * channels;
      for (int y = 0; y < region.height; ++y) {
        const auto at = whole[name].begin() +
                        static_cast<ptrdiff_t>(((region.y + y) * 150 + region.x) * channels);
        ASSERT_TRUE(std::equal(at, at + static_cast<ptrdiff_t>(row), part.begin() + y * row))
            << name << ", row " << y;
      }
    }
  }
  for (const Region& outside : {Region{100, 0, 51, 10}, Region{0, 100, 10, 11}}) {
    renderer.set_region(outside);
    EXPECT_THROW(renderer.render_frame(s.scene, 150, 110, {}), Error);
  }
  renderer.set_region({});
  renderer.render_frame(s.scene, 150, 110, {});
  EXPECT_EQ(renderer.film().width(), 150);
}

TEST(Render, SizesThatCannotBeAreRefused) {
  SceneMaker s;
  Renderer renderer(std::make_shared<Device>());
  EXPECT_THROW(renderer.render_frame(s.scene, 0, 5, {}), Error);
  EXPECT_THROW(renderer.render_frame(s.scene, 1 << 20, 1 << 20, {}), Error);
}

}  // namespace
}  // namespace kestrel
