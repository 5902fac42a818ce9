// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/scene_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/parse.h"
#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

constexpr int kMaximumSide = 65536;  // pixels of a picture
constexpr uintmax_t kMaximumFileBytes = uintmax_t{512} << 20;

std::string read_text(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw SceneFileError(path, "", "no such file");
  if (!std::filesystem::is_regular_file(path, error)) {
    throw SceneFileError(path, "", "not a plain file");
  }
  if (std::filesystem::file_size(path, error) > kMaximumFileBytes) {
    throw SceneFileError(path, "", "larger than 512 MiB; put geometry into model files");
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw SceneFileError(path, "", "cannot be read");
  return text.str();
}

void expect_version(const JsonNode& root) {
  if (!root.value().is_object()) root.expect_keys({});
  const auto version = root.find("kestrel_scene");
  if (!version) {
    root.fail(
        "not a Kestrel scene: the key 'kestrel_scene' with the version of the format ({}) is "
        "missing",
        kSceneFileVersion);
  }
  if (version->integer(1, 1 << 30) != kSceneFileVersion) {
    version->fail("version {} of the format; this program reads version {}",
                  version->value().dump(), kSceneFileVersion);
  }
}

std::vector<JsonNode> list(const JsonNode& root, const std::string& key) {
  const auto node = root.find(key);
  return node ? node->items(kMaximumItems) : std::vector<JsonNode>{};
}

void parse_size(const JsonNode& node, SceneDescription& scene) {
  const std::vector<JsonNode> sides = node.items(2);
  if (sides.size() != 2) node.fail("expected width and height");
  scene.width = sides[0].integer(1, kMaximumSide);
  scene.height = sides[1].integer(1, kMaximumSide);
}

std::vector<CameraDescription> parse_camera_motion(const JsonNode& root,
                                                   const CameraDescription& camera) {
  std::vector<CameraDescription> states;
  const auto motion = root.find("camera_motion");
  if (!motion) return states;
  for (const JsonNode& item : motion->items(kMaximumSteps)) {
    states.push_back(parse_camera(item));
    if (states.back().projection != camera.projection) {
      item.fail("expected the projection of 'camera'");
    }
  }
  if (states.size() < 2) motion->fail("expected at least 2 states");
  return states;
}

void parse_surfaces(const JsonNode& root, ParseContext& context) {
  SceneDescription& scene = context.scene;
  std::vector<bool> says_srgb;
  for (const JsonNode& node : list(root, "textures")) {
    scene.textures.push_back(parse_texture(
        node, context.textures, static_cast<int>(scene.textures.size()), context.buffer));
    says_srgb.push_back(node.has("srgb"));
  }
  std::vector<bool> holds_data(scene.textures.size(), false);
  for (const JsonNode& node : list(root, "materials")) {
    scene.materials.push_back(parse_material(node, context.textures, context.materials,
                                             static_cast<int>(scene.materials.size()), holds_data));
  }
  for (size_t i = 0; i < holds_data.size(); ++i) {
    if (holds_data[i] && !says_srgb[i]) scene.textures[i].srgb = false;
  }
}

}  // namespace

SceneDescription read_scene_text(const std::string& text, const std::string& path) {
  const nlohmann::json document = parse_json(text, path);
  const JsonNode root(path, document);
  expect_version(root);
  root.expect_keys({"kestrel_scene", "description", "size", "camera", "camera_motion", "settings",
                    "world", "lights", "textures", "materials", "meshes", "objects", "buffer"});
  if (const auto description = root.find("description")) description->text();
  ParseContext context;
  SceneDescription& scene = context.scene;
  if (const auto buffer = root.find("buffer")) context.buffer = SceneBuffer(*buffer);
  if (const auto size = root.find("size")) parse_size(*size, scene);
  scene.camera = parse_camera(root.require("camera"));
  scene.camera_motion = parse_camera_motion(root, scene.camera);
  if (const auto settings = root.find("settings")) {
    settings->expect_keys(setting_names("scene"));
    scene.settings = parse_settings(*settings, "scene");
  }
  for (const JsonNode& node : list(root, "lights")) {
    scene.lights.push_back(parse_light(node, scene.lights.size()));
  }
  parse_surfaces(root, context);
  if (const auto world = root.find("world"))
    scene.world = parse_world(*world, context.textures, scene);
  for (const JsonNode& node : list(root, "meshes")) {
    const int index = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(parse_mesh(node, context.meshes, index, context.models, context.buffer));
  }
  size_t index = 0;
  for (const JsonNode& node : list(root, "objects")) parse_object(node, index++, context);
  return std::move(scene);
}

SceneDescription read_scene_file(const std::string& path) {
  return read_scene_text(read_text(path), path);
}

}  // namespace kestrel::cli
