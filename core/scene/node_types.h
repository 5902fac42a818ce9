// SPDX-License-Identifier: GPL-3.0-or-later
// What node programs are made of: the shaders' source as C++.
#pragma once

#include "shading/glsl.h"

namespace kestrel::nodes {

#include "../../shaders/nodes/program.glsl"

}  // namespace kestrel::nodes
