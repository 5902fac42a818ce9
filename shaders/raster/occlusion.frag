// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: fragment, of the occlusion queries (paper, listing 6). Inputs: the id target of the last
// G-buffer pass. Outputs: none; fragments in pixels that show another object end here. Masks need
// no look: where the object shows, one of its fragments has the pixel's depth.
#include "common/gpu_structs.glsl"

layout(std140, binding = 1) uniform ObjectBlock {
  GpuObject object;
};
layout(binding = 6) uniform usampler2D id_target;

void main() {
  if (texelFetch(id_target, ivec2(gl_FragCoord.xy), 0).r != object.id) discard;
}
