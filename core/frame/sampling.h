// SPDX-License-Identifier: GPL-3.0-or-later
// Where in the pixel the samples of a frame lie.
#pragma once

#include "base/math.h"
#include "params/params.h"

namespace kestrel {

/// Offset of sample `index` from the pixel's centre, in pixels: a low-discrepancy sequence (R2, the
/// two-dimensional generalisation of the golden ratio) distributed like the pixel filter, so that
/// all samples count the same. Sample 0 lies in the centre.
vec2 subpixel_offset(const Settings& settings, int index);

}  // namespace kestrel
