// SPDX-License-Identifier: GPL-3.0-or-later
// The fragment stage of the G-buffer pass (paper, listing 3). Inputs: the interpolated corner, the
// material. Outputs: the targets of Table 2; their formats stand in core/stages/raster_targets.cpp.
// Who includes it says by kMasked whether alpha cuts holes.
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "raster/material.glsl"

layout(std140, binding = 1) uniform ObjectBlock {
  GpuObject object;
};
layout(location = 0) uniform uint material_index;

layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;
layout(location = 2) flat in vec3 face_normal_ws;
layout(location = 3) in vec2 mesh_uv;
layout(location = 4) in vec4 tangent_ws;

layout(location = 0) out vec4 out_position;
layout(location = 1) out vec4 out_normals;
layout(location = 2) out vec4 out_emission;
layout(location = 3) out vec4 out_ambient;
layout(location = 4) out vec4 out_diffuse;
layout(location = 5) out vec4 out_specular;
layout(location = 6) out vec4 out_optical;
// Object, material and, where the target has room for them, the bits of the mesh's UV.
layout(location = 7) out uvec4 out_id;

void main() {
  GpuMaterial m = materials[material_index];
  vec2 uv = m.offset + mesh_uv * m.tiling;
  MaterialSample s = sample_material(m, uv, frame.environment_ior);
  if (kMasked && s.alpha < m.alpha_cutoff) discard;

  vec3 geometric = safe_normalize(face_normal_ws, vec3(0.0, 0.0, 1.0));
  vec3 normal = mapped_normal(m, uv, safe_normalize(normal_ws, geometric), tangent_ws);

  out_position = vec4(position_ws, 1.0);
  out_normals = vec4(encode_octahedral(normal), encode_octahedral(geometric));
  out_emission = vec4(min(s.emission, kLargestHalf), 0.0);
  out_ambient = vec4(min(s.ambient, kLargestHalf), 0.0);
  out_diffuse = min(s.diffuse, kLargestHalf);
  out_specular = min(s.specular, kLargestHalf);
  out_optical = vec4(min(s.optical, kLargestHalf), 0.0);
  out_id = uvec4(object.id, material_index, floatBitsToUint(mesh_uv));
}
