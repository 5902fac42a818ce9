// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of colour and texture nodes, each file after those that it needs;
// core/shading/node_textures.h is the same for C++.
#include "nodes/prelude.glsl"
#include "nodes/hash.glsl"
#include "nodes/color.glsl"
