// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes that come with Kestrel have the counts of the paper's Table 4. Those that need scene
// data are skipped, and say so, where it is missing.
#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "cli/scene_data.h"
#include "scenefile_fixture.h"

namespace kestrel::cli {
namespace {

struct Counts {
  const char* scene;
  size_t triangles;
  double tolerance;  // share of the triangles
  size_t objects, reflective, refractive;
};

void PrintTo(const Counts& counts, std::ostream* out) {
  *out << counts.scene;
}

class ShippedScene : public testing::TestWithParam<Counts> {};

TEST_P(ShippedScene, HasTheCountsOfTable4) {
  const Counts& paper = GetParam();
  const std::string path = std::string(KESTREL_SOURCE_DIR "/scenes/") + paper.scene + ".kscene";
  const fs::path data = scene_data_folder(path);
  if (!fs::exists(data / "sponza")) {
    GTEST_SKIP() << "no scene data in " << data << "; KESTREL_SCENE_DATA names another folder";
  }
  const SceneDescription scene = read_scene_file(path);
  size_t triangles = 0;
  std::set<std::string> units, reflective, refractive;
  for (const ObjectDescription& object : scene.objects) {
    const std::string& unit = object.unit.empty() ? object.name : object.unit;
    units.insert(unit);
    triangles += scene.meshes[object.mesh].triangles.size();
    for (const int index : object.materials) {
      const KestrelMaterial& m = scene.materials[index].values;
      if (m.optical[0] > 0.0f) reflective.insert(unit);
      if (m.optical[2] < 1.0f) refractive.insert(unit);
    }
  }
  std::cout << paper.scene << ": " << triangles << " triangles (paper " << paper.triangles << "), "
            << units.size() << " objects, " << reflective.size() << " reflective, "
            << refractive.size() << " refractive\n";
  EXPECT_NEAR(triangles, paper.triangles, paper.tolerance * paper.triangles);
  EXPECT_EQ(units.size(), paper.objects);
  EXPECT_EQ(reflective.size(), paper.reflective);
  EXPECT_EQ(refractive.size(), paper.refractive);
  EXPECT_GE(scene.camera.path.size(), 2u);
  EXPECT_EQ(scene.camera.path.back().time - scene.camera.path.front().time, 20.0);
}

const Counts kTable4[] = {{"sponza_spheres", 272'144, 1e-3, 29, 3, 23},
                          {"sponza_armadillo", 292'544, 1e-3, 25, 0, 21},
                          {"dining_room", 139'378, 1e-3, 27, 0, 1},
                          {"backyard", 1'128'786, 1e-3, 48, 1, 2}};
INSTANTIATE_TEST_SUITE_P(Table4, ShippedScene, testing::ValuesIn(kTable4));

TEST(ShippedShowcase, NeedsNoOutsideData) {
  const auto scene = read_scene_file(KESTREL_SOURCE_DIR "/scenes/showcase.kscene");
  EXPECT_GT(scene.objects.size(), 5u);
  for (const TextureDescription& texture : scene.textures) {
    EXPECT_TRUE(std::holds_alternative<TexturePixels>(texture.source)) << texture.name;
  }
}

}  // namespace
}  // namespace kestrel::cli
