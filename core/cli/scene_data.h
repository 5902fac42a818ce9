// SPDX-License-Identifier: GPL-3.0-or-later
// Where the files that a scene file names are found.
#pragma once

#include <filesystem>
#include <string>

#include "cli/json_node.h"

namespace kestrel::cli {

/// What ${KESTREL_SCENE_DATA} stands for: the environment variable, else `shared/scenes` beside the
/// repository, looked for from the scene file's folder upwards.
std::filesystem::path scene_data_folder(const std::filesystem::path& scene_file);

/// The file that the text `node` names: relative to the scene file's folder, absolute, or below
/// ${KESTREL_SCENE_DATA}. Fails, naming the folder to set, unless it is a readable plain file.
std::string resolve_file(const JsonNode& node);

}  // namespace kestrel::cli
