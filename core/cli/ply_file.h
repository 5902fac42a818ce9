// SPDX-License-Identifier: GPL-3.0-or-later
// Stanford PLY files: ASCII, little and big endian. A reader of its own, because assimp's hangs or
// crashes on damaged files.
#pragma once

#include <string>

#include "cli/scene_description.h"

namespace kestrel::cli {

/// The mesh of a PLY file's text: positions, normals and texture coordinates of its vertices, and
/// its faces as fans of triangles. Other elements and properties are skipped. Throws
/// std::runtime_error with the reason where the text is damaged.
MeshDescription read_ply(const std::string& text);

}  // namespace kestrel::cli
