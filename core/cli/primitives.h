// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's basic shapes (section 3), Blender's sizes: 2 m across, centred on the origin.
#pragma once

#include "cli/scene_description.h"

namespace kestrel::cli {

/// Square in z = 0 facing +Z, UVs 0…1. 2 triangles.
MeshDescription make_plane();

/// Each face has UVs 0…1. 12 triangles, flat.
MeshDescription make_cube();

/// Poles on Z, u around from +X, v up. 2 * slices * (stacks - 1) triangles; slices >= 3,
/// stacks >= 2.
MeshDescription make_sphere(int slices, int stacks, bool smooth);

/// Replaces the normals by averages over the faces around each position, weighted by their angle.
/// Positions that are equal count as one vertex.
void smooth_normals(MeshDescription& mesh);

}  // namespace kestrel::cli
