// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of node programs: the shaders' sources as C++.
#pragma once

#include "scene/node_types.h"
#include "shading/node_textures.h"

namespace kestrel::nodes {

#include "../../shaders/nodes/basic.glsl"

}  // namespace kestrel::nodes
