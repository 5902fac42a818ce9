// SPDX-License-Identifier: GPL-3.0-or-later
// White Noise Texture: Color of 0 to 1 by the bits of a point of texture_point() with scale 1; its
// first component is Value.

NODE_FUNCTION vec3 node_white_noise(int dimensions, vec4 p) {
  switch (dimensions) {
    case 1: return hash_float_to_vec3(p.x);
    case 2: return hash_vec2_to_vec3(vec2(p.x, p.y));
    case 3: return hash_vec3_to_vec3(vec3(p.x, p.y, p.z));
    default: return hash_vec4_to_vec3(p);
  }
}
