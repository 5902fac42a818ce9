// SPDX-License-Identifier: GPL-3.0-or-later
// Runs node programs at points that rays have met.
#pragma once

#include <array>

#include "scene/scene.h"

namespace kestrel {

struct SurfaceHit;

/// How something came to look at a surface.
struct Look {
  vec3 direction{0.0f, 0.0f, -1.0f};  // unit, of the ray, world space
  float distance = 0.0f;              // metres it came
  uint8_t kind = 1;                   // RayBits
  int depth = 0;                      // how often it was reflected or refracted
};

/// A point of a surface before its program runs.
struct BarePoint {
  vec3 position;          // world space
  vec3 normal;            // world space, unit, on the mesh's own side
  vec3 normal_geometric;  // likewise
};

using NodeValues = std::array<vec4, nodes::kNodeOutputs>;

/// All outputs of the program of the hit's material; those that it does not compute are undefined.
NodeValues run_program(const Scene& scene, const Material& material, const SurfaceHit& hit,
                       const BarePoint& point, const Look& look);

/// The same, of alpha, transmission and diffuse alone.
NodeValues run_coverage(const Scene& scene, const Material& material, const SurfaceHit& hit,
                        const BarePoint& point, const Look& look);

}  // namespace kestrel
