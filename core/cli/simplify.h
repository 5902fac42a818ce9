// SPDX-License-Identifier: GPL-3.0-or-later
// Fewer triangles for the same shape.
#pragma once

#include <cstddef>

#include "cli/scene_description.h"

namespace kestrel::cli {

/// Collapses edges onto one of their ends, the cheapest by quadric error first, until `target`
/// triangles remain or none can go without a hole, a fold or a change of borders, hard edges and
/// seams of the UVs. Vertices at one place are welded. The same input gives the same mesh.
void simplify(MeshDescription& mesh, size_t target);

}  // namespace kestrel::cli
