// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: fragment, of the G-buffer pass, for materials whose alpha is a mask.
// Inputs and outputs: raster/gbuffer_fragment.glsl.
const bool kMasked = true;
#include "raster/gbuffer_fragment.glsl"
