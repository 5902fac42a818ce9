// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of node programs: the shaders' sources as C++.
#pragma once

#include "shading/glsl.h"

namespace kestrel::nodes {

#include "../../shaders/nodes/program.glsl"

#include "../../shaders/nodes/basic.glsl"

}  // namespace kestrel::nodes
