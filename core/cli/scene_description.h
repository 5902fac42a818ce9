// SPDX-License-Identifier: GPL-3.0-or-later
// A scene file as plain data: every name resolved to an index, every model file read. Nothing of
// it has reached the library yet.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/math.h"
#include "kestrel/kestrel.h"

namespace kestrel::cli {

inline constexpr int kNoIndex = -1;

/// Triangles in object space; as KestrelMesh. Corner arrays are empty or have 3 entries a triangle.
struct MeshDescription {
  std::string name;
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  std::vector<vec3> corner_normals;
  std::vector<vec2> corner_uvs;
  std::vector<uint32_t> triangle_slots;  // empty: 0
};

struct TextureFile {
  std::string path;
};
struct TextureBytes {  // of an image file, from inside a model file
  std::vector<uint8_t> data;
};
struct TexturePixels {  // RGBA, linear, row 0 at the bottom
  int width = 0;
  int height = 0;
  std::vector<float> rgba;
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
  float extent = 1.0f;  // of the fitted side: 2 tan(fov / 2), or metres
  vec2 shift{0.0f};     // in units of the fitted side, as Blender's
  float near_clip = 0.1f;
  float far_clip = 1000.0f;
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
  CameraDescription camera;
  WorldDescription world;
  std::vector<std::pair<std::string, std::string>> settings;
  std::vector<TextureDescription> textures;
  std::vector<MaterialDescription> materials;
  std::vector<LightDescription> lights;
  std::vector<MeshDescription> meshes;
  std::vector<ObjectDescription> objects;
};

}  // namespace kestrel::cli
