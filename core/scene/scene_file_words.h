// SPDX-License-Identifier: GPL-3.0-or-later
// What the writer and the reader of scene files must agree on. The format is described in
// docs/scene_format.md.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace kestrel {

inline constexpr int kSceneFileVersion = 1;

// Names of enumerations, in their order.
inline const std::vector<std::string> kProjectionWords = {"perspective", "orthographic"};
inline const std::vector<std::string> kLightWords = {"directional", "point", "spot"};
inline const std::vector<std::string> kExtensionWords = {"repeat", "clamp", "clip"};
inline const std::vector<std::string> kAlphaModeWords = {"opaque", "mask", "blend"};
inline const std::vector<std::string> kRayWords = {"camera", "shadow", "reflection",
                                                   "refraction"};  // by bit of RayBits

/// The file beside a scene file that holds its arrays: little-endian, each at a multiple of 4.
inline std::string scene_buffer_path(const std::string& scene_file) {
  return scene_file + ".bin";
}

/// Arrays are hashed in pieces of so many bytes, one after the other.
inline constexpr size_t kSceneBufferPiece = size_t{1} << 20;

/// Bytes of a name or a path; longer ones are refused.
inline constexpr size_t kMaximumSceneText = 4096;

/// The largest magnitude of a matrix's entries and of distances.
inline constexpr double kMaximumSceneNumber = 1e18;

}  // namespace kestrel
