// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of colour and texture nodes: the shaders' sources as C++, in the order of
// shaders/nodes/textures.glsl.
#pragma once

#include "shading/glsl.h"

/// For functions whose loops count to a constant only where they are inlined.
#define NODE_INLINE [[gnu::always_inline]] inline

namespace kestrel::nodes {

#include "../../shaders/nodes/hash.glsl"

#include "../../shaders/nodes/color.glsl"

#include "../../shaders/nodes/noise.glsl"

#include "../../shaders/nodes/voronoi.glsl"

#include "../../shaders/nodes/white_noise.glsl"

#include "../../shaders/nodes/wave.glsl"

#include "../../shaders/nodes/magic.glsl"

#include "../../shaders/nodes/gradient.glsl"

#include "../../shaders/nodes/checker.glsl"

#include "../../shaders/nodes/brick.glsl"

}  // namespace kestrel::nodes
