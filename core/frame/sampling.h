// SPDX-License-Identifier: GPL-3.0-or-later
// Where in the pixel, on the lens and in time the samples of a frame lie.
#pragma once

#include "base/math.h"
#include "params/params.h"

namespace kestrel {

/// Offset of sample `index` from the pixel's centre, in pixels: a low-discrepancy sequence (R2, the
/// two-dimensional generalisation of the golden ratio) distributed like the pixel filter, so that
/// all samples count the same. Sample 0 lies in the centre.
vec2 subpixel_offset(const Settings& settings, int index);

/// Where on the unit square that stands for the aperture sample `index` lies; 0 in its middle.
vec2 lens_position(int index);

/// When sample `index` is taken: 0 where the shutter opens, 1 where it closes; 0 half-way.
float shutter_time(int index);

}  // namespace kestrel
