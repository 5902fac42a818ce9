// SPDX-License-Identifier: GPL-3.0-or-later
// A scene file as plain data: every name resolved to an index, every model file read. Nothing of
// it has reached the library yet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/math.h"
#include "kestrel/kestrel.h"

namespace kestrel::cli {

inline constexpr int kNoIndex = -1;

/// A further UV map, or colours, of a mesh's corners.
struct AttributeDescription {
  uint64_t id = 0;
  int channels = 2;  // 2 or 3
  std::vector<float> values;
};

/// A mesh at a moment; as MeshDescription's.
struct ShapeDescription {
  std::vector<vec3> positions;
  std::vector<vec3> corner_normals;
};

/// Triangles in object space; as KestrelMesh. Corner arrays are empty or have 3 entries a triangle.
struct MeshDescription {
  std::string name;
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  std::vector<vec3> corner_normals;
  std::vector<vec2> corner_uvs;
  std::vector<uint32_t> triangle_slots;  // empty: 0
  std::vector<vec4> corner_tangents;     // xyz, sign of the bitangent
  uint64_t uv_map = 0;                   // id of corner_uvs
  std::vector<AttributeDescription> attributes;
  std::vector<ShapeDescription> motion;  // at even steps of time; empty: keeps its shape
};

struct TextureFile {
  std::string path;
};
struct TextureBytes {  // of an image file, from inside a model file
  std::vector<uint8_t> data;
};
struct TexturePixels {  // RGBA, row 0 at the bottom
  int width = 0;
  int height = 0;
  std::vector<float> rgba;     // linear; or, where it is empty:
  std::vector<uint8_t> bytes;  // linear or sRGB
};

struct TextureDescription {
  std::string name;
  std::variant<TextureFile, TextureBytes, TexturePixels> source;
  bool srgb = true;
  bool nearest = false;
  KestrelExtension extension = KESTREL_EXTENSION_REPEAT;
};

/// `values.name` is unused; texture ids are index + 1, 0 for none.
struct MaterialDescription {
  std::string name;
  KestrelMaterial values;
};

/// `values.name` is unused.
struct LightDescription {
  std::string name;
  KestrelLight values;
};

struct ObjectDescription {
  std::string name;
  std::string unit;   // empty: its own name
  std::string asset;  // empty: its own name
  int pass_index = 0;
  int mesh = kNoIndex;
  std::vector<int> materials;  // by slot; kNoIndex: the default grey
  mat4x3 world_from_object{1.0f};
  std::vector<std::pair<std::string, std::string>> settings;  // of its unit
  uint32_t hidden_from = 0;                                   // KestrelRays
  bool holdout = false;
  std::vector<mat4x3> motion;  // world_from_object at even steps of time; empty: stands still
};

/// Where the camera stands at a moment of its path.
struct CameraKey {
  double time = 0.0;  // seconds
  vec3 position{0.0f};
  vec3 look_at{0.0f};
};

/// Which side of the picture the field of view or the scale measures.
enum class CameraFit { larger, horizontal, vertical };

struct CameraDescription {
  KestrelProjection projection = KESTREL_PERSPECTIVE;
  CameraFit fit = CameraFit::larger;
  float extent = 1.0f;         // of the fitted side: 2 tan(fov / 2), or metres
  vec2 shift{0.0f};            // in units of the fitted side, as Blender's
  std::optional<vec4> window;  // left, right, bottom, top instead of these three, for any picture
  float near_clip = 0.1f;
  float far_clip = 1000.0f;
  float aperture_radius = 0.0f;  // metres
  float focus_distance = 1.0f;   // metres
  int aperture_blades = 0;
  float aperture_rotation = 0.0f;  // radians
  float aperture_ratio = 1.0f;
  mat4x3 world_from_camera{1.0f};
  vec3 up{0.0f, 0.0f, 1.0f};    // of the path
  std::vector<CameraKey> path;  // empty, or 2 and more at rising times
};

struct WorldDescription {
  KestrelWorldKind kind = KESTREL_WORLD_COLOR;
  vec3 color{0.0f};
  int textures[6] = {kNoIndex, kNoIndex, kNoIndex, kNoIndex, kNoIndex, kNoIndex};
  mat3 map_from_world{1.0f};
  float mist_start = 0.0f;
  float mist_depth = 0.0f;
  float mist_falloff = 1.0f;
};

struct SceneDescription {
  int width = 0;  // pixels of the picture that it was made for; 0: not known
  int height = 0;
  CameraDescription camera;
  std::vector<CameraDescription> camera_motion;  // at even steps of time; empty: stands still
  WorldDescription world;
  std::vector<std::pair<std::string, std::string>> settings;
  std::vector<TextureDescription> textures;
  std::vector<MaterialDescription> materials;
  std::vector<LightDescription> lights;
  std::vector<MeshDescription> meshes;
  std::vector<ObjectDescription> objects;
};

}  // namespace kestrel::cli
