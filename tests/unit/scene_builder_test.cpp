// SPDX-License-Identifier: GPL-3.0-or-later
// The rules by which a host's items become a scene.
#include <cmath>

#include "log_capture.h"
#include "scene_builder_fixture.h"

namespace kestrel {
namespace {

using test::LogCapture;

// ---- Commit -------------------------------------------------------------------------------------

TEST(Commit, NeedsACameraAndSaysHowToSetIt) {
  SceneBuilder builder;
  expect_words(failure(ErrorCode::invalid_operation, [&] { builder.commit(); }),
               {"camera", "kestrelSetCamera"});
}

TEST(Commit, AnEmptySceneIsFine) {
  SceneBuilder builder;
  builder.set_camera({});
  const auto scene = builder.commit();
  EXPECT_TRUE(scene->objects.empty());
  ASSERT_EQ(scene->materials.size(), 1u);
  EXPECT_EQ(scene->materials[0].diffuse, vec4(0.8f, 0.8f, 0.8f, 1.0f));
}

TEST(Commit, AllOrNothing) {
  Builder builder;
  builder.set_object(1, object_of(1, "good"));
  const auto before = builder.commit();
  builder.set_object(2, object_of(99, "bad"));
  EXPECT_THROW(builder.commit(), Error);
  EXPECT_EQ(builder.published(), before);
  EXPECT_EQ(before->objects.size(), 1u);
  builder.remove(ItemKind::object, 2);
  EXPECT_EQ(builder.commit()->objects.size(), 1u);
}

TEST(Commit, UnknownReferencesNameBothSides) {
  Builder builder;
  builder.set_object(5, object_of(77, "chair"));
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.commit(); }), {"chair", "77"});
  builder.set_object(5, object_of(1, "chair", {0, 88}));
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.commit(); }),
               {"chair", "material 88"});
  builder.remove(ItemKind::object, 5);
  MaterialInput wood = material_called("wood");
  wood.normal_texture = 66;
  builder.set_material(1, wood);
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.commit(); }),
               {"wood", "texture 66"});
  builder.remove(ItemKind::material, 1);
  WorldInput world;
  world.values.kind = WorldKind::equirectangular;
  world.textures[0] = 55;
  builder.set_world(world);
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.commit(); }),
               {"world", "texture 55"});
}

TEST(Commit, RemovingWhatIsStillUsedFailsTheNextOne) {
  Builder builder;
  builder.set_material(3, material_called("paint"));
  builder.set_object(1, object_of(1, "wall", {3}));
  builder.commit();
  builder.remove(ItemKind::material, 3);
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.commit(); }), {"wall", "3"});
}

TEST(Commit, RemovingAnUnknownIdIsAnError) {
  SceneBuilder builder;
  for (const ItemKind kind :
       {ItemKind::mesh, ItemKind::texture, ItemKind::material, ItemKind::light, ItemKind::object}) {
    expect_words(failure(ErrorCode::invalid_argument, [&] { builder.remove(kind, 4); }), {"4"});
  }
}

TEST(Commit, ZeroIsNoId) {
  SceneBuilder builder;
  EXPECT_THROW(builder.set_mesh(0, Square().input()), Error);
  EXPECT_THROW(builder.set_material(0, {}), Error);
  EXPECT_THROW(builder.set_light(0, {}), Error);
  EXPECT_THROW(builder.set_object(0, {}), Error);
  EXPECT_THROW(builder.set_texture_file(0, "a.png", {}), Error);
}

TEST(Commit, OrderIsThatOfFirstSetting) {
  Builder builder;
  for (const uint64_t id : {30, 10, 20}) {
    builder.set_object(id, object_of(1, fmt::format("o{}", id)));
    builder.set_material(id, material_called(fmt::format("m{}", id)));
  }
  builder.set_object(30, object_of(1, "o30 again"));
  const auto scene = builder.commit();
  ASSERT_EQ(scene->objects.size(), 3u);
  EXPECT_EQ(scene->objects[0].name, "o30 again");
  EXPECT_EQ(scene->objects[1].name, "o10");
  EXPECT_EQ(scene->objects[2].name, "o20");
  EXPECT_EQ(scene->materials[1].name, "m30");
  EXPECT_EQ(scene->materials[3].name, "m20");
  EXPECT_EQ(scene->units[1].name, "o10");
}

TEST(Commit, UnchangedMeshesAndTexturesKeepTheirPointer) {
  Builder builder;
  const uint8_t texel[4] = {1, 2, 3, 4};
  builder.set_texture_pixels8(9, 1, 1, texel, {});
  MaterialInput paint = material_called("paint");
  paint.diffuse_texture = 9;
  builder.set_material(1, paint);
  builder.set_mesh(2, Square().input("other"));
  builder.set_object(1, object_of(1, "a", {1}));
  builder.set_object(2, object_of(2, "b"));
  const auto first = builder.commit();
  builder.set_object_transform(1, mat4x3(2.0f));
  builder.set_mesh(2, Square().input("other"));
  const auto second = builder.commit();
  EXPECT_EQ(first->meshes[0], second->meshes[0]);
  EXPECT_EQ(first->textures[0], second->textures[0]);
  EXPECT_NE(first->meshes[1], second->meshes[1]) << "was set again";
  EXPECT_EQ(first->objects[0].world_from_object[0].x, 1.0f) << "a snapshot never changes";
  EXPECT_EQ(second->objects[0].world_from_object[0].x, 2.0f);
}

// ---- Numbers ------------------------------------------------------------------------------------

TEST(Numbers, ThatAreNotFiniteNameItemAndField) {
  SceneBuilder builder;
  const auto material = [&](auto&& change) {
    MaterialInput input = material_called("glass");
    change(input.values);
    return failure(ErrorCode::invalid_argument, [&] { builder.set_material(1, input); });
  };
  expect_words(material([](Material& m) { m.diffuse.y = kNan; }), {"glass", "diffuse"});
  expect_words(material([](Material& m) { m.emission.x = kInf; }), {"glass", "emission"});
  expect_words(material([](Material& m) { m.ambient.z = kNan; }), {"ambient"});
  expect_words(material([](Material& m) { m.specular.w = kNan; }), {"specular"});
  expect_words(material([](Material& m) { m.optical.y = kInf; }), {"optical"});
  expect_words(material([](Material& m) { m.reflection_color.x = kNan; }), {"reflection_color"});
  expect_words(material([](Material& m) { m.transmission_color.x = kNan; }),
               {"transmission_color"});
  expect_words(material([](Material& m) { m.tiling.x = kNan; }), {"tiling"});
  expect_words(material([](Material& m) { m.offset.y = kNan; }), {"offset"});
  expect_words(material([](Material& m) { m.normal_strength = kNan; }), {"normal_strength"});
  expect_words(material([](Material& m) { m.alpha_cutoff = kNan; }), {"alpha_cutoff"});

  const auto light = [&](auto&& change) {
    LightInput input;
    input.values.name = "sun";
    change(input);
    return failure(ErrorCode::invalid_argument, [&] { builder.set_light(1, input); });
  };
  expect_words(light([](LightInput& l) { l.values.color.x = kNan; }), {"sun", "color"});
  expect_words(light([](LightInput& l) { l.values.position.x = kInf; }), {"position"});
  expect_words(light([](LightInput& l) { l.values.direction.x = kNan; }), {"direction"});
  expect_words(light([](LightInput& l) { l.values.attenuation.x = kNan; }), {"attenuation"});
  expect_words(light([](LightInput& l) { l.spot_angle = kNan; }), {"spot_angle"});
  expect_words(light([](LightInput& l) { l.values.blend = kNan; }), {"spot_blend"});
  expect_words(light([](LightInput& l) { l.values.specular_factor = kNan; }), {"specular_factor"});

  const auto camera = [&](auto&& change) {
    Camera c;
    change(c);
    return failure(ErrorCode::invalid_argument, [&] { builder.set_camera(c); });
  };
  expect_words(camera([](Camera& c) { c.world_from_camera[1].y = kNan; }), {"world_from_camera"});
  expect_words(camera([](Camera& c) { c.left = -kInf; }), {"left"});
  expect_words(camera([](Camera& c) { c.far_clip = kInf; }), {"far_clip"});

  ObjectInput object = object_of(1, "vase");
  object.world_from_object[3].x = kNan;
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_object(1, object); }),
               {"vase", "world_from_object"});
  builder.set_object(1, object_of(1, "vase"));
  expect_words(failure(ErrorCode::invalid_argument,
                       [&] { builder.set_object_transform(1, object.world_from_object); }),
               {"vase", "world_from_object"});
  WorldInput world;
  world.values.color.x = kNan;
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_world(world); }),
               {"world", "color"});
}

TEST(Numbers, WithANaturalRangeAreClampedWithOneWarning) {
  Builder builder;
  MaterialInput wild = material_called("wild");
  wild.values.optical = {1.5f, 100.0f, -0.5f};
  wild.values.diffuse.w = 2.0f;
  wild.values.specular.w = -1.0f;
  wild.values.alpha_cutoff = 3.0f;
  const LogCapture log;
  builder.set_material(1, wild);
  builder.set_material(1, wild);
  EXPECT_EQ(log.count("'reflectivity' is 1.5"), 1);
  EXPECT_EQ(log.count("'index of refraction' is 100"), 1);
  EXPECT_EQ(log.count("'opacity' is -0.5"), 1);
  builder.set_object(1, object_of(1, "o", {1}));
  const auto scene = builder.commit();
  const Material& m = scene->materials[1];
  EXPECT_EQ(m.optical, vec3(1.0f, 10.0f, 0.0f));
  EXPECT_EQ(m.diffuse.w, 1.0f);
  EXPECT_EQ(m.specular.w, 0.0f);
  EXPECT_EQ(m.alpha_cutoff, 1.0f);
}

TEST(Numbers, OfLightsBecomeWhatShadersUse) {
  Builder builder;
  LightInput spot;
  spot.values.type = LightType::spot;
  spot.values.direction = {0, 0, -10};
  spot.spot_angle = kPi / 3.0f;
  builder.set_light(1, spot);
  spot.spot_angle = 5.0f;  // clamped to a half space
  builder.set_light(2, spot);
  const auto scene = builder.commit();
  EXPECT_EQ(scene->lights[0].direction, vec3(0, 0, -1));
  EXPECT_NEAR(scene->lights[0].cos_outer, std::sqrt(0.75f), 1e-6f);
  EXPECT_NEAR(scene->lights[1].cos_outer, 0.0f, 1e-6f);
  EXPECT_EQ(scene->lights[0].name, "light 1") << "messages need a name";
}

TEST(Numbers, LightsThatCannotShineAreErrors) {
  SceneBuilder builder;
  LightInput sun;
  sun.values.type = LightType::directional;
  sun.values.direction = vec3(0.0f);
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_light(1, sun); }),
               {"direction"});
  LightInput lamp;
  lamp.values.attenuation = vec3(0.0f);
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_light(1, lamp); }),
               {"attenuation", "{0, 0, 1}"});
  lamp.values.attenuation = {1, -1, 1};
  EXPECT_THROW(builder.set_light(1, lamp), Error);
}

TEST(Numbers, OfTheCameraMustSpanAWindow) {
  SceneBuilder builder;
  const auto refused = [&](auto&& change) {
    Camera c;
    change(c);
    failure(ErrorCode::invalid_argument, [&] { builder.set_camera(c); });
  };
  refused([](Camera& c) { c.left = c.right; });
  refused([](Camera& c) { c.top = -2.0f; });
  refused([](Camera& c) { c.near_clip = 0.0f; });
  refused([](Camera& c) { c.far_clip = c.near_clip; });
  refused([](Camera& c) { c.world_from_camera[0] = vec3(0.0f); });
  Camera behind;
  behind.projection = Projection::orthographic;
  behind.near_clip = -5.0f;
  builder.set_camera(behind);
}

TEST(Numbers, TheCamerasScaleIsIgnored) {
  SceneBuilder builder;
  Camera camera;
  camera.world_from_camera = {{0, 2, 0}, {-2, 0, 0}, {0, 0, 2}, {7, 8, 9}};
  builder.set_camera(camera);
  EXPECT_EQ(builder.commit()->camera.world_from_camera,
            mat4x3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {7, 8, 9}));
}

TEST(Numbers, AWorldNeedsTheTexturesOfItsKind) {
  SceneBuilder builder;
  WorldInput world;
  world.values.kind = WorldKind::equirectangular;
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_world(world); }),
               {"textures[0]"});
  world.values.kind = WorldKind::cube;
  for (int i = 0; i < 5; ++i) world.textures[i] = 1;
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_world(world); }), {"six"});
  world.textures[5] = 1;
  world.values.map_from_world = mat3(0.0f);
  expect_words(failure(ErrorCode::invalid_argument, [&] { builder.set_world(world); }),
               {"map_from_world"});
}

// ---- Objects and units --------------------------------------------------------------------------

TEST(Objects, WithoutSurfaceAreNotRendered) {
  Builder builder;
  builder.set_mesh(2, {.name = "empty"});
  builder.set_object(1, object_of(2, "nothing"));
  builder.set_object(2, object_of(1, "something"));
  const LogCapture log;
  const auto scene = builder.commit();
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].name, "something");
  EXPECT_EQ(scene->units.size(), 1u);
  EXPECT_TRUE(log.messages().empty()) << "an empty mesh is nothing to warn of";
}

TEST(Objects, WithoutInverseAreNotRenderedWithOneWarning) {
  Builder builder;
  ObjectInput flat = object_of(1, "flattened");
  flat.world_from_object[2] = vec3(0.0f);
  builder.set_object(1, flat);
  ObjectInput sheared = object_of(1, "collapsed");
  sheared.world_from_object[1] = 2.0f * sheared.world_from_object[0];
  builder.set_object(2, sheared);
  ObjectInput small = object_of(1, "small");
  small.world_from_object = mat4x3(1e-4f);
  small.world_from_object[2] = {0, 0, 1e-9f};
  builder.set_object(3, small);
  const LogCapture log;
  builder.commit();
  const auto scene = builder.commit();
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].name, "small");
  EXPECT_EQ(log.count("flattened"), 1);
  EXPECT_EQ(log.count("collapsed"), 1);
}

TEST(Objects, KnowWhetherTheyAreMirrored) {
  Builder builder;
  builder.set_object(1, object_of(1, "plain"));
  ObjectInput mirrored = object_of(1, "mirrored");
  mirrored.world_from_object[0].x = -1.0f;
  builder.set_object(2, mirrored);
  const auto scene = builder.commit();
  EXPECT_FALSE(scene->objects[0].flips_orientation);
  EXPECT_TRUE(scene->objects[1].flips_orientation);
}

TEST(Objects, EverySlotOfTheMeshHasAMaterial) {
  Builder builder;
  Square square;
  square.slots = {1, 3};
  builder.set_mesh(1, square.input());
  builder.set_material(5, material_called("red"));
  builder.set_object(1, object_of(1, "o", {0, 5}));
  EXPECT_EQ(builder.commit()->objects[0].materials, (std::vector<int>{0, 1, 0, 0}));
}

TEST(Objects, MovingAnUnknownOneIsAnError) {
  SceneBuilder builder;
  expect_words(
      failure(ErrorCode::invalid_argument, [&] { builder.set_object_transform(3, mat4x3(1.0f)); }),
      {"3", "kestrelSetObject"});
}

TEST(Units, GatherObjectsOfTheirName) {
  Builder builder;
  MaterialInput mirror = material_called("mirror");
  mirror.values.optical.x = 0.5f;
  builder.set_material(1, mirror);
  MaterialInput glass = material_called("glass");
  glass.values.optical.z = 0.2f;
  builder.set_material(2, glass);
  for (uint64_t id = 1; id <= 3; ++id) {
    ObjectInput leaf = object_of(1, fmt::format("leaf {}", id), {id - 1});
    leaf.unit = "tree";
    leaf.world_from_object[3] = vec3(10.0f * static_cast<float>(id), 0, 0);
    builder.set_object(id, leaf);
  }
  builder.set_object(4, object_of(1, "stone"));
  const auto scene = builder.commit();
  ASSERT_EQ(scene->units.size(), 2u);
  const Unit& tree = scene->units[0];
  EXPECT_EQ(tree.name, "tree");
  EXPECT_EQ(tree.bounds.lower, vec3(10, 0, 0));
  EXPECT_EQ(tree.bounds.upper, vec3(31, 1, 0));
  EXPECT_TRUE(tree.reflective);
  EXPECT_TRUE(tree.refractive);
  EXPECT_EQ(scene->units[1].name, "stone");
  EXPECT_FALSE(scene->units[1].reflective);
  EXPECT_FALSE(scene->units[1].refractive);
  EXPECT_EQ(scene->objects[2].unit, 0);
  EXPECT_EQ(scene->objects[3].unit, 1);
}

TEST(Units, CountOnlyMaterialsOfSlotsInUse) {
  Builder builder;
  MaterialInput mirror = material_called("mirror");
  mirror.values.optical.x = 0.5f;
  builder.set_material(1, mirror);
  builder.set_object(1, object_of(1, "o", {0, 1}));
  EXPECT_FALSE(builder.commit()->units[0].reflective);
}

TEST(Units, TheLastSettingOfAnyMemberDecides) {
  Builder builder;
  for (uint64_t id = 1; id <= 2; ++id) {
    ObjectInput leaf = object_of(1, fmt::format("leaf {}", id));
    leaf.unit = "tree";
    builder.set_object(id, leaf);
  }
  builder.set_object_setting(2, "relevance", "5");
  builder.set_object_setting(1, "relevance", "7");
  builder.set_object_setting(2, "shadows", "never");
  EXPECT_EQ(builder.commit()->units[0].settings.relevance, 7.0f);
  builder.set_object_setting(2, "relevance", "3");
  const auto scene = builder.commit();
  EXPECT_EQ(scene->units[0].settings.relevance, 3.0f);
  EXPECT_EQ(scene->units[0].settings.shadows, EffectMode::never);
}

TEST(Units, SettingsOutliveSettingTheObjectAgainAndGoWithIt) {
  Builder builder;
  builder.set_object(1, object_of(1, "o"));
  builder.set_object_setting(1, "relevance", "9");
  builder.set_object(1, object_of(1, "o"));
  EXPECT_EQ(builder.commit()->units[0].settings.relevance, 9.0f);
  builder.remove(ItemKind::object, 1);
  builder.set_object(1, object_of(1, "o"));
  EXPECT_EQ(builder.commit()->units[0].settings.relevance, 1.0f);
}

TEST(Units, BadSettingsAreErrorsAtOnce) {
  Builder builder;
  builder.set_object(1, object_of(1, "o"));
  expect_words(failure(ErrorCode::invalid_argument,
                       [&] { builder.set_object_setting(1, "relevanse", "1"); }),
               {"relevanse", "relevance"});
  EXPECT_THROW(builder.set_object_setting(1, "relevance", "lots"), Error);
  EXPECT_THROW(builder.set_object_setting(2, "relevance", "1"), Error) << "no such object";
}

TEST(Settings, AreReadBackAndReachTheScene) {
  Builder builder;
  builder.set_setting("max_depth", "3");
  EXPECT_EQ(builder.setting("max_depth"), "3");
  EXPECT_THROW(builder.set_setting("max_depth", "zero"), Error);
  EXPECT_THROW(builder.set_setting("no_such_setting", "1"), Error);
  EXPECT_EQ(builder.commit()->settings.max_depth, 3);
}

}  // namespace
}  // namespace kestrel
