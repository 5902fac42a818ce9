// SPDX-License-Identifier: GPL-3.0-or-later
// Texture lookups on the processor; the shaders do the same through the GL's samplers.
#pragma once

#include "scene/scene.h"

namespace kestrel {

/// Linear RGBA at `uv`: bilinear (or nearest) at full resolution. (0, 0) is the lower left corner
/// of texel row 0; outside 0…1 the texture's extension decides. An empty texture gives white.
vec4 sample_texture(const Texture& texture, const vec2& uv);

/// Asks the processor for the texels of a later sample_texture(): it need not wait for them then.
void prefetch_texels(const Texture& texture, const vec2& uv);

/// Radiance of the world seen along a unit direction in world space.
vec3 sample_world(const Scene& scene, const vec3& direction_ws);

}  // namespace kestrel
