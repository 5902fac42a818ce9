// SPDX-License-Identifier: GPL-3.0-or-later
// What camera, settings, lights, world, textures and materials of a scene file mean.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "cli/camera.h"
#include "scenefile_fixture.h"

namespace kestrel::cli {
namespace {

// ---- camera ------------------------------------------------------------------------------------

TEST(SceneCamera, FieldOfViewMeasuresTheLargerSideUnlessItSaysWhich) {
  const auto window = [](const char* fov, int width, int height) {
    const auto camera = read_camera(std::string(R"({"position": [0, 0, 0], ")") + fov + "\": 90}");
    return camera_for(camera, width, height);
  };
  const KestrelCamera wide = window("fov", 200, 100), tall = window("fov", 100, 200);
  EXPECT_NEAR(wide.right, 1.0f, 1e-5f);
  EXPECT_NEAR(wide.top, 0.5f, 1e-5f);
  EXPECT_NEAR(tall.right, 0.5f, 1e-5f);
  EXPECT_NEAR(tall.top, 1.0f, 1e-5f);
  EXPECT_NEAR(window("fov_x", 100, 200).right, 1.0f, 1e-5f);
  EXPECT_NEAR(window("fov_x", 100, 200).top, 2.0f, 1e-5f);
  EXPECT_NEAR(window("fov_y", 200, 100).top, 1.0f, 1e-5f);
  EXPECT_NEAR(window("fov_y", 200, 100).left, -2.0f, 1e-5f);
}

TEST(SceneCamera, ShiftMovesTheWindowInUnitsOfTheFittedSide) {
  // As Blender's: shift_x 0.5 with a 90 degree view of 2:1 moves by half of the width, and
  // shift_y too is measured in widths.
  const KestrelCamera c =
      camera_for(read_camera(R"({"fov": 90, "shift_x": 0.5, "shift_y": -0.25})"), 200, 100);
  EXPECT_NEAR(c.left, 0.0f, 1e-5f);
  EXPECT_NEAR(c.right, 2.0f, 1e-5f);
  EXPECT_NEAR(c.bottom, -1.0f, 1e-5f);
  EXPECT_NEAR(c.top, 0.0f, 1e-5f);
}

TEST(SceneCamera, OrthographicScaleIsInMetres) {
  const KestrelCamera c =
      camera_for(read_camera(R"({"type": "orthographic", "scale": 16, "near": -5})"), 256, 144);
  EXPECT_EQ(c.projection, KESTREL_ORTHOGRAPHIC);
  EXPECT_NEAR(c.right - c.left, 16.0f, 1e-4f);
  EXPECT_NEAR(c.top - c.bottom, 9.0f, 1e-4f);
  EXPECT_EQ(c.near_clip, -5.0f);
}

TEST(SceneCamera, LookAtPointsMinusZAtTheTargetWithYUp) {
  const auto camera = read_camera(
      R"({"fov": 50, "position": [1, -4, 2], "look_at": [1, 6, 2], "near": 1, "far": 9})");
  expect_near(-camera.world_from_camera[2], {0, 1, 0});
  expect_near(camera.world_from_camera[1], {0, 0, 1});
  expect_near(camera.world_from_camera[0], {1, 0, 0});
  expect_near(camera.world_from_camera[3], {1, -4, 2});
  EXPECT_EQ(camera.near_clip, 1.0f);
  EXPECT_EQ(camera.far_clip, 9.0f);
}

TEST(SceneCamera, LooksStraightDownWithoutAnUpOfItsOwn) {
  const auto m =
      read_camera(R"({"fov": 50, "position": [0, 0, 5], "look_at": [0, 0, 0]})").world_from_camera;
  expect_near(m[2], {0, 0, 1});
  EXPECT_NEAR(glm::determinant(glm::mat3(m)), 1.0f, 1e-5f);
}

TEST(SceneCamera, RotationAndMatrixAreBlenders) {
  // Blender's default front view: rotated by 90 degrees about X it looks along +Y with Z up.
  const auto rotated = read_camera(R"({"fov": 50, "rotation": [90, 0, 0]})").world_from_camera;
  expect_near(-rotated[2], {0, 1, 0});
  expect_near(rotated[1], {0, 0, 1});
  const auto given =
      read_camera(R"({"fov": 50, "matrix": [1,0,0, 0,0,1, 0,-1,0, 7,8,9]})").world_from_camera;
  expect_near(given[1], {0, 0, 1});
  expect_near(given[3], {7, 8, 9});
}

constexpr const char* kPathCamera = R"({"fov": 50, "path": [
  {"time": 0, "position": [0, 0, 2], "look_at": [0, 10, 2]},
  {"time": 5, "position": [5, 0, 2], "look_at": [5, 10, 2]},
  {"time": 20, "position": [20, 0, 2], "look_at": [20, 10, 2]}]})";

TEST(SceneCamera, PathGoesThroughItsKeysAtTheirTimes) {
  const auto camera = read_camera(kPathCamera);
  const auto position = [&](double fraction) {
    const KestrelCamera c = camera_on_path(camera, fraction, 16, 9);
    return vec3(c.world_from_camera[9], c.world_from_camera[10], c.world_from_camera[11]);
  };
  expect_near(position(0.0), {0, 0, 2});
  expect_near(position(0.25), {5, 0, 2});
  expect_near(position(1.0), {20, 0, 2});
  expect_near(vec3(camera.world_from_camera[3]), {0, 0, 2});
  // These keys lie on a line walked at one metre a second, which the curve keeps, between keys too.
  for (const double fraction : {0.1, 0.4, 0.73}) {
    expect_near(position(fraction), {20 * fraction, 0, 2}, 1e-4f);
  }
}

TEST(SceneObjects, VisibilityIsThatOfEveryInstance) {
  const auto scene = read(R"("meshes": [{"name": "m", "primitive": "cube"}], "objects": [
    {"mesh": "m", "hidden_from": ["camera", "reflection"], "holdout": true,
     "instances": [[0, 0, 0], [1, 0, 0]]}, {"mesh": "m"}])");
  ASSERT_EQ(scene.objects.size(), 3u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(scene.objects[i].hidden_from, KESTREL_RAYS_CAMERA | KESTREL_RAYS_REFLECTION);
    EXPECT_TRUE(scene.objects[i].holdout);
  }
  EXPECT_EQ(scene.objects[2].hidden_from, 0u);
  EXPECT_FALSE(scene.objects[2].holdout);
}

TEST(SceneCamera, PathIsSmoothAtItsKeys) {
  const auto camera = read_camera(R"({"fov": 50, "path": [
    {"time": 0, "position": [0, 0, 0], "look_at": [0, 9, 0]},
    {"time": 1, "position": [1, 2, 0], "look_at": [0, 9, 0]},
    {"time": 3, "position": [4, 1, 0], "look_at": [0, 9, 0]}]})");
  const auto x = [&](double time) {
    return camera_on_path(camera, time / 3.0, 16, 9).world_from_camera[9];
  };
  const double step = 1e-2;
  const double before = (x(1.0) - x(1.0 - step)) / step, after = (x(1.0 + step) - x(1.0)) / step;
  EXPECT_NEAR(before, after, 0.05);
  EXPECT_NEAR(before, 4.0 / 3.0, 0.05);  // slope from the neighbours: (4 - 0) m in 3 s
}

// ---- settings, lights, world -------------------------------------------------------------------

TEST(SceneSettings, BecomeTheTablesTexts) {
  const auto scene = read(R"("settings": {"budget_ms": 12.5, "samples": 4, "ambient": [0.5, 0, 1],
                          "primary": "rays", "validate_areas": true})");
  const std::map<std::string, std::string> settings(scene.settings.begin(), scene.settings.end());
  EXPECT_EQ(settings.at("budget_ms"), "12.5");
  EXPECT_EQ(settings.at("samples"), "4");
  EXPECT_EQ(settings.at("ambient"), "0.5 0 1");
  EXPECT_EQ(settings.at("primary"), "rays");
  EXPECT_EQ(settings.at("validate_areas"), "true");
  EXPECT_EQ(settings.size(), 5u);
}

TEST(SceneLights, HaveThePapersParameters) {
  const auto scene = read(R"("lights": [
    {"type": "directional", "direction": [0, 3, -4], "color": [1, 0.5, 0.25], "intensity": 2},
    {"name": "Lamp", "type": "point", "position": [1, 2, 3], "attenuation": [1, 0.5, 0.25]},
    {"type": "spot", "position": [0, 0, 4], "target": [0, 3, 0], "spot_angle": 60, "blend": 0.25, "exponent": 2,
     "casts_shadow": false, "specular_factor": 0}])");
  ASSERT_EQ(scene.lights.size(), 3u);
  const KestrelLight &sun = scene.lights[0].values, &lamp = scene.lights[1].values,
                     &spot = scene.lights[2].values;
  EXPECT_EQ(sun.type, KESTREL_LIGHT_DIRECTIONAL);
  expect_near({sun.color[0], sun.color[1], sun.color[2]}, {2, 1, 0.5f});
  expect_near({sun.direction[0], sun.direction[1], sun.direction[2]}, {0, 0.6f, -0.8f});
  EXPECT_TRUE(sun.casts_shadow);
  EXPECT_EQ(scene.lights[1].name, "Lamp");
  EXPECT_EQ(lamp.type, KESTREL_LIGHT_POINT);
  expect_near({lamp.attenuation[0], lamp.attenuation[1], lamp.attenuation[2]}, {1, 0.5f, 0.25f});
  EXPECT_EQ(spot.type, KESTREL_LIGHT_SPOT);
  expect_near({spot.direction[0], spot.direction[1], spot.direction[2]}, {0, 0.6f, -0.8f});
  EXPECT_NEAR(spot.spot_angle, M_PI / 3, 1e-5);
  EXPECT_EQ(spot.spot_blend, 0.25f);
  EXPECT_EQ(spot.spot_exponent, 2.0f);
  EXPECT_FALSE(spot.casts_shadow);
  EXPECT_EQ(spot.specular_factor, 0.0f);
}

TEST_F(SceneFiles, WorldIsAColorAnImageOrACube) {
  const auto color = read(R"("world": {"color": [0.1, 0.2, 0.3], "strength": 2})").world;
  EXPECT_EQ(color.kind, KESTREL_WORLD_COLOR);
  expect_near(color.color, {0.2f, 0.4f, 0.6f});

  write("sky.hdr", "x");
  const auto scene = read(R"("world": {"image": "sky.hdr", "rotation": 90})", scene_path());
  EXPECT_EQ(scene.world.kind, KESTREL_WORLD_EQUIRECTANGULAR);
  expect_near(scene.world.color, {1, 1, 1});
  ASSERT_EQ(scene.world.textures[0], 0);
  EXPECT_EQ(std::get<TextureFile>(scene.textures[0].source).path, (folder_ / "sky.hdr").string());
  // Turned by 90 degrees anticlockwise, what was at +X is seen at +Y.
  expect_near(scene.world.map_from_world * vec3(0, 1, 0), {1, 0, 0});
}

TEST_F(SceneFiles, CubeMapsHaveTheirOwnUpAndMayBeUpsideDown) {
  for (const char* name : {"px", "nx", "py", "ny", "pz", "nz"}) write(name, "x");
  const std::string cube = R"("world": {"up": "y", "cube": ["px", "nx", "py", "ny", "pz", "nz"])";
  const auto upright = read(cube + "}", scene_path());
  EXPECT_EQ(upright.world.kind, KESTREL_WORLD_CUBE);
  expect_near(upright.world.map_from_world * vec3(0, 0, 1), {0, 1, 0});
  expect_near(upright.world.map_from_world * vec3(1, 0, 0), {1, 0, 0});
  EXPECT_NEAR(glm::determinant(upright.world.map_from_world), 1.0f, 1e-6f);

  // Upside down, the zenith is the file that is named third, seen mirrored.
  const auto flipped = read(cube + R"(, "flip": true})", scene_path());
  expect_near(flipped.world.map_from_world * vec3(0, 0, 1), {0, -1, 0});
  const int zenith = flipped.world.textures[3];
  EXPECT_EQ(flipped.textures[zenith].name, "py");
  EXPECT_EQ(flipped.textures[flipped.world.textures[0]].name, "px");
}

// ---- textures and materials --------------------------------------------------------------------

TEST(SceneTextures, CheckerStartsWithTheFirstColorAtTheBottomLeft) {
  const auto scene = read(R"("textures": [{"name": "c", "nearest": true, "extension": "clip",
      "checker": {"squares": 2, "texels": 3, "colors": [[1, 0, 0], [0, 0, 1, 0.5]]}}])");
  const TextureDescription& texture = scene.textures[0];
  const auto& pixels = std::get<TexturePixels>(texture.source);
  EXPECT_TRUE(texture.nearest);
  EXPECT_EQ(texture.extension, KESTREL_EXTENSION_CLIP);
  ASSERT_EQ(pixels.width, 6);
  ASSERT_EQ(pixels.height, 6);
  const auto texel = [&](int x, int y) {
    const float* p = &pixels.rgba[4 * (6 * y + x)];
    return std::vector<float>(p, p + 4);
  };
  EXPECT_EQ(texel(2, 2), (std::vector<float>{1, 0, 0, 1}));
  EXPECT_EQ(texel(3, 2), (std::vector<float>{0, 0, 1, 0.5}));
  EXPECT_EQ(texel(2, 3), (std::vector<float>{0, 0, 1, 0.5}));
  EXPECT_EQ(texel(5, 5), (std::vector<float>{1, 0, 0, 1}));
}

TEST_F(SceneFiles, ImagesWithoutColorAreNotDecodedAsColor) {
  for (const char* name : {"a.png", "b.png", "c.png"}) write(name, "x");
  const auto scene = read(R"("textures": [{"name": "color", "file": "a.png"},
      {"name": "bumps", "file": "b.png"}, {"name": "said", "file": "c.png", "srgb": true}],
    "materials": [{"name": "m", "diffuse_texture": "color", "normal_texture": "bumps",
                   "optical_texture": "said"}])",
                          scene_path());
  EXPECT_TRUE(scene.textures[0].srgb);
  EXPECT_FALSE(scene.textures[1].srgb);
  EXPECT_TRUE(scene.textures[2].srgb);
}

TEST(SceneMaterials, HaveEveryPropertyOfTable1) {
  const auto scene =
      read(R"("textures": [{"name": "t0", "checker": {}}, {"name": "t1", "checker": {}}],
    "materials": [{"name": "all", "emission": [5, 0, 1], "ambient": [0.1, 0.2, 0.3],
      "diffuse": [0.4, 0.5, 0.6, 0.7], "specular": [0.1, 0.1, 0.2, 0.25], "reflectivity": 0.5,
      "ior": 1.5, "opacity": 0.25, "reflection_color": [1, 0.5, 0], "transmission_color": [0, 1, 1],
      "emission_texture": "t0", "diffuse_texture": "t1", "specular_texture": "t0",
      "optical_texture": "t1", "normal_strength": 0.5, "tiling": [2, 3], "offset": [0.25, -1],
      "casts_shadow": false, "alpha_mode": "mask", "alpha_cutoff": 0.3}])");
  const KestrelMaterial& m = scene.materials[0].values;
  const auto values = [](const float* v, int n) { return std::vector<float>(v, v + n); };
  EXPECT_EQ(values(m.emission, 3), (std::vector<float>{5, 0, 1}));
  EXPECT_EQ(values(m.ambient, 3), (std::vector<float>{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(values(m.diffuse, 4), (std::vector<float>{0.4f, 0.5f, 0.6f, 0.7f}));
  EXPECT_EQ(values(m.specular, 4), (std::vector<float>{0.1f, 0.1f, 0.2f, 0.25f}));
  EXPECT_EQ(values(m.optical, 3), (std::vector<float>{0.5f, 1.5f, 0.25f}));
  EXPECT_EQ(values(m.reflection_color, 3), (std::vector<float>{1, 0.5f, 0}));
  EXPECT_EQ(values(m.transmission_color, 3), (std::vector<float>{0, 1, 1}));
  EXPECT_EQ(m.emission_texture, 1u);
  EXPECT_EQ(m.diffuse_texture, 2u);
  EXPECT_EQ(m.specular_texture, 1u);
  EXPECT_EQ(m.optical_texture, 2u);
  EXPECT_EQ(m.normal_texture, 0u);
  EXPECT_EQ(m.ambient_texture, 0u) << "an ambient colour of its own takes no diffuse image";
  EXPECT_EQ(m.normal_strength, 0.5f);
  EXPECT_EQ(values(m.tiling, 2), (std::vector<float>{2, 3}));
  EXPECT_EQ(values(m.offset, 2), (std::vector<float>{0.25f, -1}));
  EXPECT_FALSE(m.casts_shadow);
  EXPECT_EQ(m.alpha_mode, KESTREL_ALPHA_MASK);
  EXPECT_EQ(m.alpha_cutoff, 0.3f);
}

TEST(SceneMaterials, AmbientFollowsDiffuseUnlessGiven) {
  const auto scene = read(R"("textures": [{"name": "t", "checker": {}}],
    "materials": [{"name": "m", "diffuse": [0.4, 0.5, 0.6], "diffuse_texture": "t"}])");
  const KestrelMaterial& m = scene.materials[0].values;
  expect_near({m.ambient[0], m.ambient[1], m.ambient[2]}, {0.4f, 0.5f, 0.6f});
  EXPECT_EQ(m.ambient_texture, 1u);
  EXPECT_EQ(m.diffuse[3], 1.0f);
}

// ---- files -------------------------------------------------------------------------------------

TEST_F(SceneFiles, SceneDataIsFoundBesideTheRepositoryOrByTheVariable) {
  unsetenv("KESTREL_SCENE_DATA");
  write("shared/scenes/sky.hdr", "x");
  write("elsewhere/sky.hdr", "x");
  const std::string path = write("repository/scenes/a.kscene", "");
  const std::string world = R"("world": {"image": "${KESTREL_SCENE_DATA}/sky.hdr"})";
  const auto file = [&] {
    return std::get<TextureFile>(read(world, path).textures[0].source).path;
  };
  EXPECT_EQ(file(), (folder_ / "shared/scenes/sky.hdr").string());
  setenv("KESTREL_SCENE_DATA", (folder_ / "elsewhere").c_str(), 1);
  EXPECT_EQ(file(), (folder_ / "elsewhere/sky.hdr").string());
  setenv("KESTREL_SCENE_DATA", (folder_ / "nowhere").c_str(), 1);
  try {
    file();
    FAIL() << "missing data must be an error";
  } catch (const SceneFileError& error) {
    EXPECT_EQ(error.pointer(), "/world/image");
    EXPECT_NE(std::string(error.what()).find((folder_ / "nowhere").string()), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("KESTREL_SCENE_DATA"), std::string::npos);
  }
  unsetenv("KESTREL_SCENE_DATA");
}

}  // namespace
}  // namespace kestrel::cli
