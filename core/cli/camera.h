// SPDX-License-Identifier: GPL-3.0-or-later
// The camera of a scene file for a picture of a given size and, along its path, a given moment.
#pragma once

#include "cli/scene_description.h"

namespace kestrel::cli {

/// Matrix of a camera at `position` whose -Z points at `look_at`, +Y as near to `up` as can be.
/// Where `up` is parallel to the view another axis takes its place. The points must differ.
mat4x3 world_from_camera_looking(const vec3& position, const vec3& look_at, const vec3& up);

/// The camera where it stands.
KestrelCamera camera_for(const CameraDescription& camera, int width, int height);

/// The camera at `fraction` 0…1 of its path's duration, on a cubic curve through the keys (Hermite,
/// tangents from the neighbours: Catmull-Rom with the keys' own times). The path must not be empty.
KestrelCamera camera_on_path(const CameraDescription& camera, double fraction, int width,
                             int height);

}  // namespace kestrel::cli
