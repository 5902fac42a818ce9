// SPDX-License-Identifier: GPL-3.0-or-later
// Tangent frames for normal maps.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace kestrel {

/// Some unit vector across `normal` (unit).
vec3 any_perpendicular(const vec3& normal);

/// One tangent a corner of `mesh` (object space) along these UVs (empty: all are (0, 0)): xyz unit,
/// across the corner's normal, the way u grows; the bitangent is w * cross(normal, tangent).
/// Corners that share position, normal, uv and orientation share the mean of their triangles'
/// tangents weighted by the corner's angle, as in Mikkelsen, "Simulation of Wrinkled Surfaces
/// Revisited" (2008), so that maps baked by others fit. Where the UVs span no area: any
/// perpendicular, w = 1.
std::vector<vec4> make_tangents(const Mesh& mesh, const std::vector<vec2>& corner_uvs);

}  // namespace kestrel
