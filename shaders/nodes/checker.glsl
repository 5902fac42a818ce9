// SPDX-License-Identifier: GPL-3.0-or-later
// Checker Texture.

// Factor: 1 in the cells of Color1, 0 in those of Color2.
NODE_FUNCTION float node_checker(vec3 vector, float scale) {
  vec3 p = (vector * scale + vec3(0.000001f)) * 0.999999f;  // whole coordinates off the edges
  int x = whole_number(floor(p.x));
  int y = whole_number(floor(p.y));
  int z = whole_number(floor(p.z));
  return ((x ^ y ^ z) & 1) != 0 ? 1.0f : 0.0f;
}
