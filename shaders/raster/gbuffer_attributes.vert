// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: vertex, of the G-buffer pass, for materials with several UV maps or with colours of the mesh.
// Inputs and outputs: raster/gbuffer.vert.
#define ATTRIBUTES
#include "raster/gbuffer.vert"
