// SPDX-License-Identifier: GPL-3.0-or-later
// Unit vectors as two numbers in [-1, 1], as in core/gl/octahedral.h.

vec2 fold_octahedron(vec2 p) {
  return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
}

vec2 encode_octahedral(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  return n.z < 0.0 ? fold_octahedron(p) : p;
}

vec3 decode_octahedral(vec2 e) {
  float z = 1.0 - abs(e.x) - abs(e.y);
  vec2 p = z < 0.0 ? fold_octahedron(e) : e;
  return normalize(vec3(p, z));
}
