// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/scene_data.h"

#include <unistd.h>

#include <cstdlib>

namespace kestrel::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDataVariable = "${KESTREL_SCENE_DATA}";

}  // namespace

fs::path scene_data_folder(const fs::path& scene_file) {
  if (const char* folder = std::getenv("KESTREL_SCENE_DATA"); folder && *folder) return folder;
  std::error_code ignored;
  const fs::path start = fs::absolute(scene_file, ignored).lexically_normal().parent_path();
  for (fs::path folder = start; folder.has_relative_path(); folder = folder.parent_path()) {
    const fs::path candidate = folder.parent_path() / "shared" / "scenes";
    if (fs::is_directory(candidate, ignored)) return candidate;
  }
  return (start.parent_path().parent_path() / "shared" / "scenes");
}

std::string resolve_file(const JsonNode& node) {
  const std::string text = node.text();
  const fs::path scene_file(node.file());
  const bool is_data = text.rfind(kDataVariable, 0) == 0;
  if (!is_data && text.find("${") != std::string::npos) {
    node.fail("'{}' holds a variable; only {} at the start is known", text, kDataVariable);
  }
  fs::path path = scene_file.parent_path() / text;
  fs::path folder;
  if (is_data) {
    folder = scene_data_folder(scene_file);
    path = folder / fs::path(text.substr(kDataVariable.size())).relative_path();
  }
  path = path.lexically_normal();
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && access(path.c_str(), R_OK) == 0) return path.string();
  const char* reason = fs::exists(path, ignored) ? "is not a readable file" : "does not exist";
  if (is_data) {
    node.fail(
        "'{}' {}; the scene data is looked for in '{}': set the environment variable "
        "KESTREL_SCENE_DATA to the folder that has it",
        path.string(), reason, folder.string());
  }
  node.fail("'{}' {}; paths are relative to the scene file", path.string(), reason);
}

}  // namespace kestrel::cli
