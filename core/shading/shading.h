// SPDX-License-Identifier: GPL-3.0-or-later
// Light reflected by a surface towards the viewer. The one seam behind which shading models lie:
// whoever shades calls reflect_light(), which follows Settings::shading_model. The same maths is in
// shaders/shading.
#pragma once

#include "shading/surface.h"

namespace kestrel {

/// What arrives at a point from one light, before anything blocks it.
struct Incident {
  vec3 direction;  // world space, unit, from the point to the light
  float distance;  // metres, infinite for directional lights
  vec3 radiance;   // reflected by a white Lambert surface that faces the light
};

/// False where the light does not reach the point at all (outside a spot's cone).
bool incident_light(const Light& light, const vec3& position_ws, Incident& incident);

/// Turns both normals to the viewer's side; `to_viewer` is unit.
void face_viewer(Surface& surface, const vec3& to_viewer);

/// Light of one source reflected to the viewer; the surface faces the viewer. Blinn-Phong:
/// diffuse N·L + specular (N·H)^n, n = 1 + 254 A (Table 1).
vec3 reflect_light(const Settings& settings, const Surface& surface, const vec3& to_viewer,
                   const Light& light, const Incident& incident);

/// Emission and global ambient light (listing 5).
vec3 unlit(const Settings& settings, const Surface& surface);

/// L: everything above, for all lights, nothing shadowed. The surface faces the viewer.
vec3 lighting_without_shadows(const Scene& scene, const Surface& surface, const vec3& to_viewer);

}  // namespace kestrel
