// SPDX-License-Identifier: GPL-3.0-or-later
// Readers of one element of a scene file each; all throw SceneFileError.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/json_node.h"
#include "cli/model_file.h"
#include "cli/scene_buffer.h"
#include "cli/scene_description.h"

namespace kestrel::cli {

// Limits that keep a small file from asking for unbounded memory.
inline constexpr size_t kMaximumItems = 1'000'000;
inline constexpr double kMaximumLength = 1e9;  // metres
inline constexpr double kMaximumRadiance = 1e9;
inline constexpr size_t kMaximumSteps = 129;  // of a motion

/// What has a unique name and is referred to by it.
class Names {
 public:
  explicit Names(std::string kind) : kind_(std::move(kind)) {}
  /// Registers the "name" of `element`; fails on duplicates.
  std::string add(const JsonNode& element, int index);
  /// The index of what the text `reference` names.
  int find(const JsonNode& reference) const;

 private:
  std::string kind_;
  std::map<std::string, int> indices_;
};

/// Model files, each read once.
class ModelCache {
 public:
  struct Entry {
    Model model;
    bool imported = false;  // its meshes, materials and textures are part of the scene
    int first_mesh = 0;
    int first_material = 0;
  };
  /// The model that the text `path` names; `up` for files that do not say it.
  Entry& read(const JsonNode& path, UpAxis up);

 private:
  std::map<std::pair<std::string, UpAxis>, std::unique_ptr<Entry>> entries_;
};

/// What parsing an element may add to or look up.
struct ParseContext {
  SceneDescription scene;
  Names textures{"texture"};
  Names materials{"material"};
  Names meshes{"mesh"};
  ModelCache models;
  SceneBuffer buffer;
};

// ---- values -----------------------------------------------------------------------------------

/// Three numbers, or `fallback` where `key` is missing.
vec3 parse_vec3(const JsonNode& parent, const std::string& key, const vec3& fallback,
                double minimum = -kMaximumLength, double maximum = kMaximumLength);
/// What an element of this name is called outside the scene file: its "label", else its name.
std::string parse_label(const JsonNode& parent, const std::string& name);
UpAxis parse_up(const JsonNode& parent);
/// "matrix", or "position", "rotation" (degrees, XYZ) and "scale"; identity where there is none.
mat4x3 parse_transform(const JsonNode& parent);
/// 12 numbers, column-major 3x4.
mat4x3 parse_matrix(const JsonNode& node);
mat3 rotation_from_degrees(const vec3& degrees);
const std::vector<std::string>& transform_keys();

/// Settings of "scene" or "object" scope, checked against the parameter table, as text. Only keys
/// of the table are looked at.
std::vector<std::pair<std::string, std::string>> parse_settings(const JsonNode& node,
                                                                const std::string& scope);
std::vector<std::string> setting_names(const std::string& scope);

// ---- elements ---------------------------------------------------------------------------------

CameraDescription parse_camera(const JsonNode& node);
/// Adds the world's images to the textures, but those that are there already.
WorldDescription parse_world(const JsonNode& node, const Names& textures, SceneDescription& scene);
LightDescription parse_light(const JsonNode& node, size_t index);
TextureDescription parse_texture(const JsonNode& node, Names& names, int index,
                                 const SceneBuffer& buffer);
/// The element's material; textures that hold no colour are marked as linear, unless they say so.
MaterialDescription parse_material(const JsonNode& node, const Names& textures, Names& names,
                                   int index, std::vector<bool>& holds_data);
MeshDescription parse_mesh(const JsonNode& node, Names& names, int index, ModelCache& models,
                           const SceneBuffer& buffer);
/// Appends the element's objects (many for instances and imported models) to the scene.
void parse_object(const JsonNode& node, size_t index, ParseContext& context);

}  // namespace kestrel::cli
