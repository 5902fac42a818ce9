// SPDX-License-Identifier: GPL-3.0-or-later
// Items that a host could send, for tests of what becomes of them.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "scene/scene_builder.h"

namespace kestrel {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInf = std::numeric_limits<float>::infinity();

/// The code and text that `work` fails with.
template <typename Work>
std::string failure(ErrorCode code, Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
  }
}

/// A unit square in the xy plane, two triangles, UVs as its coordinates.
struct Square {
  std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  std::vector<uint32_t> triangles = {0, 1, 2, 0, 2, 3};
  std::vector<float> uvs = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1};
  std::vector<float> normals, tangents;
  std::vector<uint32_t> slots;

  MeshInput input(const std::string& name = "square") const {
    return {name, positions, triangles, normals, uvs, tangents, slots, 0, {}};
  }
};

inline ObjectInput object_of(uint64_t mesh, const std::string& name,
                             std::vector<uint64_t> materials = {}) {
  ObjectInput object;
  object.name = name;
  object.mesh = mesh;
  object.materials = std::move(materials);
  return object;
}

inline MaterialInput material_called(const std::string& name) {
  MaterialInput input;
  input.values.name = name;
  return input;
}

/// A builder with a camera and the square as mesh 1.
struct Builder : SceneBuilder {
  Builder() {
    set_camera({});
    set_mesh(1, Square().input());
  }
};

}  // namespace kestrel
