// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of colour and texture nodes, each file after those that it needs;
// core/shading/node_textures.h is the same for C++.
#include "nodes/prelude.glsl"
#include "nodes/hash.glsl"
#include "nodes/color.glsl"
#include "nodes/noise.glsl"
#include "nodes/voronoi.glsl"
#include "nodes/white_noise.glsl"
#include "nodes/wave.glsl"
#include "nodes/magic.glsl"
#include "nodes/gradient.glsl"
#include "nodes/checker.glsl"
#include "nodes/brick.glsl"
