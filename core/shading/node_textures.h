// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of colour and texture nodes: the shaders' sources as C++, in the order of
// shaders/nodes/textures.glsl.
#pragma once

#include "shading/glsl.h"

namespace kestrel::nodes {

#include "../../shaders/nodes/hash.glsl"

#include "../../shaders/nodes/color.glsl"

}  // namespace kestrel::nodes
