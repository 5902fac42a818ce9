// SPDX-License-Identifier: GPL-3.0-or-later
// A committed scene into a scene file, from which it renders to the same bits.
#pragma once

#include <string>

#include "scene/scene.h"

namespace kestrel {

/// Writes `path` (JSON) and the arrays beside it, each whole or not at all. Objects and lights are
/// in the order of their ids, all else in that of its first use: the order in which the host set
/// them does not show. `width` x `height`: pixels of the picture, 0 x 0 where that is open. Throws
/// Error(file), Error(invalid_argument).
void write_scene(const Scene& scene, const std::string& path, int width, int height);

}  // namespace kestrel
