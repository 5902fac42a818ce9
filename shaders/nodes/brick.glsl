// SPDX-License-Identifier: GPL-3.0-or-later
// Brick Texture.

// A brick's own random number, 0 to 1.
NODE_FUNCTION float brick_random(uint brick) {
  uint n = (brick + 1013u) & 0x7fffffffu;
  n = (n >> 13) ^ n;
  return float((n * (n * n * 60493u + 19990303u) + 1376312589u) & 0x7fffffffu) *
         (1.0f / 2147483648.0f);
}

// Whether `row` is one of those that are `frequency` apart.
NODE_FUNCTION bool brick_row_chosen(int row, int frequency) {
  uint distance = row < 0 ? 0u - uint(row) : uint(row);
  return distance % uint(frequency) == 0u;
}

// (tint, mortar): Color is Color1 to Color2 by the tint, then to Mortar by the mortar, which is
// also Factor. Every `offset_frequency` rows one starts `offset` of a brick further, every
// `squash_frequency` rows one has bricks `squash` times as wide; a frequency of 0 leaves out both.
NODE_FUNCTION vec2 node_brick(vec3 vector, float scale, float mortar_size, float mortar_smooth,
                              float bias, float brick_width, float row_height, float offset,
                              int offset_frequency, float squash, int squash_frequency) {
  vec3 p = vector * scale;
  int row = whole_number(floor(p.y / row_height));
  float width = brick_width;
  float shift = 0.0f;
  if (offset_frequency > 0 && squash_frequency > 0) {
    if (brick_row_chosen(row, squash_frequency)) width *= squash;
    if (brick_row_chosen(row, offset_frequency)) shift = width * offset;
  }
  int brick = whole_number(floor((p.x + shift) / width));
  float x = (p.x + shift) - width * float(brick);
  float y = p.y - row_height * float(row);
  float tint = clamp(brick_random((uint(row) << 16) + (uint(brick) & 0xffffu)) + bias, 0.0f, 1.0f);
  float edge = min(min(x, y), min(width - x, row_height - y));
  if (edge >= mortar_size) return vec2(tint, 0.0f);
  if (mortar_smooth == 0.0f) return vec2(tint, 1.0f);
  float depth = 1.0f - edge / mortar_size;
  return vec2(tint, smoothstep(0.0f, 1.0f, depth / mortar_smooth));
}
