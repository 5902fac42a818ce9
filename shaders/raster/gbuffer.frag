// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: fragment, of the G-buffer pass, for materials without holes: hidden fragments need not run.
// Inputs and outputs: raster/gbuffer_fragment.glsl.
const bool kMasked = false;
#include "raster/gbuffer_fragment.glsl"
