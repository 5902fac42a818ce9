// SPDX-License-Identifier: GPL-3.0-or-later
// Occlusion queries must count exactly the pixels that the id target shows (paper, listing 6).
#include <algorithm>
#include <numeric>
#include <random>
#include <utility>

#include "raster_fixture.h"

namespace kestrel {
namespace {

using test::rectangle;
using test::SceneMaker;

/// Visible pixels per unit, by counting.
std::vector<uint64_t> histogram(const Scene& scene, const GBuffer& g) {
  std::vector<uint64_t> areas(scene.units.size(), 0);
  for (const uint32_t object : g.object) {
    if (object != 0) ++areas[scene.objects[object - 1].unit];
  }
  return areas;
}

class RasterOcclusion : public test::RasterTest {
 protected:
  std::vector<uint64_t> queried(const SceneMaker& maker, int width, int height,
                                const vec2& subpixel = vec2(0)) {
    return stage_->occlusion_areas({*maker.scene, width, height, subpixel});
  }
};

TEST_F(RasterOcclusion, CountsWhatIsSeenOfEachUnit) {
  SceneMaker maker;
  maker.object("back", rectangle(-1, -1, 1, 1, 0.0f), 0);
  maker.object("front", rectangle(-1, -1, 0, 0, 1.0f), 0);
  maker.object("hidden", rectangle(-1, -1, 1, 1, -1.0f), 0);
  render(maker, 10, 10);
  EXPECT_EQ(queried(maker, 10, 10), (std::vector<uint64_t>{75, 25, 0}));
}

TEST_F(RasterOcclusion, CoincidingFacesCountOnce) {
  SceneMaker maker;
  auto doubled = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
  doubled->triangles.insert(doubled->triangles.end(), {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}});
  doubled->corner_uvs.clear();
  maker.object("doubled", doubled, 0);
  maker.object("same unit, same place", rectangle(-1, -1, 1, 1), 0);
  maker.scene->objects[1].unit = 0;
  render(maker, 8, 8);
  EXPECT_EQ(queried(maker, 8, 8), (std::vector<uint64_t>{64, 0}));
}

TEST_F(RasterOcclusion, FirstOfCoincidingObjectsIsTheOneSeen) {
  SceneMaker maker;
  maker.object("first", rectangle(-1, -1, 1, 1), 0);
  maker.object("second", rectangle(-1, -1, 1, 1), 0);
  std::swap(maker.scene->objects[0].unit, maker.scene->objects[1].unit);
  const GBuffer g = render(maker, 8, 8);
  EXPECT_EQ(g.object[0], 1u);
  EXPECT_EQ(queried(maker, 8, 8), (std::vector<uint64_t>{0, 64}));
}

TEST_F(RasterOcclusion, EqualsTheHistogramOfARandomScene) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  const auto random_vec = [&] { return vec3(unit(random), unit(random), unit(random)); };
  SceneMaker maker = test::perspective_scene();
  Texture holes{"holes", 16, 16};
  for (int i = 0; i < 16 * 16; ++i) {
    holes.texels8.insert(holes.texels8.end(), {255, 255, 255, uint8_t(random() % 256)});
  }
  Material masked;
  masked.alpha_mode = AlphaMode::mask;
  masked.diffuse_texture = maker.texture(holes);
  const int leaf = maker.material(masked);
  for (int i = 0; i < 50; ++i) {
    const bool sphere = i % 3 == 0;
    const auto mesh =
        sphere ? test::sphere_mesh(24, 12)
               : test::quad_mesh(2.0f * random_vec(), 4.0f * random_vec(), 4.0f * random_vec());
    mat4x3 place(1.0f);
    for (int k = 0; k < 3; ++k) place[k] = 1.5f * random_vec();
    place[3] = 6.0f * random_vec();
    maker.object("object", mesh, i % 4 == 1 ? leaf : 0, place);
    maker.scene->objects.back().unit = i % 20;  // units of two or three objects
  }
  for (const vec2& subpixel : {vec2(0.0f), vec2(0.31f, -0.22f)}) {
    const GBuffer g = render(maker, 160, 120, subpixel);
    const std::vector<uint64_t> expected = histogram(*maker.scene, g);
    EXPECT_EQ(queried(maker, 160, 120, subpixel), expected);
    const auto seen = std::count_if(expected.begin(), expected.end(), [](auto a) { return a > 0; });
    EXPECT_GE(seen, 15) << "the scene tests too little";
    EXPECT_GT(std::accumulate(expected.begin(), expected.end(), uint64_t(0)), 5000u);
  }
}

TEST_F(RasterOcclusion, LeavesThePictureAsItWas) {
  SceneMaker maker;
  maker.object("ball", test::sphere_mesh(24, 12), 0);
  const GBuffer before = render(maker, 32, 32);
  queried(maker, 32, 32);
  const std::vector<uint64_t> again = queried(maker, 32, 32);
  EXPECT_EQ(again, histogram(*maker.scene, before));
  const GBuffer after = render(maker, 32, 32);
  EXPECT_EQ(after.depth, before.depth);
  EXPECT_EQ(after.object, before.object);
}

TEST_F(RasterOcclusion, EmptySceneHasNoAreas) {
  const SceneMaker maker;
  render(maker, 4, 4);
  EXPECT_TRUE(queried(maker, 4, 4).empty());
}

TEST_F(RasterOcclusion, NeedsAPictureOfTheSameSize) {
  SceneMaker maker;
  render(maker, 4, 4);
  EXPECT_THROW(queried(maker, 8, 8), Error);
}

}  // namespace
}  // namespace kestrel
