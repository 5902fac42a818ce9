// SPDX-License-Identifier: GPL-3.0-or-later
// What happens where a ray meets a triangle whose material has a say in it. The geometry's user
// pointer is the RtScene.
#pragma once

#include "tracers/embree/embree_api.h"

namespace kestrel::embree {

/// Primary, reflection and refraction rays go through where a mask says there is no surface.
void skip_masked(const RTCFilterFunctionNArguments* args);

/// Listing 8b: a shadow ray (a ShadowQuery) loses light at every surface and ends when none is
/// left.
void attenuate_shadow(const RTCFilterFunctionNArguments* args);

}  // namespace kestrel::embree
