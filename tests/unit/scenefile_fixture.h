// SPDX-License-Identifier: GPL-3.0-or-later
// What the scene file tests share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "cli/scene_file.h"

namespace kestrel::cli {

namespace fs = std::filesystem;

inline constexpr const char* kCamera =
    R"("camera": {"fov": 50, "position": [0, -5, 1], "look_at": [0, 0, 1]})";

/// A scene with a camera and `rest`.
inline SceneDescription read(const std::string& rest, const std::string& path = "scene.kscene") {
  return read_scene_text(
      std::string(R"({"kestrel_scene": 1, )") + kCamera + (rest.empty() ? "" : ", ") + rest + "}",
      path);
}

inline CameraDescription read_camera(const std::string& camera) {
  return read_scene_text(R"({"kestrel_scene": 1, "camera": )" + camera + "}", "scene.kscene")
      .camera;
}

inline void expect_near(const vec3& a, const vec3& b, float tolerance = 1e-5f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

inline vec3 placed(const ObjectDescription& object, const vec3& p) {
  return object.world_from_object * vec4(p, 1.0f);
}

/// A folder of its own for each test, removed afterwards.
class SceneFiles : public testing::Test {
 protected:
  SceneFiles() {
    std::string name = (fs::temp_directory_path() / "kestrel-scenefile-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~SceneFiles() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string scene_path() const { return (folder_ / "scene.kscene").string(); }

  fs::path folder_;
};

}  // namespace kestrel::cli
