// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of node programs: the shaders' sources as C++.
#pragma once

#include "scene/node_types.h"

namespace kestrel::nodes {

#include "../../shaders/nodes/basic.glsl"
#include "../../shaders/nodes/hash.glsl"

#include "../../shaders/nodes/color.glsl"
#include "../../shaders/nodes/noise.glsl"

#include "../../shaders/nodes/voronoi.glsl"
#include "../../shaders/nodes/white_noise.glsl"

#include "../../shaders/nodes/brick.glsl"
#include "../../shaders/nodes/checker.glsl"
#include "../../shaders/nodes/gradient.glsl"
#include "../../shaders/nodes/magic.glsl"
#include "../../shaders/nodes/wave.glsl"

}  // namespace kestrel::nodes
