// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes written to scene files: nothing is lost, and the same content gives the same bytes.
#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <sstream>

#include "cli/handles.h"
#include "unit/image_files.h"
#include "unit/scenefile_fixture.h"

namespace kestrel::cli {
namespace {

using nlohmann::json;

constexpr int kWidth = 48, kHeight = 32;

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A tetrahedron with values that no rounding leaves alone.
struct Tetrahedron {
  std::vector<float> positions = {0.1f,  0.2f, 1.3f, 1.1f,  0.0f,  0.0f,
                                  -0.7f, 0.9f, 0.0f, -0.6f, -1.0f, 0.0f};
  std::vector<uint32_t> triangles = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  std::vector<uint32_t> slots = {0, 2, 1, 0};
  std::vector<float> normals, uvs, more_uvs, colors, tangents, moved, moved_normals;
  KestrelMeshAttribute attributes[2] = {};

  Tetrahedron() {
    for (int i = 0; i < 12; ++i) {
      const auto x = static_cast<float>(i);
      for (const float v : {std::sin(x) * 3.0f, std::cos(x), 0.3f + x / 7.0f}) {
        normals.push_back(v);
        moved_normals.push_back(v);
        colors.push_back(std::abs(v) / 3.0f);
      }
      uvs.insert(uvs.end(), {x / 11.0f, 1.0f / (1.0f + x)});
      more_uvs.insert(more_uvs.end(), {1.0f / (2.0f + x), x / 9.0f});
      tangents.insert(tangents.end(), {std::cos(x), 0.1f, std::sin(x), i % 2 ? 1.0f : -1.0f});
    }
    moved = positions;
    for (const float p : positions) moved.push_back(p + 0.05f);
    moved_normals.insert(moved_normals.end(), normals.rbegin(), normals.rend());
    attributes[0] = {0xFEDCBA9876543210u, 2, more_uvs.data()};
    attributes[1] = {77, 3, colors.data()};
  }

  KestrelMesh plain(const char* name) const {
    KestrelMesh m{};
    m.name = name;
    m.vertex_count = 4;
    m.positions = positions.data();
    m.triangle_count = 4;
    m.triangles = triangles.data();
    return m;
  }
  KestrelMesh rich(const char* name) const {
    KestrelMesh m = plain(name);
    m.corner_normals = normals.data();
    m.corner_uvs = uvs.data();
    m.triangle_materials = slots.data();
    m.uv_map = 12345678901234567890u;
    m.attribute_count = 2;
    m.attributes = attributes;
    return m;
  }
  KestrelMesh moving(const char* name) const {
    KestrelMesh m = rich(name);
    m.corner_tangents = tangents.data();
    m.motion_count = 2;
    m.motion_positions = moved.data();
    m.motion_corner_normals = moved_normals.data();
    return m;
  }
};

KestrelMaterial material(const char* name, float value) {
  KestrelMaterial m;
  kestrelDefaultMaterial(&m);
  m.name = name;
  for (int i = 0; i < 3; ++i) {
    m.ambient[i] = value / 3.0f;
    m.diffuse[i] = value / static_cast<float>(i + 1);
    m.specular[i] = 0.1f * value;
    m.reflection_color[i] = 0.7f + 0.1f * value;
  }
  m.specular[3] = 0.123f;
  m.optical[0] = 0.3f * value;
  m.tiling[0] = 1.7f;
  m.offset[1] = -0.3f;
  m.pass_index = 7;
  return m;
}

KestrelLight light(const char* name, KestrelLightType type, float x) {
  KestrelLight l;
  kestrelDefaultLight(&l);
  l.name = name;
  l.type = type;
  const float color[] = {std::abs(3.1f * x), 2.7f, 1.9f}, position[] = {x, -2.3f, 3.7f},
              direction[] = {-0.31f * x, 0.7f, -1.1f};
  std::copy(color, color + 3, l.color);
  std::copy(position, position + 3, l.position);
  std::copy(direction, direction + 3, l.direction);
  l.spot_angle = 1.2345678f;
  l.spot_exponent = 1.5f;
  l.specular_factor = 0.9f;
  return l;
}

KestrelObject object(const char* name, uint64_t mesh, std::span<const uint64_t> materials,
                     float x) {
  KestrelObject o{};
  o.name = name;
  o.mesh = mesh;
  o.materials = materials.data();
  o.material_count = materials.size();
  const float matrix[] = {0.9f, 0.1f, 0, -0.13f, 0.8f, 0.2f, 0, 0.1f, 1.1f, x, 0.3f, 0.1f};
  std::copy(matrix, matrix + 12, o.world_from_object);
  return o;
}

constexpr uint64_t kFirstSlots[] = {1, 0, 2}, kSecondSlots[] = {3}, kThirdSlots[] = {2, 1, 3};

KestrelCamera camera(float x) {
  KestrelCamera c{};
  const float matrix[] = {1.3f, 0.2f, 0, 0.1f, 0.4f, 2.2f, 0.3f, -2.0f, 0.5f, x, -5.0f, 1.5f};
  std::copy(matrix, matrix + 12, c.world_from_camera);
  c.left = -0.61f, c.right = 0.6f, c.bottom = -0.4f, c.top = 0.41f;
  c.near_clip = 0.1f, c.far_clip = 100.0f;
  c.aperture_radius = 0.013f, c.focus_distance = 5.1f;
  c.aperture_blades = 5, c.aperture_rotation = 0.777f, c.aperture_ratio = 1.3f;
  return c;
}

/// Everything that a scene may hold, put in by steps whose order must not matter.
class Everything {
 public:
  explicit Everything(const fs::path& folder) {
    image_ = test::save(
        (folder / "image.png").string(),
        test::make_png(2, 2, test::kPngRgb, 8, {255, 0, 0, 0, 255, 0, 0, 0, 255, 200, 100, 50}));
    for (int i = 0; i < 4 * 3 * 2; ++i) {
      texels8_.push_back(static_cast<uint8_t>(37 * i));
      texels_.push_back(std::cos(static_cast<float>(i)) + 1.0f);
    }
  }

  std::vector<std::function<void(KestrelScene)>> steps() const {
    return {
        [&](KestrelScene s) { textures(s); },
        [&](KestrelScene s) { materials(s); },
        [&](KestrelScene s) { meshes(s); },
        [&](KestrelScene s) { add_light(s, 1, light("Sun", KESTREL_LIGHT_DIRECTIONAL, 0.9f)); },
        [&](KestrelScene s) { add_light(s, 2, light("Lamp", KESTREL_LIGHT_POINT, 1.3f)); },
        [&](KestrelScene s) { add_light(s, 3, light("Spot", KESTREL_LIGHT_SPOT, -1.1f)); },
        [&](KestrelScene s) { first_object(s); },
        [&](KestrelScene s) { second_object(s); },
        [&](KestrelScene s) { third_object(s); },
        [&](KestrelScene s) { view(s); },
        [&](KestrelScene s) { world(s); },
    };
  }

 private:
  static void add_light(KestrelScene s, uint64_t id, const KestrelLight& l) {
    check(kestrelSetLight(s, id, &l));
  }

  void textures(KestrelScene s) const {
    const KestrelTextureOptions file{"Image", true, false, KESTREL_EXTENSION_REPEAT};
    const KestrelTextureOptions bytes{"Painted", true, true, KESTREL_EXTENSION_CLAMP};
    const KestrelTextureOptions data{"", false, false, KESTREL_EXTENSION_CLIP};
    check(kestrelSetTextureFile(s, 1, image_.c_str(), &file));
    check(kestrelSetTexturePixels8(s, 2, 3, 2, texels8_.data(), &bytes));
    check(kestrelSetTexturePixelsFloat(s, 3, 3, 2, texels_.data(), &data));
    const test::Bytes packed = test::load(image_);
    check(kestrelSetTextureMemory(s, 4, packed.data(), packed.size(), &file));
  }

  static void materials(KestrelScene s) {
    KestrelMaterial m = material("Metal", 0.7f);
    m.diffuse_texture = 1;
    m.ambient_texture = 2;
    m.uv_maps[2] = 0xFEDCBA9876543210u;
    m.diffuse_attribute = 77;
    check(kestrelSetMaterial(s, 1, &m));
    m = material("Metal", 0.4f);  // the same name, as in linked libraries
    m.normal_texture = 3;
    m.normal_strength = 0.3f;
    m.tangent_map = 0xFEDCBA9876543210u;
    check(kestrelSetMaterial(s, 2, &m));
    m = material("Leaf", 0.9f);
    m.emission[0] = -0.02f;
    m.emission[1] = 0.05f;
    m.emission_texture = 4;
    m.alpha_mode = KESTREL_ALPHA_MASK;
    m.alpha_cutoff = 0.2f;
    m.casts_shadow = false;
    check(kestrelSetMaterial(s, 3, &m));
  }

  void meshes(KestrelScene s) const {
    KestrelMesh mesh = tetrahedron_.rich("Tetrahedron");
    check(kestrelSetMesh(s, 1, &mesh));
    mesh = tetrahedron_.plain("Flat");
    check(kestrelSetMesh(s, 2, &mesh));
    mesh = tetrahedron_.moving("Moving");
    check(kestrelSetMesh(s, 3, &mesh));
  }

  static void first_object(KestrelScene s) {
    KestrelObject o = object("First", 1, kFirstSlots, -1.2f);
    o.unit = "Unit";
    o.asset = "Asset";
    o.pass_index = 3;
    check(kestrelSetObject(s, 1, &o));
    check(kestrelSetObjectSetting(s, 1, "relevance", "2.3"));
    check(kestrelSetObjectSetting(s, 1, "reflections", "always"));
  }

  static void second_object(KestrelScene s) {
    KestrelObject o = object("Second", 2, kSecondSlots, 0.1f);
    o.unit = "Unit";
    o.hidden_from = KESTREL_RAYS_SHADOW | KESTREL_RAYS_REFRACTION;
    check(kestrelSetObject(s, 2, &o));
    KestrelObject moved = object("Second", 2, kSecondSlots, 0.3f);
    float matrices[24];
    std::copy(o.world_from_object, o.world_from_object + 12, matrices);
    std::copy(moved.world_from_object, moved.world_from_object + 12, matrices + 12);
    check(kestrelSetObjectMotion(s, 2, matrices, 2));
  }

  static void third_object(KestrelScene s) {
    KestrelObject o = object("Third", 3, kThirdSlots, 1.4f);
    check(kestrelSetObject(s, 3, &o));
    o = object("Hole", 2, {}, 2.4f);
    o.holdout = true;
    check(kestrelSetObject(s, 4, &o));
  }

  static void view(KestrelScene s) {
    const KestrelCamera states[] = {camera(0.1f), camera(0.2f)};
    check(kestrelSetCamera(s, &states[0]));
    check(kestrelSetCameraMotion(s, states, 2));
    for (const auto& [name, value] : {std::pair{"primary", "rays"},
                                      {"samples", "3"},
                                      {"ambient", "0.1 0.25 0.3"},
                                      {"motion_blur", "true"},
                                      {"importance_cutoff", "0.001"}}) {
      check(kestrelSetSetting(s, name, value));
    }
  }

  static void world(KestrelScene s) {
    KestrelWorld w{};
    w.kind = KESTREL_WORLD_EQUIRECTANGULAR;
    w.textures[0] = 3;
    const float color[] = {0.3f, 0.41f, 0.2f};
    const float turn[] = {0.6f, 0.8f, 0, -0.8f, 0.6f, 0, 0, 0, 1};
    std::copy(color, color + 3, w.color);
    std::copy(turn, turn + 9, w.map_from_world);
    w.mist_start = 1.1f, w.mist_depth = 7.3f, w.mist_falloff = 2.0f;
    check(kestrelSetWorld(s, &w));
  }

  Tetrahedron tetrahedron_;
  std::string image_;
  std::vector<uint8_t> texels8_;
  std::vector<float> texels_;
};

class WrittenScene : public SceneFiles {
 protected:
  WrittenScene() : everything_(folder_) {}

  ScenePtr new_scene() const { return owned<ScenePtr>(kestrelNewScene(device_.get())); }

  ScenePtr filled() const {
    ScenePtr scene = new_scene();
    for (const auto& step : everything_.steps()) step(scene.get());
    check(kestrelCommitScene(scene.get()));
    return scene;
  }

  /// Writes to a folder of its own; the path.
  std::string save(KestrelScene scene, const std::string& name) const {
    fs::create_directories(folder_ / name);
    const std::string path = (folder_ / name / "scene.kscene").string();
    check(kestrelWriteScene(scene, path.c_str(), kWidth, kHeight));
    return path;
  }

  ScenePtr read_back(const std::string& path) const {
    ScenePtr scene = new_scene();
    const SceneDescription description = read_scene_file(path);
    EXPECT_EQ(description.width, kWidth);
    EXPECT_EQ(description.height, kHeight);
    fill_scene(description, 100, 100, scene.get());  // the window does not depend on the size
    return scene;
  }

  static void expect_same_files(const std::string& a, const std::string& b) {
    EXPECT_EQ(text_of(a), text_of(b));
    EXPECT_TRUE(text_of(a + ".bin") == text_of(b + ".bin"));
  }

  static std::map<std::string, std::vector<float>> render(KestrelScene scene) {
    const auto renderer = owned<RendererPtr>(kestrelNewRenderer(scene));
    check(kestrelRender(renderer.get(), kWidth, kHeight, nullptr, nullptr));
    std::map<std::string, std::vector<float>> passes;
    for (size_t i = 0; i < kestrelGetPassCount(renderer.get()); ++i) {
      const std::string name = kestrelGetPassName(renderer.get(), i);
      const float* pixels = kestrelGetPassPixels(renderer.get(), name.c_str());
      if (!pixels) continue;
      const size_t channels =
          std::string(kestrelGetPassChannels(renderer.get(), name.c_str())).size();
      passes[name].assign(pixels, pixels + kWidth * kHeight * channels);
    }
    return passes;
  }

  /// The library's last reason.
  static std::string reason() {
    const char* message = nullptr;
    kestrelGetError(&message);
    return message ? message : "";
  }

  DevicePtr device_ = owned<DevicePtr>(kestrelNewDevice());
  Everything everything_;
};

TEST_F(WrittenScene, WrittenReadAndWrittenAgainHasTheSameBytes) {
  const ScenePtr scene = filled();
  const std::string first = save(scene.get(), "first");
  const ScenePtr back = read_back(first);
  expect_same_files(first, save(back.get(), "second"));
}

TEST_F(WrittenScene, RendersToTheSameBits) {
  const ScenePtr scene = filled();
  const ScenePtr back = read_back(save(scene.get(), "scene"));
  const auto expected = render(scene.get()), found = render(back.get());
  ASSERT_EQ(expected.size(), found.size());
  ASSERT_GT(expected.size(), 20u);
  for (const auto& [name, pixels] : expected) {
    EXPECT_EQ(std::memcmp(pixels.data(), found.at(name).data(), pixels.size() * sizeof(float)), 0)
        << name;
  }
  const std::vector<float>& combined = expected.at("Combined");
  EXPECT_GT(std::set<float>(combined.begin(), combined.end()).size(), 500u) << "shows too little";
}

TEST_F(WrittenScene, DoesNotShowInWhichOrderItCameAbout) {
  const ScenePtr scene = filled();
  const std::string fresh = save(scene.get(), "fresh");
  const ScenePtr edited = new_scene();
  const auto steps = everything_.steps();
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) (*step)(edited.get());
  const Tetrahedron shape;
  const KestrelMesh other = shape.moving("Gone");
  const KestrelObject gone = object("Gone", 100, kSecondSlots, 9.0f);
  const KestrelLight glare = light("Gone", KESTREL_LIGHT_SPOT, 2.0f);
  check(kestrelSetMesh(edited.get(), 100, &other));
  check(kestrelSetObject(edited.get(), 100, &gone));
  check(kestrelSetLight(edited.get(), 100, &glare));
  const KestrelMaterial shiny = material("Shiny", 0.2f);
  check(kestrelSetMaterial(edited.get(), 1, &shiny));
  check(kestrelSetObjectSetting(edited.get(), 3, "cost", "5"));
  check(kestrelCommitScene(edited.get()));
  check(kestrelRemove(edited.get(), KESTREL_KIND_OBJECT, 100));  // its mesh stays, unused
  check(kestrelRemove(edited.get(), KESTREL_KIND_LIGHT, 100));
  check(kestrelSetObjectSetting(edited.get(), 3, "cost", "0"));
  for (const auto& step : steps) step(edited.get());
  check(kestrelCommitScene(edited.get()));
  expect_same_files(fresh, save(edited.get(), "edited"));
}

TEST_F(WrittenScene, LightsAddUpInTheOrderOfTheirIds) {
  const ScenePtr scene = filled(), reversed = new_scene();
  const auto steps = everything_.steps();
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) (*step)(reversed.get());
  check(kestrelCommitScene(reversed.get()));
  EXPECT_EQ(render(scene.get()).at("Combined"), render(reversed.get()).at("Combined"));
}

TEST_F(WrittenScene, HoldsWhatWasCommittedLast) {
  const ScenePtr scene = filled();
  const std::string before = save(scene.get(), "before");
  const KestrelLight more = light("More", KESTREL_LIGHT_POINT, 2.0f);
  check(kestrelSetLight(scene.get(), 9, &more));
  expect_same_files(before, save(scene.get(), "uncommitted"));
  check(kestrelCommitScene(scene.get()));
  const json document = json::parse(text_of(save(scene.get(), "committed")));
  ASSERT_EQ(document.at("lights").size(), 4u);
  EXPECT_EQ(document.at("lights")[3].at("name"), "More");
}

TEST_F(WrittenScene, SaysWhatArtistsCalledThings) {
  const ScenePtr scene = filled();
  const json document = json::parse(text_of(save(scene.get(), "scene")));
  EXPECT_EQ(document.at("size"), json({kWidth, kHeight}));
  EXPECT_EQ(document.at("objects")[0].at("name"), "First");
  EXPECT_EQ(document.at("objects")[0].at("unit"), "Unit");
  EXPECT_EQ(document.at("objects")[0].at("relevance"), 2.3);
  EXPECT_FALSE(document.at("objects")[1].contains("relevance")) << "once a unit";
  EXPECT_EQ(document.at("materials")[1].at("name"), "Metal #2");
  EXPECT_EQ(document.at("materials")[1].at("label"), "Metal");
  EXPECT_EQ(document.at("textures")[1].at("file"), (folder_ / "image.png").string());
  EXPECT_EQ(document.at("textures")[1].at("srgb"), true);
}

TEST_F(WrittenScene, KeepsTexelsOfFilesThatCannotBeRead) {
  const ScenePtr scene = new_scene();
  for (const auto& step : everything_.steps()) step(scene.get());
  const std::string missing = (folder_ / "missing.png").string();
  const KestrelTextureOptions options{"Missing", true, false, KESTREL_EXTENSION_REPEAT};
  check(kestrelSetTextureFile(scene.get(), 1, missing.c_str(), &options));
  check(kestrelCommitScene(scene.get()));
  const ScenePtr back = read_back(save(scene.get(), "scene"));
  EXPECT_EQ(render(scene.get()).at("Combined"), render(back.get()).at("Combined"));
}

TEST_F(WrittenScene, KeepsApartWhatIsCalledTheSame) {
  const ScenePtr scene = filled();
  const std::string endless(5000, 'x'), umlauts = [] {
    std::string text = "x";
    while (text.size() < 5000) text += "\u00FC";
    return text;
  }();
  const uint64_t slots[] = {1, 2, 3, 11, 12, 13, 14, 15};
  uint64_t id = 11;
  for (const char* name :
       {"Metal #2", "Metal", endless.c_str(), endless.c_str(), umlauts.c_str()}) {
    const KestrelMaterial m = material(name, 0.1f * static_cast<float>(id));
    check(kestrelSetMaterial(scene.get(), id++, &m));
  }
  const Tetrahedron shape;
  const std::vector<uint32_t> used = {4, 5, 6, 7};
  KestrelMesh mesh = shape.plain("Line\nbreak");
  mesh.triangle_materials = used.data();
  check(kestrelSetMesh(scene.get(), 9, &mesh));
  const KestrelObject more = object("More", 9, slots, 0.0f);
  check(kestrelSetObject(scene.get(), 9, &more));
  check(kestrelCommitScene(scene.get()));
  const std::string path = save(scene.get(), "first");
  const ScenePtr back = read_back(path);
  expect_same_files(path, save(back.get(), "second"));
  EXPECT_EQ(render(scene.get()).at("Combined"), render(back.get()).at("Combined"));
  const json document = json::parse(text_of(path));
  std::vector<std::string> labels;
  for (const json& m : document.at("materials")) {
    labels.push_back(m.value("label", m.at("name").get<std::string>()));
  }
  EXPECT_EQ(labels[3], "Metal #2");
  EXPECT_EQ(labels[4], "Metal");
}

TEST_F(WrittenScene, ASceneWithNothingInItIsWritten) {
  const ScenePtr scene = new_scene();
  const KestrelCamera view = camera(0.0f);
  check(kestrelSetCamera(scene.get(), &view));
  check(kestrelCommitScene(scene.get()));
  const std::string path = save(scene.get(), "empty");
  const ScenePtr back = read_back(path);
  expect_same_files(path, save(back.get(), "again"));
}

// ---- errors ------------------------------------------------------------------------------------

TEST_F(WrittenScene, TellsWhyItCannotBeWritten) {
  const ScenePtr scene = filled();
  const std::string nowhere = (folder_ / "no" / "scene.kscene").string();
  EXPECT_EQ(kestrelWriteScene(scene.get(), nowhere.c_str(), 0, 0), KESTREL_ERROR_FILE);
  EXPECT_NE(reason().find("there is no folder '" + (folder_ / "no").string() + "'. Create it"),
            std::string::npos);
  EXPECT_EQ(kestrelWriteScene(scene.get(), folder_.c_str(), 0, 0), KESTREL_ERROR_FILE);
  EXPECT_NE(reason().find("Choose the name of a file"), std::string::npos);
  EXPECT_EQ(kestrelWriteScene(scene.get(), "", 0, 0), KESTREL_ERROR_FILE);
  EXPECT_EQ(kestrelWriteScene(scene.get(), nullptr, 0, 0), KESTREL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kestrelWriteScene(nullptr, scene_path().c_str(), 0, 0), KESTREL_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kestrelWriteScene(scene.get(), scene_path().c_str(), 10, 0),
            KESTREL_ERROR_INVALID_ARGUMENT);
  const ScenePtr fresh = new_scene();
  EXPECT_EQ(kestrelWriteScene(fresh.get(), scene_path().c_str(), 0, 0),
            KESTREL_ERROR_INVALID_OPERATION);
  EXPECT_FALSE(fs::exists(scene_path()));
}

TEST_F(WrittenScene, LeavesTheOldFilesWhereTheDiskIsFull) {
  const ScenePtr scene = filled();
  write("scene.kscene", "old");
  const auto names = [&] {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  };
  const auto before = names();
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{100, limit.rlim_max};
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const KestrelError error = kestrelWriteScene(scene.get(), scene_path().c_str(), 0, 0);
  setrlimit(RLIMIT_FSIZE, &limit);
  signal(SIGXFSZ, handler);
  EXPECT_EQ(error, KESTREL_ERROR_FILE);
  EXPECT_NE(reason().find("See that the disk has room"), std::string::npos);
  EXPECT_EQ(text_of(scene_path()), "old");
  EXPECT_EQ(names(), before);
}

TEST_F(WrittenScene, ArraysThatDoNotBelongToItAreRefused) {
  const ScenePtr scene = filled();
  const std::string path = save(scene.get(), "scene");
  const std::string arrays = path + ".bin", whole = text_of(arrays);
  const auto refusal = [&] {
    try {
      read_scene_file(path);
    } catch (const SceneFileError& error) {
      return std::string(error.what());
    }
    return std::string("read");
  };
  std::string damaged = whole;
  damaged[damaged.size() / 2] ^= 1;
  std::ofstream(arrays, std::ios::binary) << damaged;
  EXPECT_NE(refusal().find("/buffer: '" + arrays + "' is damaged"), std::string::npos);
  std::ofstream(arrays, std::ios::binary) << whole << "more";
  EXPECT_NE(refusal().find("belongs to another scene file"), std::string::npos);
  fs::remove(arrays);
  EXPECT_NE(refusal().find("keep both files together"), std::string::npos);
}

TEST_F(WrittenScene, PlacesBeyondTheArraysAreRefused) {
  const ScenePtr scene = filled();
  const std::string path = save(scene.get(), "scene");
  const json whole = json::parse(text_of(path));
  const auto expect_refused = [&](const std::string& pointer, const json& value) {
    json broken = whole;
    broken[json::json_pointer(pointer)] = value;
    std::ofstream(path) << broken.dump();
    EXPECT_THROW(read_scene_file(path), SceneFileError) << pointer;
  };
  const std::string mesh = "/meshes/0";
  expect_refused(mesh + "/positions/offset", 18446744073709551612u);
  expect_refused(mesh + "/positions/count", 4611686018427387904u);
  expect_refused(mesh + "/positions/count", 10);
  expect_refused(mesh + "/positions/offset", -4);
  expect_refused(mesh + "/triangles/offset", 0);  // positions are no indices
  expect_refused(mesh + "/normals/count", 3);
  expect_refused(mesh + "/slots/count", 5);
  expect_refused(mesh + "/attributes/0/uvs/count", 5);
  expect_refused("/textures/0/pixels/width", 4);
}

}  // namespace
}  // namespace kestrel::cli
