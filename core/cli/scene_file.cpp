// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/scene_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/parse.h"

namespace kestrel::cli {
namespace {

constexpr int kSchemaVersion = 1;
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
        kSchemaVersion);
  }
  if (version->integer(1, 1 << 30) != kSchemaVersion) {
    version->fail("version {} of the format; this program reads version {}",
                  version->value().dump(), kSchemaVersion);
  }
}

std::vector<JsonNode> list(const JsonNode& root, const std::string& key) {
  const auto node = root.find(key);
  return node ? node->items(kMaximumItems) : std::vector<JsonNode>{};
}

void parse_surfaces(const JsonNode& root, ParseContext& context) {
  SceneDescription& scene = context.scene;
  std::vector<bool> says_srgb;
  for (const JsonNode& node : list(root, "textures")) {
    scene.textures.push_back(
        parse_texture(node, context.textures, static_cast<int>(scene.textures.size())));
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
  root.expect_keys({"kestrel_scene", "description", "camera", "settings", "world", "lights",
                    "textures", "materials", "meshes", "objects"});
  if (const auto description = root.find("description")) description->text();
  ParseContext context;
  SceneDescription& scene = context.scene;
  scene.camera = parse_camera(root.require("camera"));
  if (const auto settings = root.find("settings")) {
    settings->expect_keys(setting_names("scene"));
    scene.settings = parse_settings(*settings, "scene");
  }
  for (const JsonNode& node : list(root, "lights")) {
    scene.lights.push_back(parse_light(node, scene.lights.size()));
  }
  parse_surfaces(root, context);
  if (const auto world = root.find("world")) scene.world = parse_world(*world, scene);
  for (const JsonNode& node : list(root, "meshes")) {
    const int index = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(parse_mesh(node, context.meshes, index, context.models));
  }
  size_t index = 0;
  for (const JsonNode& node : list(root, "objects")) parse_object(node, index++, context);
  return std::move(scene);
}

SceneDescription read_scene_file(const std::string& path) {
  return read_scene_text(read_text(path), path);
}

}  // namespace kestrel::cli
