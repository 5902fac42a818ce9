// SPDX-License-Identifier: GPL-3.0-or-later
// Magic Texture.

// Color; Factor is the mean of its components. `depth` is 0 to 10, `blender` that of noise.glsl.
NODE_FUNCTION vec3 node_magic(int depth, vec3 vector, float scale, float distortion, int blender) {
  // Brought into one turn of the angle before the scale counts, from Blender 5 on after it.
  float before = blender >= 5 ? scale : 1.0f;
  float after = blender >= 5 ? 1.0f : scale;
  float px = signed_remainder(vector.x * before, 6.28318530718f);
  float py = signed_remainder(vector.y * before, 6.28318530718f);
  float pz = signed_remainder(vector.z * before, 6.28318530718f);
  float x = sin((px + py + pz) * 5.0f * after);
  float y = cos((-px + py - pz) * 5.0f * after);
  float z = -cos((-px - py + pz) * 5.0f * after);
  if (depth > 0) {
    x *= distortion;
    y *= distortion;
    z *= distortion;
    y = -cos(x - y + z) * distortion;
  }
  if (depth > 1) x = cos(x - y - z) * distortion;
  if (depth > 2) z = sin(-x - y - z) * distortion;
  if (depth > 3) x = -cos(-x + y - z) * distortion;
  if (depth > 4) y = -sin(-x + y + z) * distortion;
  if (depth > 5) y = -cos(-x + y + z) * distortion;
  if (depth > 6) x = cos(x + y + z) * distortion;
  if (depth > 7) z = sin(x + y - z) * distortion;
  if (depth > 8) x = -cos(-x - y + z) * distortion;
  if (depth > 9) y = -sin(x - y + z) * distortion;
  float divisor = distortion != 0.0f ? 2.0f * distortion : 1.0f;
  return vec3(0.5f) - vec3(x, y, z) / divisor;
}
