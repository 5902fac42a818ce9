// SPDX-License-Identifier: GPL-3.0-or-later
// Textures as a host hands them over, and what a scene gets of them.
#include "image_files.h"
#include "log_capture.h"
#include "scene_builder_fixture.h"

namespace kestrel {
namespace {

using test::LogCapture;
using test::TemporaryFolder;

/// A material `id` whose diffuse texture is `texture`.
void use_texture(SceneBuilder& builder, uint64_t id, uint64_t texture) {
  MaterialInput input = material_called(fmt::format("material {}", id));
  input.diffuse_texture = texture;
  builder.set_material(id, input);
}

TEST(Textures, AFileIsDecodedOnceUnderAllItsIds) {
  const TemporaryFolder folder;
  const std::string path =
      test::save(folder.file("a.png"), test::make_png(1, 1, test::kPngGrey, 8, {50}));
  Builder builder;
  builder.set_texture_file(1, path, {.name = "one"});
  builder.set_texture_file(2, path, {.name = "two"});
  builder.set_texture_file(3, path, {.name = "three", .srgb = true});
  for (uint64_t id = 1; id <= 3; ++id) use_texture(builder, id, id);
  const auto scene = builder.commit();
  EXPECT_EQ(scene->textures.size(), 2u) << "one for each way to read it";
  EXPECT_EQ(scene->materials[1].diffuse_texture, scene->materials[2].diffuse_texture);
  EXPECT_NE(scene->materials[1].diffuse_texture, scene->materials[3].diffuse_texture);
  EXPECT_EQ(scene->textures[0]->texels8, (std::vector<uint8_t>{50, 50, 50})) << "opaque: no alpha";
}

TEST(Textures, ACommitCanBeCancelledAndTriedAgain) {
  const TemporaryFolder folder;
  Builder builder;
  for (uint64_t id = 1; id <= 8; ++id) {
    const std::string name = fmt::format("{}.png", id);
    builder.set_texture_file(
        id, test::save(folder.file(name.c_str()), test::make_png(1, 1, test::kPngGrey, 8, {50})),
        {.name = name});
    use_texture(builder, id, id);
  }
  try {
    builder.commit([] { return true; });
    FAIL() << "it was not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(builder.published(), nullptr);
  EXPECT_EQ(builder.commit()->textures.size(), 8u);
}

TEST(Textures, AFileSetAgainIsReadAgainOnlyWhenItChanged) {
  const TemporaryFolder folder;
  const std::string path =
      test::save(folder.file("a.png"), test::make_png(1, 1, test::kPngGrey, 8, {50}));
  Builder builder;
  use_texture(builder, 1, 1);
  builder.set_texture_file(1, path, {});
  const auto first = builder.commit()->textures[0];
  builder.set_texture_file(1, path, {});
  EXPECT_EQ(builder.commit()->textures[0], first);
  test::save(path, test::make_png(2, 1, test::kPngGrey, 8, {60, 70}));
  EXPECT_EQ(builder.commit()->textures[0], first) << "it was not set again";
  builder.set_texture_file(1, path, {});
  EXPECT_EQ(builder.commit()->textures[0]->width, 2);
}

TEST(Textures, AMissingFileIsMagentaWithOneWarning) {
  const LogCapture log;
  Builder builder;
  builder.set_texture_file(1, "/nowhere/bricks.png", {.name = "bricks"});
  builder.set_texture_file(2, "/nowhere/bricks.png", {.name = "bricks"});
  use_texture(builder, 1, 1);
  use_texture(builder, 2, 2);
  const auto scene = builder.commit();
  EXPECT_EQ(builder.commit()->textures, scene->textures);
  EXPECT_EQ(scene->textures[0]->texels8, (std::vector<uint8_t>{255, 0, 255, 255}));
  EXPECT_EQ(log.messages().size(), 1u);
  EXPECT_EQ(log.count("/nowhere/bricks.png"), 1);
}

TEST(Textures, AnUnreadableOneIsMagentaWithOneWarning) {
  const LogCapture log;
  Builder builder;
  const uint8_t junk[] = {'j', 'u', 'n', 'k'};
  builder.set_texture_memory(1, junk, {.name = "packed"});
  use_texture(builder, 1, 1);
  EXPECT_EQ(builder.commit()->textures[0]->texels8, (std::vector<uint8_t>{255, 0, 255, 255}));
  builder.commit();
  EXPECT_EQ(log.messages().size(), 1u);
  EXPECT_EQ(log.count("packed"), 1);
}

TEST(Textures, MayBeReplacedAndFreedWhileTheyAreDecoded) {
  const TemporaryFolder folder;
  const LogCapture log;
  std::vector<std::string> paths;
  for (uint8_t i = 0; i < 40; ++i) {
    const test::Bytes texels(64 * 64, i);
    paths.push_back(test::save(folder.file(fmt::format("{}.png", i)),
                               test::make_png(64, 64, test::kPngGrey, 8, texels)));
  }
  for (int round = 0; round < 5; ++round) {
    Builder builder;
    for (const std::string& path : paths) builder.set_texture_file(1, path, {});
    for (uint64_t id = 2; id < 40; ++id) builder.set_texture_file(id, paths[id], {});
    use_texture(builder, 1, 1);
    if (round % 2) continue;  // freed before it was ever committed
    EXPECT_EQ(builder.commit()->textures[0]->texels8[0], 39) << "the last that was set";
  }
  EXPECT_TRUE(log.messages().empty());
}

TEST(Textures, ThatNothingUsesAreNotMissed) {
  const LogCapture log;
  Builder builder;
  builder.set_texture_file(1, "/nowhere/unused.png", {});
  EXPECT_TRUE(builder.commit()->textures.empty());
  EXPECT_TRUE(log.messages().empty());
  WorldInput sky;
  sky.values.kind = WorldKind::equirectangular;
  sky.textures[0] = 1;
  builder.set_world(sky);
  const auto scene = builder.commit();
  EXPECT_EQ(scene->world.textures[0], 0);
  EXPECT_EQ(scene->world.textures[1], kNone);
  EXPECT_EQ(log.messages().size(), 1u);
}

TEST(Textures, FromMemoryEqualThoseFromFiles) {
  const TemporaryFolder folder;
  const test::Bytes png = test::make_png(2, 1, test::kPngRgba, 8, {1, 2, 3, 4, 5, 6, 7, 8});
  Builder builder;
  builder.set_texture_file(1, test::save(folder.file("a.png"), png), {});
  builder.set_texture_memory(2, png, {});
  use_texture(builder, 1, 1);
  use_texture(builder, 2, 2);
  const auto scene = builder.commit();
  ASSERT_EQ(scene->textures.size(), 2u);
  EXPECT_EQ(scene->textures[0]->texels8, scene->textures[1]->texels8);
  EXPECT_EQ(scene->textures[0]->channels8, 4) << "not opaque: with alpha";
}

TEST(Textures, FloatsThatAreNotFiniteAreReplaced) {
  const LogCapture log;
  Builder builder;
  const float texel[] = {kNan, kInf, -kInf, 1.0f};
  builder.set_texture_pixels_float(1, 1, 1, texel, {.name = "hot"});
  use_texture(builder, 1, 1);
  EXPECT_EQ(builder.commit()->textures[0]->texels_float,
            (std::vector<float>{0.0f, 65504.0f, -65504.0f, 1.0f}));
  EXPECT_EQ(log.count("3 values"), 1);
}

}  // namespace
}  // namespace kestrel
