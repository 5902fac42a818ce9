// SPDX-License-Identifier: GPL-3.0-or-later
// The C interface as a host sees it: what it promises, and every function misused.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "image_files.h"
#include "kestrel/kestrel.h"

namespace {

using kestrel::test::Bytes;
using kestrel::test::TemporaryFolder;

constexpr size_t kHuge = std::numeric_limits<size_t>::max();

/// The last error's text, after checking its code.
std::string last_error(KestrelError expected) {
  const char* message = nullptr;
  EXPECT_EQ(kestrelGetError(&message), expected) << message;
  EXPECT_NE(message, nullptr);
  return message ? message : "";
}

/// A call that must fail with `code` and a text that holds every one of `words`.
void expect_failure(KestrelError result, KestrelError code,
                    const std::vector<std::string>& words = {}) {
  EXPECT_EQ(result, code);
  const std::string text = last_error(code);
  EXPECT_FALSE(text.empty());
  for (const std::string& word : words) {
    EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
  }
}
void expect_invalid(KestrelError result, const std::vector<std::string>& words = {}) {
  expect_failure(result, KESTREL_ERROR_INVALID_ARGUMENT, words);
}
/// After a call that returns no code.
void expect_invalid(const std::vector<std::string>& words = {}) {
  expect_failure(KESTREL_ERROR_INVALID_ARGUMENT, KESTREL_ERROR_INVALID_ARGUMENT, words);
}

void expect_ok(KestrelError result) {
  const char* message = nullptr;
  EXPECT_EQ(result, KESTREL_ERROR_NONE) << (kestrelGetError(&message), message);
}

/// A unit square in the plane z = 0 around the origin.
constexpr float kPositions[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
constexpr uint32_t kTriangles[] = {0, 1, 2, 0, 2, 3};
constexpr float kIdentity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

KestrelMesh square() {
  return {.name = "square",
          .vertex_count = 4,
          .positions = kPositions,
          .triangle_count = 2,
          .triangles = kTriangles};
}

/// Looks down on 2 x 2 metres around the origin.
KestrelCamera camera_above() {
  return {.projection = KESTREL_ORTHOGRAPHIC,
          .world_from_camera = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 5},
          .left = -1,
          .right = 1,
          .bottom = -1,
          .top = 1,
          .near_clip = 0.1f,
          .far_clip = 10};
}

KestrelObject object_of(uint64_t mesh, const uint64_t* material = nullptr) {
  KestrelObject object = {.name = "object",
                          .mesh = mesh,
                          .materials = material,
                          .material_count = material ? size_t{1} : size_t{0}};
  std::memcpy(object.world_from_object, kIdentity, sizeof(kIdentity));
  return object;
}

constexpr KestrelTextureOptions kOptions = {.name = "texture"};

class Api : public testing::Test {
 protected:
  void SetUp() override {
    kestrelGetError(nullptr);
    device = kestrelNewDevice();
    ASSERT_NE(device, nullptr);
    scene = kestrelNewScene(device);
    renderer = kestrelNewRenderer(scene);
    ASSERT_NE(renderer, nullptr);
  }
  void TearDown() override {
    kestrelReleaseRenderer(renderer);
    kestrelReleaseScene(scene);
    kestrelReleaseDevice(device);
    kestrelSetLogCallback(nullptr, nullptr);
    kestrelSetLogLevel(KESTREL_LOG_WARNING);
  }

  /// A square that glows in (0.25, 0.5, 2), and settings for a quick exact picture.
  void set_glowing_square() {
    const KestrelMesh mesh = square();
    expect_ok(kestrelSetMesh(scene, 1, &mesh));
    KestrelMaterial material;
    kestrelDefaultMaterial(&material);
    const float glow[3] = {0.25f, 0.5f, 2.0f};
    std::memcpy(material.emission, glow, sizeof(glow));
    expect_ok(kestrelSetMaterial(scene, 1, &material));
    const uint64_t id = 1;
    const KestrelObject object = object_of(1, &id);
    expect_ok(kestrelSetObject(scene, 1, &object));
    const KestrelCamera camera = camera_above();
    expect_ok(kestrelSetCamera(scene, &camera));
    expect_ok(kestrelSetSetting(scene, "primary", "rays"));
    expect_ok(kestrelSetSetting(scene, "samples", "1"));
    expect_ok(kestrelCommitScene(scene));
  }

  KestrelDevice device = nullptr;
  KestrelScene scene = nullptr;
  KestrelRenderer renderer = nullptr;
};

// ---- Library and device -------------------------------------------------------------------------

TEST_F(Api, SaysItsVersionAndParameters) {
  EXPECT_STREQ(kestrelGetVersion(), KESTREL_VERSION);
  EXPECT_EQ(kestrelGetAbiVersion(), uint32_t{KESTREL_ABI_VERSION});
  const std::string table = kestrelGetParameterTable();
  EXPECT_NE(table.find("\"budget_ms\""), std::string::npos);
  EXPECT_NE(table.find("\"relevance\""), std::string::npos);
}

TEST_F(Api, ErrorsAreOfTheThreadAndForgottenOnceRead) {
  kestrelCommitScene(nullptr);
  std::thread([] {
    const char* message = nullptr;
    EXPECT_EQ(kestrelGetError(&message), KESTREL_ERROR_NONE);
    EXPECT_STREQ(message, "");
  }).join();
  expect_ok(kestrelSetSetting(scene, "samples", "1"));  // success does not clear it
  EXPECT_EQ(kestrelGetError(nullptr), KESTREL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kestrelGetError(nullptr), KESTREL_ERROR_NONE);
}

TEST_F(Api, DeviceInfoNamesVersions) {
  const std::string info = kestrelGetDeviceInfo(device);
  for (const char* key : {"\"kestrel\"", "\"embree\"", "\"gl\"", "\"threads\""}) {
    EXPECT_NE(info.find(key), std::string::npos) << key;
  }
  EXPECT_EQ(kestrelGetDeviceInfo(nullptr), nullptr);
  expect_invalid({"Device", "NULL"});
}

TEST_F(Api, FingerprintsOfBytes) {
  uint64_t whole[2] = {0, 0}, parts[2] = {0, 0}, other[2] = {0, 0};
  expect_ok(kestrelHash("kestrel", 7, whole));
  expect_ok(kestrelHash("kestrel", 7, parts));
  EXPECT_EQ(whole[0], parts[0]);
  EXPECT_EQ(whole[1], parts[1]);
  expect_ok(kestrelHash("kestrem", 7, other));
  EXPECT_NE(whole[0], other[0]);
  EXPECT_NE(whole[1], other[1]);
  expect_ok(kestrelHash(nullptr, 0, parts));
  EXPECT_NE(whole[0], parts[0]);
  expect_invalid(kestrelHash(nullptr, 7, other), {"data", "NULL"});
  expect_invalid(kestrelHash("kestrel", 7, nullptr), {"hash", "NULL"});
}

struct Messages {
  std::vector<std::string> texts;
  std::atomic<int> refused = 0;
};

void collect(void* user, KestrelLogLevel level, const char* text) {
  EXPECT_EQ(level, KESTREL_LOG_WARNING);
  static_cast<Messages*>(user)->texts.emplace_back(text);
  kestrelSetLogCallback(nullptr, nullptr);  // must not be called here
  static_cast<Messages*>(user)->refused += kestrelGetError(nullptr) != KESTREL_ERROR_NONE;
}

TEST_F(Api, LogMessagesGoToTheCallbackUntilItIsReplaced) {
  Messages messages;
  kestrelSetLogCallback(collect, &messages);
  KestrelMaterial material;
  kestrelDefaultMaterial(&material);
  material.name = "logged";
  material.optical[0] = 7.0f;  // clamped, with a warning
  expect_ok(kestrelSetMaterial(scene, 1, &material));
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_NE(messages.texts[0].find("logged"), std::string::npos);
  EXPECT_EQ(messages.refused, 1);
  kestrelSetLogLevel(KESTREL_LOG_ERROR);
  material.name = "not logged";
  expect_ok(kestrelSetMaterial(scene, 1, &material));
  kestrelSetLogLevel(KESTREL_LOG_WARNING);
  kestrelSetLogCallback(nullptr, nullptr);
  EXPECT_EQ(messages.texts.size(), 1u);
}

TEST_F(Api, BadLogLevelsAreErrors) {
  kestrelSetLogLevel(static_cast<KestrelLogLevel>(7));
  expect_invalid({"7"});
}

// ---- Handles ------------------------------------------------------------------------------------

TEST_F(Api, ReleasingNullDoesNothing) {
  kestrelReleaseDevice(nullptr);
  kestrelReleaseScene(nullptr);
  kestrelReleaseRenderer(nullptr);
  EXPECT_EQ(kestrelGetError(nullptr), KESTREL_ERROR_NONE);
}

TEST_F(Api, NullHandlesAreErrors) {
  kestrelRetainDevice(nullptr);
  expect_invalid({"kestrelNewDevice"});
  kestrelRetainScene(nullptr);
  expect_invalid({"kestrelNewScene"});
  kestrelRetainRenderer(nullptr);
  expect_invalid({"kestrelNewRenderer"});
  EXPECT_EQ(kestrelNewScene(nullptr), nullptr);
  expect_invalid();
  EXPECT_EQ(kestrelNewRenderer(nullptr), nullptr);
  expect_invalid();
  const KestrelMesh mesh = square();
  expect_invalid(kestrelSetMesh(nullptr, 1, &mesh));
  expect_invalid(kestrelSetTextureFile(nullptr, 1, "a.png", &kOptions));
  expect_invalid(kestrelSetTextureMemory(nullptr, 1, "x", 1, &kOptions));
  const uint8_t texel[4] = {};
  expect_invalid(kestrelSetTexturePixels8(nullptr, 1, 1, 1, texel, &kOptions));
  const float texel_float[4] = {};
  expect_invalid(kestrelSetTexturePixelsFloat(nullptr, 1, 1, 1, texel_float, &kOptions));
  KestrelMaterial material;
  kestrelDefaultMaterial(&material);
  expect_invalid(kestrelSetMaterial(nullptr, 1, &material));
  KestrelLight light;
  kestrelDefaultLight(&light);
  expect_invalid(kestrelSetLight(nullptr, 1, &light));
  const KestrelObject object = object_of(1);
  expect_invalid(kestrelSetObject(nullptr, 1, &object));
  expect_invalid(kestrelSetObjectTransform(nullptr, 1, kIdentity));
  const uint64_t ids[] = {1};
  expect_invalid(kestrelSetObjects(nullptr, ids, kIdentity, 1, &object));
  expect_invalid(kestrelSetObjectTransforms(nullptr, ids, kIdentity, 1));
  expect_invalid(kestrelRemoveItems(nullptr, KESTREL_KIND_OBJECT, ids, 1));
  expect_invalid(kestrelSetObjectSetting(nullptr, 1, "relevance", "1"));
  expect_invalid(kestrelRemove(nullptr, KESTREL_KIND_MESH, 1));
  const KestrelCamera camera = camera_above();
  expect_invalid(kestrelSetCamera(nullptr, &camera));
  const KestrelWorld world = {};
  expect_invalid(kestrelSetWorld(nullptr, &world));
  expect_invalid(kestrelSetSetting(nullptr, "samples", "1"));
  EXPECT_EQ(kestrelGetSetting(nullptr, "samples"), nullptr);
  expect_invalid();
  expect_invalid(kestrelCommitScene(nullptr));
  kestrelCancelCommit(nullptr);
  expect_invalid();
  expect_invalid(kestrelRender(nullptr, 1, 1, nullptr, nullptr));
  kestrelCancel(nullptr);
  expect_invalid();
  int size = 0;
  expect_invalid(kestrelGetFrameSize(nullptr, &size, &size));
  EXPECT_EQ(kestrelGetPassCount(nullptr), 0u);
  expect_invalid();
  EXPECT_EQ(kestrelGetPassName(nullptr, 0), nullptr);
  expect_invalid();
  EXPECT_EQ(kestrelGetPassChannels(nullptr, "Combined"), nullptr);
  expect_invalid();
  float pixel[4];
  expect_invalid(kestrelReadPass(nullptr, "Combined", pixel, 4));
  expect_invalid(kestrelSetRegion(nullptr, 0, 0, 1, 1));
  expect_invalid(kestrelReadPassSoFar(nullptr, "Combined", pixel, 4));
  EXPECT_EQ(kestrelGetPassPixels(nullptr, "Combined"), nullptr);
  expect_invalid();
  EXPECT_EQ(kestrelGetStats(nullptr), nullptr);
  expect_invalid();
  expect_invalid(kestrelWriteImage(nullptr, "a.exr", "all"));
}

TEST_F(Api, ReleasedAndMixedUpHandlesAreErrors) {
  const KestrelScene other = kestrelNewScene(device);
  kestrelRetainScene(other);
  kestrelReleaseScene(other);
  expect_ok(kestrelSetSetting(other, "samples", "1"));  // one reference is left
  kestrelReleaseScene(other);
  expect_invalid(kestrelSetSetting(other, "samples", "1"), {"released"});
  kestrelReleaseScene(other);
  expect_invalid({"released"});
  expect_invalid(kestrelCommitScene(reinterpret_cast<KestrelScene>(device)), {"another kind"});
  EXPECT_EQ(kestrelNewScene(reinterpret_cast<KestrelDevice>(renderer)), nullptr);
  expect_invalid({"another kind"});
}

TEST_F(Api, ChildrenKeepTheirParents) {
  set_glowing_square();
  kestrelReleaseDevice(device);
  kestrelReleaseScene(scene);
  device = nullptr;
  scene = nullptr;
  expect_ok(kestrelRender(renderer, 4, 4, nullptr, nullptr));
}

// ---- Scene --------------------------------------------------------------------------------------

TEST_F(Api, NullArgumentsAreErrorsThatNameThem) {
  expect_invalid(kestrelSetMesh(scene, 1, nullptr), {"mesh"});
  KestrelMesh mesh = square();
  mesh.positions = nullptr;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"positions"});
  mesh = square();
  mesh.triangles = nullptr;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"triangles"});
  expect_invalid(kestrelSetTextureFile(scene, 1, nullptr, &kOptions), {"path"});
  expect_invalid(kestrelSetTextureFile(scene, 1, "a.png", nullptr), {"options"});
  expect_invalid(kestrelSetTextureMemory(scene, 1, nullptr, 4, &kOptions), {"data"});
  expect_invalid(kestrelSetTexturePixels8(scene, 1, 1, 1, nullptr, &kOptions), {"rgba"});
  expect_invalid(kestrelSetTexturePixelsFloat(scene, 1, 1, 1, nullptr, &kOptions), {"rgba"});
  kestrelDefaultMaterial(nullptr);
  expect_invalid({"material"});
  expect_invalid(kestrelSetMaterial(scene, 1, nullptr), {"material"});
  kestrelDefaultLight(nullptr);
  expect_invalid({"light"});
  expect_invalid(kestrelSetLight(scene, 1, nullptr), {"light"});
  expect_invalid(kestrelSetObject(scene, 1, nullptr), {"object"});
  KestrelObject object = object_of(1);
  object.material_count = 2;
  expect_invalid(kestrelSetObject(scene, 1, &object), {"materials"});
  expect_invalid(kestrelSetObjectTransform(scene, 1, nullptr), {"world_from_object"});
  expect_invalid(kestrelSetObjectSetting(scene, 1, nullptr, "1"), {"name"});
  expect_invalid(kestrelSetObjectSetting(scene, 1, "relevance", nullptr), {"value"});
  expect_invalid(kestrelSetCamera(scene, nullptr), {"camera"});
  expect_invalid(kestrelSetWorld(scene, nullptr), {"world"});
  expect_invalid(kestrelSetSetting(scene, nullptr, "1"), {"name"});
  expect_invalid(kestrelSetSetting(scene, "samples", nullptr), {"value"});
  EXPECT_EQ(kestrelGetSetting(scene, nullptr), nullptr);
  expect_invalid({"name"});
}

TEST_F(Api, BadEnumerationsAreErrors) {
  KestrelTextureOptions options = kOptions;
  options.extension = 3;
  expect_invalid(kestrelSetTextureFile(scene, 1, "a.png", &options), {"KestrelExtension"});
  KestrelMaterial material;
  kestrelDefaultMaterial(&material);
  material.alpha_mode = -1;
  expect_invalid(kestrelSetMaterial(scene, 1, &material), {"KestrelAlphaMode"});
  KestrelLight light;
  kestrelDefaultLight(&light);
  light.type = 99;
  expect_invalid(kestrelSetLight(scene, 1, &light), {"99", "KestrelLightType"});
  KestrelCamera camera = camera_above();
  camera.projection = 2;
  expect_invalid(kestrelSetCamera(scene, &camera), {"KestrelProjection"});
  KestrelWorld world = {};
  world.kind = 5;
  expect_invalid(kestrelSetWorld(scene, &world), {"KestrelWorldKind"});
  expect_invalid(kestrelRemove(scene, static_cast<KestrelKind>(6), 1), {"KestrelKind"});
}

TEST_F(Api, SizesThatOverflowAreErrorsBeforeAnythingIsRead) {
  KestrelMesh mesh = square();
  for (const size_t count : {kHuge, kHuge / 3 + 1, kHuge / 12 + 1, size_t{1} << 40}) {
    mesh = square();
    mesh.vertex_count = count;
    expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"square", "vertices"});
    mesh = square();
    mesh.triangle_count = count;
    expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"square", "triangles"});
    const uint64_t id = 1;
    KestrelObject object = object_of(1, &id);
    object.material_count = count;
    expect_invalid(kestrelSetObject(scene, 1, &object), {"slots"});
  }
  const uint8_t texel[4] = {};
  const float texel_float[4] = {};
  for (const int side : {0, -1, 32769, std::numeric_limits<int>::max()}) {
    expect_invalid(kestrelSetTexturePixels8(scene, 1, side, 1, texel, &kOptions), {"32768"});
    expect_invalid(kestrelSetTexturePixelsFloat(scene, 1, 1, side, texel_float, &kOptions),
                   {"32768"});
  }
}

TEST_F(Api, IndicesOutOfRangeAreErrors) {
  const uint32_t triangles[] = {0, 1, 2, 0, 2, 4};
  KestrelMesh mesh = square();
  mesh.triangles = triangles;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"square", "triangle 1", "4"});
}

TEST_F(Api, UnknownIdsAreErrors) {
  expect_invalid(kestrelSetObjectTransform(scene, 8, kIdentity), {"8"});
  expect_invalid(kestrelSetObjectSetting(scene, 8, "relevance", "1"), {"8"});
  expect_invalid(kestrelRemove(scene, KESTREL_KIND_LIGHT, 8), {"light", "8"});
  const KestrelMesh mesh = square();
  expect_invalid(kestrelSetMesh(scene, 0, &mesh), {"0"});
  set_glowing_square();
  const KestrelObject object = object_of(8);
  expect_ok(kestrelSetObject(scene, 2, &object));
  expect_invalid(kestrelCommitScene(scene), {"object", "mesh 8"});
}

TEST_F(Api, ManyObjectsAreSetMovedAndRemovedAtOnce) {
  set_glowing_square();
  const KestrelObject object = object_of(1);
  const uint64_t ids[] = {2, 3};
  float places[24];
  for (int i = 0; i < 2; ++i) std::memcpy(places + 12 * i, kIdentity, sizeof(kIdentity));
  const auto blue = [&](float x) {
    KestrelCamera camera = camera_above();
    camera.world_from_camera[9] = x;
    expect_ok(kestrelSetCamera(scene, &camera));
    expect_ok(kestrelCommitScene(scene));
    expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
    float pixel[4];
    expect_ok(kestrelReadPass(renderer, "Combined", pixel, 4));
    return pixel[2];
  };
  places[9] = 10.0f;
  places[21] = 20.0f;
  KestrelMaterial material;
  kestrelDefaultMaterial(&material);
  material.emission[2] = 2.0f;
  expect_ok(kestrelSetMaterial(scene, 7, &material));
  const uint64_t glowing = 7;
  const KestrelObject glowing_object = object_of(1, &glowing);
  expect_ok(kestrelSetObjects(scene, ids, places, 2, &glowing_object));
  EXPECT_GT(blue(10.0f), 1.9f);
  EXPECT_GT(blue(20.0f), 1.9f);
  EXPECT_LT(blue(30.0f), 0.1f);
  places[21] = 30.0f;
  expect_ok(kestrelSetObjectTransforms(scene, ids, places, 2));
  EXPECT_GT(blue(10.0f), 1.9f);
  EXPECT_LT(blue(20.0f), 0.1f);
  EXPECT_GT(blue(30.0f), 1.9f);
  expect_ok(kestrelRemoveItems(scene, KESTREL_KIND_OBJECT, ids, 2));
  EXPECT_LT(blue(10.0f), 0.1f);
  expect_ok(kestrelSetObjects(scene, nullptr, nullptr, 0, &object));
  expect_invalid(kestrelSetObjects(scene, nullptr, places, 2, &object), {"ids"});
  expect_invalid(kestrelSetObjects(scene, ids, nullptr, 2, &object), {"world_from_object"});
  expect_invalid(kestrelSetObjects(scene, ids, places, 2, nullptr), {"object"});
  expect_invalid(kestrelSetObjectTransforms(scene, ids, places, 2), {"2"});
  expect_invalid(kestrelRemoveItems(scene, KESTREL_KIND_OBJECT, ids, 2), {"object", "2"});
}

TEST_F(Api, AttributesOfAMeshAreChecked) {
  const float uvs[12] = {}, colors[18] = {};
  KestrelMeshAttribute attributes[] = {{1, 2, uvs}, {1, 3, colors}};
  KestrelMesh mesh = square();
  mesh.attribute_count = 2;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"attributes", "NULL"});
  mesh.attributes = attributes;
  expect_ok(kestrelSetMesh(scene, 1, &mesh));
  attributes[1].channels = 4;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"square", "4 channels"});
  attributes[1].channels = 3;
  attributes[0].values = nullptr;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"values", "NULL"});
  attributes[0] = {0, 2, uvs};
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"square", "0"});
}

TEST_F(Api, NumbersThatAreNotFiniteAreErrors) {
  const float nan = std::nanf("");
  KestrelCamera camera = camera_above();
  camera.top = nan;
  expect_invalid(kestrelSetCamera(scene, &camera), {"top"});
  KestrelWorld world = {.color = {nan, 0, 0}};
  expect_invalid(kestrelSetWorld(scene, &world), {"color"});
}

TEST_F(Api, MotionIsCheckedAndBlurs) {
  set_glowing_square();
  float states[24];
  for (int i = 0; i < 2; ++i) std::memcpy(states + 12 * i, kIdentity, sizeof(kIdentity));
  states[9] = -4.0f;  // out of view until half-way
  states[21] = 4.0f;
  expect_invalid(kestrelSetObjectMotion(scene, 8, states, 2), {"8"});
  expect_invalid(kestrelSetObjectMotion(scene, 1, states, 1), {"2 to 129"});
  expect_invalid(kestrelSetObjectMotion(scene, 1, nullptr, 2), {"world_from_object"});
  KestrelCamera cameras[2] = {camera_above(), camera_above()};
  expect_invalid(kestrelSetCameraMotion(scene, nullptr, 2), {"states"});
  cameras[1].projection = KESTREL_PERSPECTIVE;
  EXPECT_EQ(kestrelSetCameraMotion(scene, cameras, 2), KESTREL_ERROR_INVALID_OPERATION);
  const float broken[24] = {NAN};
  KestrelMesh mesh = square();
  mesh.motion_count = 2;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"motion_positions"});
  mesh.motion_positions = broken;
  expect_invalid(kestrelSetMesh(scene, 1, &mesh), {"square", "step 0"});

  expect_ok(kestrelSetObjectMotion(scene, 1, states, 2));
  expect_ok(kestrelSetSetting(scene, "motion_blur", "true"));
  expect_ok(kestrelSetSetting(scene, "samples", "16"));
  expect_ok(kestrelCommitScene(scene));
  float pixel[4];
  expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
  expect_ok(kestrelReadPass(renderer, "Combined", pixel, 4));
  EXPECT_GT(pixel[2], 0.1f);
  EXPECT_LT(pixel[2], 1.9f);
  expect_ok(kestrelSetObjectMotion(scene, 1, nullptr, 0));
  expect_ok(kestrelCommitScene(scene));
  expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
  expect_ok(kestrelReadPass(renderer, "Combined", pixel, 4));
  EXPECT_NEAR(pixel[2], 2.0f, 1e-5f);
}

TEST_F(Api, SettingsAreTextAndUnknownOnesErrors) {
  expect_ok(kestrelSetSetting(scene, "max_depth", "3"));
  EXPECT_STREQ(kestrelGetSetting(scene, "max_depth"), "3");
  expect_invalid(kestrelSetSetting(scene, "max_depth", "three"), {"three", "max_depth"});
  expect_invalid(kestrelSetSetting(scene, "depth", "3"), {"depth", "max_depth"});
  EXPECT_EQ(kestrelGetSetting(scene, "depth"), nullptr);
  expect_invalid({"depth"});
  EXPECT_STREQ(kestrelGetSetting(scene, "max_depth"), "3") << "errors change nothing";
}

TEST_F(Api, DefaultsAreThoseDocumented) {
  KestrelMaterial material;
  kestrelDefaultMaterial(&material);
  EXPECT_EQ(material.diffuse[0], 0.8f);
  EXPECT_EQ(material.diffuse[3], 1.0f);
  EXPECT_EQ(material.ambient[2], 0.8f);
  EXPECT_EQ(material.specular[0], 0.0f);
  EXPECT_EQ(material.optical[1], 1.0f);
  EXPECT_EQ(material.optical[2], 1.0f);
  EXPECT_EQ(material.tiling[1], 1.0f);
  EXPECT_TRUE(material.casts_shadow);
  KestrelLight light;
  kestrelDefaultLight(&light);
  EXPECT_EQ(light.type, KESTREL_LIGHT_POINT);
  EXPECT_EQ(light.attenuation[2], 1.0f);
  EXPECT_TRUE(light.casts_shadow);
  expect_ok(kestrelSetMaterial(scene, 1, &material));
  expect_ok(kestrelSetLight(scene, 1, &light));
}

TEST_F(Api, NamesThatAreNotUtf8StillRender) {
  set_glowing_square();
  const uint64_t id = 1;
  KestrelObject object = object_of(1, &id);
  object.name = "bad \xff\xc3 name \xe2\x82\xac";
  expect_ok(kestrelSetObject(scene, 1, &object));
  expect_ok(kestrelCommitScene(scene));
  expect_ok(kestrelRender(renderer, 4, 4, nullptr, nullptr));
  const char* stats = kestrelGetStats(renderer);
  ASSERT_NE(stats, nullptr);
  EXPECT_NE(std::string(stats).find("bad ?? name \xe2\x82\xac"), std::string::npos) << stats;
}

// ---- Rendering ----------------------------------------------------------------------------------

TEST_F(Api, RendersTheCommittedScene) {
  set_glowing_square();
  expect_ok(kestrelRender(renderer, 8, 6, nullptr, nullptr));
  int width = 0, height = 0;
  expect_ok(kestrelGetFrameSize(renderer, &width, &height));
  EXPECT_EQ(width, 8);
  EXPECT_EQ(height, 6);
  std::vector<float> pixels(8 * 6 * 4);
  expect_ok(kestrelReadPass(renderer, "Combined", pixels.data(), pixels.size()));
  const float* direct = kestrelGetPassPixels(renderer, "Combined");
  ASSERT_NE(direct, nullptr);
  EXPECT_TRUE(std::equal(pixels.begin(), pixels.end(), direct));
  EXPECT_EQ(kestrelGetPassPixels(renderer, "Beauty"), nullptr);
  expect_invalid({"Beauty"});
  for (size_t i = 0; i < pixels.size(); i += 4) {
    EXPECT_FLOAT_EQ(pixels[i], 0.25f);
    EXPECT_FLOAT_EQ(pixels[i + 1], 0.5f);
    EXPECT_FLOAT_EQ(pixels[i + 2], 2.0f);
    EXPECT_FLOAT_EQ(pixels[i + 3], 1.0f);
  }
  std::vector<float> depth(8 * 6);
  expect_ok(kestrelReadPass(renderer, "Depth", depth.data(), depth.size()));
  EXPECT_NEAR(depth[0], 5.0f, 1e-4f);
  const std::string stats = kestrelGetStats(renderer);
  EXPECT_NE(stats.find("\"stages_ms\""), std::string::npos);
  EXPECT_NE(stats.find("\"object\""), std::string::npos) << "the unit's name";
}

TEST_F(Api, EditsShowOnlyAfterTheCommit) {
  set_glowing_square();
  expect_ok(kestrelRemove(scene, KESTREL_KIND_OBJECT, 1));
  float pixel[4];
  expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
  expect_ok(kestrelReadPass(renderer, "Combined", pixel, 4));
  EXPECT_EQ(pixel[2], 2.0f);
  expect_ok(kestrelCommitScene(scene));
  expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
  expect_ok(kestrelReadPass(renderer, "Combined", pixel, 4));
  EXPECT_EQ(pixel[2], 0.0f);
}

TEST_F(Api, RenderingWithoutACommitSaysWhatToDo) {
  expect_failure(kestrelRender(renderer, 4, 4, nullptr, nullptr), KESTREL_ERROR_INVALID_OPERATION,
                 {"kestrelCommitScene"});
  expect_failure(kestrelCommitScene(scene), KESTREL_ERROR_INVALID_OPERATION, {"kestrelSetCamera"});
}

TEST_F(Api, PictureSizesOutOfRangeAreErrors) {
  set_glowing_square();
  for (const int side : {0, -1, 65537, std::numeric_limits<int>::max()}) {
    expect_invalid(kestrelRender(renderer, side, 4, nullptr, nullptr), {"65536"});
    expect_invalid(kestrelRender(renderer, 4, side, nullptr, nullptr), {"65536"});
  }
}

TEST_F(Api, ReadingBeforeTheFirstFrameSaysWhatToDo) {
  set_glowing_square();
  int size = 0;
  float pixel[4];
  const TemporaryFolder folder;
  const auto expect_no_frame = [](KestrelError result) {
    expect_failure(result, KESTREL_ERROR_INVALID_OPERATION, {"kestrelRender"});
  };
  expect_no_frame(kestrelGetFrameSize(renderer, &size, &size));
  expect_no_frame(kestrelReadPass(renderer, "Combined", pixel, 4));
  expect_no_frame(kestrelWriteImage(renderer, folder.file("a.exr").c_str(), "all"));
  EXPECT_EQ(folder.file_count(), 0u);
  EXPECT_EQ(kestrelGetStats(renderer), nullptr);
  expect_no_frame(KESTREL_ERROR_INVALID_OPERATION);
}

TEST_F(Api, PassesAreListedAndUnknownOnesErrors) {
  const size_t count = kestrelGetPassCount(renderer);
  ASSERT_GT(count, 10u);
  for (size_t i = 0; i < count; ++i) {
    const char* name = kestrelGetPassName(renderer, i);
    ASSERT_NE(name, nullptr);
    const char* channels = kestrelGetPassChannels(renderer, name);
    ASSERT_NE(channels, nullptr);
    EXPECT_GE(std::strlen(channels), 1u);
  }
  EXPECT_STREQ(kestrelGetPassChannels(renderer, "Combined"), "RGBA");
  EXPECT_EQ(kestrelGetPassName(renderer, count), nullptr);
  expect_invalid({std::to_string(count)});
  EXPECT_EQ(kestrelGetPassName(renderer, kHuge), nullptr);
  expect_invalid();
  EXPECT_EQ(kestrelGetPassChannels(renderer, "Beauty"), nullptr);
  expect_invalid({"Beauty", "Combined"});
  EXPECT_EQ(kestrelGetPassChannels(renderer, nullptr), nullptr);
  expect_invalid({"name"});
}

TEST_F(Api, CryptomatteSaysWhatItsIdsMean) {
  set_glowing_square();
  EXPECT_EQ(kestrelGetCryptomatteManifest(renderer, "CryptoObject"), nullptr);
  expect_failure(KESTREL_ERROR_INVALID_OPERATION, KESTREL_ERROR_INVALID_OPERATION, {});
  expect_ok(kestrelSetPasses(renderer, "CryptoObject01"));
  expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
  EXPECT_NE(kestrelGetPassPixels(renderer, "CryptoObject00"), nullptr);  // comes along
  const char* manifest = kestrelGetCryptomatteManifest(renderer, "CryptoObject");
  ASSERT_NE(manifest, nullptr);
  EXPECT_EQ(std::string(manifest).find("{\"object\":\""), 0u) << manifest;
  EXPECT_EQ(kestrelGetCryptomatteManifest(renderer, "CryptoAsset"), nullptr);
  expect_failure(KESTREL_ERROR_INVALID_OPERATION, KESTREL_ERROR_INVALID_OPERATION,
                 {"CryptoAsset00", "kestrelSetPasses"});
  for (const char* layer : {"CryptoObject00", "Beauty", static_cast<const char*>(nullptr)}) {
    EXPECT_EQ(kestrelGetCryptomatteManifest(renderer, layer), nullptr);
    expect_invalid();
  }
  EXPECT_EQ(kestrelGetCryptomatteManifest(nullptr, "CryptoObject"), nullptr);
  expect_invalid();
  EXPECT_EQ(kestrelGetCryptomatteHash("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(kestrelGetCryptomatteHash(nullptr), 0u);
  expect_invalid({"name"});
}

TEST_F(Api, OnlyWantedPassesAreKept) {
  set_glowing_square();
  expect_ok(kestrelSetPasses(renderer, "Combined,Depth"));
  expect_invalid(kestrelSetPasses(renderer, "Combined,Beauty"), {"Beauty"});
  expect_invalid(kestrelSetPasses(renderer, nullptr), {"passes"});
  expect_invalid(kestrelSetPasses(nullptr, "all"));
  expect_ok(kestrelRender(renderer, 1, 1, nullptr, nullptr));
  float values[4];
  expect_ok(kestrelReadPass(renderer, "Combined", values, 4));
  expect_ok(kestrelReadPass(renderer, "Depth", values, 1));
  expect_invalid(kestrelReadPass(renderer, "Normal", values, 3), {"Normal", "kestrelSetPasses"});
  const TemporaryFolder folder;
  expect_ok(kestrelWriteImage(renderer, folder.file("a.exr").c_str(), "all"));
  expect_invalid(kestrelWriteImage(renderer, folder.file("b.exr").c_str(), "Combined,Normal"),
                 {"Normal"});
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST_F(Api, ReadingAPassChecksItsArguments) {
  set_glowing_square();
  expect_ok(kestrelRender(renderer, 2, 3, nullptr, nullptr));
  std::vector<float> pixels(2 * 3 * 4 + 1);
  expect_invalid(kestrelReadPass(renderer, "Beauty", pixels.data(), 24), {"Beauty"});
  expect_invalid(kestrelReadPass(renderer, nullptr, pixels.data(), 24), {"name"});
  expect_invalid(kestrelReadPass(renderer, "Combined", nullptr, 24), {"pixels"});
  expect_invalid(kestrelReadPass(renderer, "Combined", pixels.data(), 25), {"24", "25"});
  expect_invalid(kestrelReadPass(renderer, "Combined", pixels.data(), 0), {"24"});
  int size = 0;
  expect_invalid(kestrelGetFrameSize(renderer, nullptr, &size), {"width"});
  expect_invalid(kestrelGetFrameSize(renderer, &size, nullptr), {"height"});
}

/// What a progress callback sees and does.
struct Watch {
  KestrelRenderer renderer = nullptr;
  std::atomic<int> calls = 0;
  std::atomic<float> last = 0.0f;
  bool go_on = true;
  bool cancel = false;
  bool use_renderer = false;
  std::atomic<int> refused = 0;
};

bool watch(void* user, float fraction, const char* status) {
  Watch& w = *static_cast<Watch*>(user);
  EXPECT_GE(fraction, 0.0f);
  EXPECT_LE(fraction, 1.0f);
  EXPECT_NE(status, nullptr);
  ++w.calls;
  w.last = fraction;
  if (w.cancel) std::thread([&w] { kestrelCancel(w.renderer); }).join();
  if (w.use_renderer) {
    float pixel[4];
    w.refused +=
        kestrelReadPass(w.renderer, "Combined", pixel, 4) == KESTREL_ERROR_INVALID_OPERATION;
    w.refused +=
        kestrelRender(w.renderer, 1, 1, nullptr, nullptr) == KESTREL_ERROR_INVALID_OPERATION;
    w.use_renderer = false;
  }
  return w.go_on;
}

TEST_F(Api, ProgressIsReported) {
  set_glowing_square();
  Watch w;
  expect_ok(kestrelRender(renderer, 64, 64, watch, &w));
  EXPECT_GT(w.calls, 0);
}

TEST_F(Api, APictureCanBeReadWhileItIsMade) {
  set_glowing_square();
  std::vector<float> pixels(64 * 64 * 4, -1.0f);
  const auto read = [&] {
    return kestrelReadPassSoFar(renderer, "Combined", pixels.data(), pixels.size());
  };
  expect_failure(read(), KESTREL_ERROR_INVALID_OPERATION);
  std::atomic<bool> done = false;
  std::thread reader([&] {
    while (!done) {
      if (read() != KESTREL_ERROR_NONE) continue;
      for (size_t i = 0; i < pixels.size(); i += 4) {
        EXPECT_TRUE(pixels[i] == -1.0f || pixels[i] == 0.25f) << pixels[i];
      }
    }
  });
  for (int i = 0; i < 20; ++i) expect_ok(kestrelRender(renderer, 64, 64, nullptr, nullptr));
  done = true;
  reader.join();
  expect_ok(read());
  EXPECT_EQ(pixels[2], 2.0f);
  expect_invalid(kestrelReadPassSoFar(renderer, "Combined", nullptr, pixels.size()));
  expect_invalid(kestrelReadPassSoFar(renderer, "Combined", pixels.data(), 4));
  expect_invalid(kestrelReadPassSoFar(renderer, "Nothing", pixels.data(), pixels.size()));
}

TEST_F(Api, RegionsThatCannotBeAreErrors) {
  set_glowing_square();
  expect_invalid(kestrelSetRegion(renderer, -1, 0, 2, 2));
  expect_invalid(kestrelSetRegion(renderer, 0, 0, 2, 0));
  expect_ok(kestrelSetRegion(renderer, 3, 1, 5, 2));
  expect_invalid(kestrelRender(renderer, 7, 4, nullptr, nullptr));
  expect_ok(kestrelRender(renderer, 8, 4, nullptr, nullptr));
  int width = 0, height = 0;
  expect_ok(kestrelGetFrameSize(renderer, &width, &height));
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 2);
  expect_ok(kestrelSetRegion(renderer, 0, 0, 0, 0));
  expect_ok(kestrelRender(renderer, 7, 4, nullptr, nullptr));
}

TEST_F(Api, CancellingKeepsTheLastFrame) {
  set_glowing_square();
  expect_ok(kestrelRender(renderer, 4, 4, nullptr, nullptr));
  expect_ok(kestrelSetSetting(scene, "samples", "64"));
  expect_ok(kestrelCommitScene(scene));
  Watch by_return;
  by_return.go_on = false;
  expect_failure(kestrelRender(renderer, 32, 32, watch, &by_return), KESTREL_ERROR_CANCELLED);
  Watch by_call;
  by_call.renderer = renderer;
  by_call.cancel = true;
  expect_failure(kestrelRender(renderer, 32, 32, watch, &by_call), KESTREL_ERROR_CANCELLED);
  std::vector<float> pixels(4 * 4 * 4);
  expect_ok(kestrelReadPass(renderer, "Combined", pixels.data(), pixels.size()));
  EXPECT_EQ(pixels[2], 2.0f);
  expect_ok(kestrelRender(renderer, 8, 8, nullptr, nullptr));
}

TEST_F(Api, CancellingWhenNothingRunsDoesNothing) {
  set_glowing_square();
  kestrelCancel(renderer);
  kestrelCancelCommit(scene);
  EXPECT_EQ(kestrelGetError(nullptr), KESTREL_ERROR_NONE);
  expect_ok(kestrelCommitScene(scene));
  expect_ok(kestrelRender(renderer, 4, 4, nullptr, nullptr));
}

TEST_F(Api, ABusyRendererRefusesInsteadOfWaiting) {
  set_glowing_square();
  Watch w;
  w.renderer = renderer;
  w.use_renderer = true;
  expect_ok(kestrelRender(renderer, 64, 64, watch, &w));
  EXPECT_EQ(w.refused, 2);
}

TEST_F(Api, ReadersNeverMakeAFrameFail) {
  set_glowing_square();
  expect_ok(kestrelRender(renderer, 4, 4, nullptr, nullptr));
  std::atomic<bool> done = false;
  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i) {
    readers.emplace_back([&] {
      std::vector<float> pixels(4 * 4 * 4);
      while (!done) {
        const KestrelError result =
            kestrelReadPass(renderer, "Combined", pixels.data(), pixels.size());
        if (result == KESTREL_ERROR_NONE) {
          EXPECT_EQ(pixels[2], 2.0f);
        } else {
          EXPECT_EQ(result, KESTREL_ERROR_INVALID_OPERATION);
        }
      }
    });
  }
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(kestrelRender(renderer, 4, 4, nullptr, nullptr), KESTREL_ERROR_NONE);
  }
  done = true;
  for (std::thread& reader : readers) reader.join();
}

TEST_F(Api, ScenesMayBeEditedWhileTheyAreRendered) {
  set_glowing_square();
  std::atomic<bool> done = false;
  std::thread editor([&] {
    float matrix[12];
    std::memcpy(matrix, kIdentity, sizeof(matrix));
    for (int i = 0; !done; ++i) {
      matrix[0] = 1.0f + 0.01f * static_cast<float>(i % 10);
      EXPECT_EQ(kestrelSetObjectTransform(scene, 1, matrix), KESTREL_ERROR_NONE);
      EXPECT_EQ(kestrelCommitScene(scene), KESTREL_ERROR_NONE);
    }
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(kestrelRender(renderer, 16, 16, nullptr, nullptr), KESTREL_ERROR_NONE);
  }
  done = true;
  editor.join();
}

TEST_F(Api, ReleasingARendererWhileItRendersIsSafe) {
  set_glowing_square();
  const KestrelRenderer busy = kestrelNewRenderer(scene);
  std::thread([&] {
    EXPECT_EQ(kestrelRender(
                  busy, 64, 64,
                  [](void* user, float, const char*) {
                    auto* handle = static_cast<KestrelRenderer*>(user);
                    kestrelReleaseRenderer(*handle);
                    *handle = nullptr;
                    return true;
                  },
                  const_cast<KestrelRenderer*>(&busy)),
              KESTREL_ERROR_NONE);
  }).join();
}

// ---- Images -------------------------------------------------------------------------------------

TEST_F(Api, WritesPicturesWithTheChosenPasses) {
  set_glowing_square();
  expect_ok(kestrelRender(renderer, 2, 2, nullptr, nullptr));
  const TemporaryFolder folder;
  const auto layers_in = [](const std::string& path) {
    const Bytes bytes = kestrel::test::load(path);
    const std::string text(bytes.begin(), bytes.end());
    return std::pair(text.find("Depth.Z") != text.npos, text.find("Normal.X") != text.npos);
  };
  expect_ok(kestrelWriteImage(renderer, folder.file("some.exr").c_str(), "Combined,Depth"));
  EXPECT_EQ(layers_in(folder.file("some.exr")), std::pair(true, false));
  expect_ok(kestrelWriteImage(renderer, folder.file("all.exr").c_str(), "all"));
  EXPECT_EQ(layers_in(folder.file("all.exr")), std::pair(true, true));
  expect_ok(kestrelWriteImage(renderer, folder.file("a.png").c_str(), "Combined"));
  EXPECT_EQ(folder.file_count(), 3u);

  expect_invalid(kestrelWriteImage(renderer, nullptr, "all"), {"path"});
  expect_invalid(kestrelWriteImage(renderer, "a.exr", nullptr), {"passes"});
  expect_invalid(kestrelWriteImage(renderer, "a.exr", "Combined,Beauty"), {"Beauty"});
  expect_invalid(kestrelWriteImage(renderer, "a.exr", ""), {"Combined"});
  expect_failure(kestrelWriteImage(renderer, folder.file("a.xyz").c_str(), "all"),
                 KESTREL_ERROR_FILE, {"a.xyz", ".exr"});
  expect_failure(kestrelWriteImage(renderer, "/nowhere/a.exr", "all"), KESTREL_ERROR_FILE,
                 {"/nowhere/a.exr"});
  EXPECT_EQ(folder.file_count(), 3u);
}

TEST_F(Api, TexturesFromFilesMemoryAndPixelsGiveOnePicture) {
  const TemporaryFolder folder;
  const Bytes samples = {10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110, 120};
  const Bytes png = kestrel::test::make_png(2, 2, kestrel::test::kPngRgb, 8, samples);
  const std::string path = kestrel::test::save(folder.file("a.png"), png);
  // The same, as a host hands it over: bottom row first, with alpha.
  const Bytes pixels = {70, 80, 90, 255, 100, 110, 120, 255, 10, 20, 30, 255, 40, 50, 60, 255};
  KestrelTextureOptions options = {.name = "four colours", .srgb = true, .nearest = true};
  expect_ok(kestrelSetTextureFile(scene, 1, path.c_str(), &options));
  expect_ok(kestrelSetTextureMemory(scene, 2, png.data(), png.size(), &options));
  expect_ok(kestrelSetTexturePixels8(scene, 3, 2, 2, pixels.data(), &options));
  std::vector<float> linear;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const double v = pixels[i] / 255.0;
    const double decoded = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    linear.push_back(static_cast<float>(i % 4 == 3 ? v : decoded));
  }
  expect_ok(kestrelSetTexturePixelsFloat(scene, 4, 2, 2, linear.data(), &options));

  set_glowing_square();
  const float uvs[] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1};
  KestrelMesh mesh = square();
  mesh.corner_uvs = uvs;
  expect_ok(kestrelSetMesh(scene, 1, &mesh));
  for (uint64_t texture = 1; texture <= 4; ++texture) {
    KestrelMaterial material;
    kestrelDefaultMaterial(&material);
    material.emission[0] = material.emission[1] = material.emission[2] = 1.0f;
    material.emission_texture = texture;
    expect_ok(kestrelSetMaterial(scene, 1, &material));
    expect_ok(kestrelCommitScene(scene));
    expect_ok(kestrelRender(renderer, 2, 2, nullptr, nullptr));
    std::vector<float> picture(2 * 2 * 4);
    expect_ok(kestrelReadPass(renderer, "Combined", picture.data(), picture.size()));
    for (size_t i = 0; i < picture.size(); ++i) {
      EXPECT_NEAR(picture[i], linear[i], 1e-6) << "texture " << texture << ", value " << i;
    }
  }
}

}  // namespace
