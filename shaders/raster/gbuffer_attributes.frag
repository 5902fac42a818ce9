// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: fragment, of the G-buffer pass, for materials with several UV maps or with colours of the
// mesh, masked ones too. Inputs and outputs: raster/gbuffer_fragment.glsl.
#define ATTRIBUTES
const bool kMasked = true;
#include "raster/gbuffer_fragment.glsl"
