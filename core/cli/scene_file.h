// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files: *.kscene to a description, and a description into the library. The format is
// described in docs/scene_format.md.
#pragma once

#include <string>

#include "cli/json_node.h"
#include "cli/scene_description.h"

namespace kestrel::cli {

/// Reads a scene file and every model file that it names. Throws SceneFileError.
SceneDescription read_scene_file(const std::string& path);

/// The same from text; `path` is for messages and for relative paths.
SceneDescription read_scene_text(const std::string& text, const std::string& path);

/// Puts a description into an empty scene of the library and commits it. The camera is the static
/// one for a picture of this size. Throws std::runtime_error with the library's reason.
void fill_scene(const SceneDescription& description, int width, int height, KestrelScene scene);

/// Throws std::runtime_error with the library's last reason where a call returned an error.
void check(KestrelError error);

}  // namespace kestrel::cli
