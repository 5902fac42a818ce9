// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: vertex, of the G-buffer pass and the occlusion queries (paper, listing 2).
// Inputs: one corner of a triangle in object space. Outputs: the same in world space; vectors are
// not normalised, so that they interpolate as the ray path interpolates them.
#include "common/frame.glsl"

layout(std140, binding = 1) uniform ObjectBlock {
  GpuObject object;
};

layout(location = 0) in vec3 position_os;
layout(location = 1) in vec3 normal_os;
layout(location = 2) in vec3 face_normal_os;  // of the triangle, by its winding
layout(location = 3) in vec2 uv;
layout(location = 4) in vec4 tangent_os;      // w: sign of the bitangent; all 0: none
#ifdef ATTRIBUTES
layout(location = 5) in vec2 uv_of_texture[6];  // by texture unit
layout(location = 11) in vec3 emission_color;   // 1: none
layout(location = 12) in vec3 ambient_color;
layout(location = 13) in vec3 diffuse_color;
#endif

// The occlusion queries compare depths for equality with an earlier pass.
invariant gl_Position;

layout(location = 0) out vec3 position_ws;
layout(location = 1) out vec3 normal_ws;
layout(location = 2) flat out vec3 face_normal_ws;
layout(location = 3) out vec2 mesh_uv;
layout(location = 4) out vec4 tangent_ws;
#ifdef ATTRIBUTES
layout(location = 5) out vec2 mesh_uvs[6];
layout(location = 11) out vec3 mesh_colors[3];  // emission, ambient, diffuse
#endif

void main() {
  mat3 normal_from_object = mat3(object.normal_from_object);
  vec4 position = object.world_from_object * vec4(position_os, 1.0);
  position_ws = position.xyz;
  normal_ws = normal_from_object * normal_os;
  face_normal_ws = normal_from_object * face_normal_os;
  mesh_uv = uv;
  tangent_ws = vec4(mat3(object.world_from_object) * tangent_os.xyz,
                    tangent_os.w * object.bitangent_sign);
#ifdef ATTRIBUTES
  mesh_uvs = uv_of_texture;
  mesh_colors = vec3[3](emission_color, ambient_color, diffuse_color);
#endif
  gl_Position = frame.clip_from_world * vec4(position.xyz, 1.0);
}
