// SPDX-License-Identifier: GPL-3.0-or-later
// C structs to the core's: pointers, counts and enumerations are checked here, values in the core.
// All throw Error(invalid_argument).
#pragma once

#include <span>
#include <string>

#include "api/errors.h"
#include "kestrel/kestrel.h"
#include "scene/scene_builder.h"

namespace kestrel::api {

/// The caller's array; `argument` names it in the error for NULL.
template <typename T>
std::span<const T> array(const T* values, size_t count, const char* argument) {
  if (count == 0) return {};
  return {require(values, argument), count};
}

/// Empty for NULL; bytes that are not UTF-8 become '?', since names end up in JSON.
std::string text_from(const char* text);

/// The spans point into the caller's arrays.
MeshInput mesh_from(const KestrelMesh& mesh);
TextureOptions options_from(const KestrelTextureOptions* options);
/// The number of values of a picture with 4 channels; throws where a side is not in 1…32768.
size_t texel_values(int width, int height);
/// `material`: its name, for errors.
std::shared_ptr<NodeProgram> program_from(const KestrelNodeProgram& program,
                                          const std::string& material);
MaterialInput material_from(const KestrelMaterial& material);
LightInput light_from(const KestrelLight& light);
ObjectInput object_from(const KestrelObject& object);
mat4x3 matrix_from(const float values[12]);
/// As many as a motion may have steps, or none.
std::vector<mat4x3> matrices_from(const float* values, size_t count);
Camera camera_from(const KestrelCamera& camera);
/// As many as a motion may have steps.
std::vector<Camera> cameras_from(const KestrelCamera* states, size_t count);
WorldInput world_from(const KestrelWorld& world);
ItemKind kind_from(KestrelKind kind);

}  // namespace kestrel::api
