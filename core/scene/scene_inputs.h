// SPDX-License-Identifier: GPL-3.0-or-later
// What hosts say about a scene, with references still as ids, and the checks of single items.
// Every check throws Error(invalid_argument) that names item and field where a number is not
// finite, and clamps what has a natural range, with a warning.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace kestrel {

/// The texture fields of `values` are not read; 0 means none.
struct MaterialInput {
  Material values;
  uint64_t emission_texture = 0;
  uint64_t ambient_texture = 0;
  uint64_t diffuse_texture = 0;
  uint64_t specular_texture = 0;
  uint64_t normal_texture = 0;
  uint64_t optical_texture = 0;
};

/// `values.spot_angle` and `cos_outer` are not read, `values.direction` need not be unit.
struct LightInput {
  Light values;
  float spot_angle = 0.0f;  // full angle of the cone, radians
};

struct ObjectInput {
  std::string name;
  uint64_t mesh = 0;
  std::vector<uint64_t> materials;  // by slot; 0: the default grey
  mat4x3 world_from_object{1.0f};
  std::string unit;         // empty: its own name
  uint8_t hidden_from = 0;  // RayBits
  bool holdout = false;
  int pass_index = 0;
  std::string asset;  // empty: its own name
};

/// `values.textures` is not read; 0 means none.
struct WorldInput {
  World values;
  uint64_t textures[6] = {};
};

/// How many of `WorldInput::textures` a kind of world reads.
int texture_count(WorldKind kind);

void check_material(MaterialInput& input);
/// Returns the light with a unit direction and the cone's cosine.
Light checked_light(LightInput input);
void check_matrix(const mat4x3& matrix, const std::string& item, const char* field);
/// Returns the camera with a matrix free of scale and shear; one that is so already stays as it is.
Camera checked_camera(Camera camera);
void check_world(const WorldInput& input);

/// Whether normals can be transformed: its determinant and its inverse fit a float.
bool invertible(const mat4x3& matrix);

}  // namespace kestrel
