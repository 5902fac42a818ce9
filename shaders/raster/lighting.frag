// SPDX-License-Identifier: GPL-3.0-or-later
// Stage: fragment, of the lighting pass (paper, listing 5). Inputs: the G-buffer's targets, the
// lights, the world. Output: L = emission + global ambient * ambient + sum over the lights; the
// world's radiance where nothing was drawn.
#include "common/frame.glsl"
#include "common/octahedral.glsl"
#include "shading/blinn_phong.glsl"
#include "world/world.glsl"

layout(std430, binding = 1) readonly buffer LightBuffer {
  GpuLight lights[];
};

layout(binding = 0) uniform sampler2D position_target;
layout(binding = 1) uniform sampler2D normals_target;
layout(binding = 2) uniform sampler2D emission_target;
layout(binding = 3) uniform sampler2D ambient_target;
layout(binding = 4) uniform sampler2D diffuse_target;
layout(binding = 5) uniform sampler2D specular_target;
layout(binding = 6) uniform usampler2D id_target;

layout(location = 0) out vec4 out_lighting;

// Unit direction in which the camera sees this pixel's sample.
vec3 view_direction() {
  mat3 world_from_camera = mat3(frame.world_from_camera);
  if (frame.orthographic != 0u) return -world_from_camera[2];
  vec2 share = (gl_FragCoord.xy + frame.subpixel) / frame.picture_size;
  vec2 at = mix(frame.window.xz, frame.window.yw, share);
  return normalize(world_from_camera * vec3(at, -1.0));
}

vec3 to_viewer_from(vec3 position_ws) {
  if (frame.orthographic != 0u) return frame.world_from_camera[2].xyz;
  return normalize(frame.world_from_camera[3].xyz - position_ws);
}

vec3 surface_lighting(ivec2 at) {
  Surface surface;
  surface.position = texelFetch(position_target, at, 0).xyz;
  vec3 to_viewer = to_viewer_from(surface.position);
  vec4 normals = texelFetch(normals_target, at, 0);
  surface.normal = decode_octahedral(normals.xy);
  if (dot(decode_octahedral(normals.zw), to_viewer) < 0.0) surface.normal = -surface.normal;
  surface.diffuse = texelFetch(diffuse_target, at, 0);
  surface.specular = texelFetch(specular_target, at, 0);

  vec3 sum = texelFetch(emission_target, at, 0).rgb +
             frame.ambient * texelFetch(ambient_target, at, 0).rgb;
  for (uint i = 0u; i < frame.light_count; ++i) {
    sum += shade_light(lights[i], surface, to_viewer);
  }
  return sum;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  bool nothing = texelFetch(id_target, at, 0).r == 0u;
  vec3 radiance = nothing ? world_radiance(view_direction()) : surface_lighting(at);
  out_lighting = vec4(clamp(radiance, -kLargestHalf, kLargestHalf), 1.0);
}
