// SPDX-License-Identifier: GPL-3.0-or-later
// The scene at a moment, where something in it moves.
#pragma once

#include <memory>
#include <vector>

#include "scene/scene.h"

namespace kestrel {

/// The motion through these matrices; null where they are all the same, or none.
std::shared_ptr<const ObjectMotion> motion_from(const std::vector<mat4x3>& matrices);

/// Whether an object, a mesh or the camera moves.
bool anything_moves(const Scene& scene);

/// The camera at a time of 0…1 from the first to the last of its states.
Camera in_between(const std::vector<Camera>& states, float time);

/// The scene at a time of 0…1 from the first to the last state of all that moves. What stands still
/// is shared with `scene`; units keep their bounds.
std::shared_ptr<const Scene> scene_at(const Scene& scene, float time);

}  // namespace kestrel
