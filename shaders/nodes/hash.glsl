// SPDX-License-Identifier: GPL-3.0-or-later
// Hashes of integers and of floats' bits: the randomness of the texture nodes.

// The whole part of a floored number, INT_MIN where an int cannot hold it (and for NaN).
NODE_FUNCTION int whole_number(float x) {
  if (x >= -2147483648.0f && x < 2147483648.0f) return int(x);
  return -2147483647 - 1;
}

// The remainder of x / y with the sign of x, as C's fmod, for y > 0; exact while |x / y| < 4096.
NODE_FUNCTION float signed_remainder(float x, float y) {
  float ratio = x / y;
  float quotient = ratio < 0.0f ? ceil(ratio) : floor(ratio);
  // y in two parts, of which the first times the quotient needs no rounding.
  float coarse = uintBitsToFloat(floatBitsToUint(y) & 0xfffff000u);
  float rest = (x - quotient * coarse) - quotient * (y - coarse);
  if (x < 0.0f) return rest > 0.0f ? rest - y : rest;
  return rest < 0.0f ? rest + y : rest;  // where the quotient was rounded up
}

// ---- Bob Jenkins' lookup3 ----------------------------------------------------------------------

NODE_FUNCTION uint rotate_left(uint x, int bits) {
  return (x << bits) | (x >> (32 - bits));
}

// lookup3's last step: three words in, the hash out.
NODE_FUNCTION uint hash_final(uint a, uint b, uint c) {
  c ^= b;
  c -= rotate_left(b, 14);
  a ^= c;
  a -= rotate_left(c, 11);
  b ^= a;
  b -= rotate_left(a, 25);
  c ^= b;
  c -= rotate_left(b, 16);
  a ^= c;
  a -= rotate_left(c, 4);
  b ^= a;
  b -= rotate_left(a, 14);
  c ^= b;
  c -= rotate_left(b, 24);
  return c;
}

// lookup3's start value for a key of `words` words.
NODE_FUNCTION uint hash_seed(uint words) {
  return 0xdeadbeefu + (words << 2) + 13u;
}

NODE_FUNCTION uint hash_uint(uint x) {
  uint seed = hash_seed(1u);
  return hash_final(seed + x, seed, seed);
}

NODE_FUNCTION uint hash_uint2(uint x, uint y) {
  uint seed = hash_seed(2u);
  return hash_final(seed + x, seed + y, seed);
}

NODE_FUNCTION uint hash_uint3(uint x, uint y, uint z) {
  uint seed = hash_seed(3u);
  return hash_final(seed + x, seed + y, seed + z);
}

NODE_FUNCTION uint hash_uint4(uint x, uint y, uint z, uint w) {
  uint seed = hash_seed(4u);
  uint a = seed + x;
  uint b = seed + y;
  uint c = seed + z;
  a -= c;
  a ^= rotate_left(c, 4);
  c += b;
  b -= a;
  b ^= rotate_left(a, 6);
  a += c;
  c -= b;
  c ^= rotate_left(b, 8);
  b += a;
  a -= c;
  a ^= rotate_left(c, 16);
  c += b;
  b -= a;
  b ^= rotate_left(a, 19);
  a += c;
  c -= b;
  c ^= rotate_left(b, 4);
  b += a;
  return hash_final(a + w, b, c);
}

// ---- floats in, floats of 0 to 1 out -----------------------------------------------------------

NODE_FUNCTION float unit_from_hash(uint hash) {
  return float(hash) * (1.0f / 4294967296.0f);
}

NODE_FUNCTION float hash_float(float x) {
  return unit_from_hash(hash_uint(floatBitsToUint(x)));
}

NODE_FUNCTION float hash_vec2(vec2 p) {
  return unit_from_hash(hash_uint2(floatBitsToUint(p.x), floatBitsToUint(p.y)));
}

NODE_FUNCTION float hash_vec3(vec3 p) {
  return unit_from_hash(
      hash_uint3(floatBitsToUint(p.x), floatBitsToUint(p.y), floatBitsToUint(p.z)));
}

NODE_FUNCTION float hash_vec4(vec4 p) {
  return unit_from_hash(hash_uint4(floatBitsToUint(p.x), floatBitsToUint(p.y),
                                   floatBitsToUint(p.z), floatBitsToUint(p.w)));
}

NODE_FUNCTION vec3 hash_float_to_vec3(float x) {
  return vec3(hash_float(x), hash_vec2(vec2(x, 1.0f)), hash_vec2(vec2(x, 2.0f)));
}

NODE_FUNCTION vec2 hash_vec2_to_vec2(vec2 p) {
  return vec2(hash_vec2(p), hash_vec3(vec3(p.x, p.y, 1.0f)));
}

NODE_FUNCTION vec3 hash_vec2_to_vec3(vec2 p) {
  return vec3(hash_vec2(p), hash_vec3(vec3(p.x, p.y, 1.0f)), hash_vec3(vec3(p.x, p.y, 2.0f)));
}

NODE_FUNCTION vec3 hash_vec3_to_vec3(vec3 p) {
  return vec3(hash_vec3(p), hash_vec4(vec4(p.x, p.y, p.z, 1.0f)),
              hash_vec4(vec4(p.x, p.y, p.z, 2.0f)));
}

NODE_FUNCTION vec3 hash_vec4_to_vec3(vec4 p) {
  return vec3(hash_vec4(p), hash_vec4(vec4(p.z, p.x, p.w, p.y)),
              hash_vec4(vec4(p.w, p.z, p.y, p.x)));
}

NODE_FUNCTION vec4 hash_vec4_to_vec4(vec4 p) {
  return vec4(hash_vec4(p), hash_vec4(vec4(p.w, p.x, p.y, p.z)),
              hash_vec4(vec4(p.z, p.w, p.x, p.y)), hash_vec4(vec4(p.y, p.z, p.w, p.x)));
}

// ---- permuted congruential hashes of integers (Jarzynski and Olano), as from Blender 5 ----------

NODE_FUNCTION uint pcg_step(uint x) {
  return x * 1664525u + 1013904223u;
}

// The upper half folded onto the lower one; the shift keeps the sign, as for an int.
NODE_FUNCTION uint pcg_fold(uint x) {
  return x ^ uint(int(x) >> 16);
}

NODE_FUNCTION float unit_from_pcg(uint x) {
  return float(x & 0x7fffffffu) * (1.0f / 2147483648.0f);
}

NODE_FUNCTION vec2 pcg_ivec2_to_vec2(int x, int y) {
  uint a = pcg_step(uint(x));
  uint b = pcg_step(uint(y));
  a += b * 1664525u;
  b += a * 1664525u;
  a = pcg_fold(a);
  b = pcg_fold(b);
  a += b * 1664525u;
  b += a * 1664525u;
  return vec2(unit_from_pcg(a), unit_from_pcg(b));
}

NODE_FUNCTION vec3 pcg_ivec3_to_vec3(int x, int y, int z) {
  uint a = pcg_step(uint(x));
  uint b = pcg_step(uint(y));
  uint c = pcg_step(uint(z));
  a += b * c;
  b += c * a;
  c += a * b;
  a = pcg_fold(a);
  b = pcg_fold(b);
  c = pcg_fold(c);
  a += b * c;
  b += c * a;
  c += a * b;
  return vec3(unit_from_pcg(a), unit_from_pcg(b), unit_from_pcg(c));
}

NODE_FUNCTION vec4 pcg_ivec4_to_vec4(int x, int y, int z, int w) {
  uint a = pcg_step(uint(x));
  uint b = pcg_step(uint(y));
  uint c = pcg_step(uint(z));
  uint d = pcg_step(uint(w));
  a += b * d;
  b += c * a;
  c += a * b;
  d += b * c;
  a = pcg_fold(a);
  b = pcg_fold(b);
  c = pcg_fold(c);
  d = pcg_fold(d);
  a += b * d;
  b += c * a;
  c += a * b;
  d += b * c;
  return vec4(unit_from_pcg(a), unit_from_pcg(b), unit_from_pcg(c), unit_from_pcg(d));
}
