// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient noise and its fractal sums: the nodes Noise Texture and Musgrave Texture.
//
// Points have as many of their components in use, from x on, as there are dimensions (1 to 4); of
// one dimension that is the node's W, of four W comes last. `blender` is the major version of the
// Blender whose results are wanted: 3, 4 or 5.

const uint kNoiseFbm = 0u;
const uint kNoiseMultifractal = 1u;
const uint kNoiseHybridMultifractal = 2u;
const uint kNoiseRidgedMultifractal = 3u;
const uint kNoiseHeteroTerrain = 4u;

// Inputs of Noise Texture. Before Blender 4 there are neither types nor lacunarity, offset, gain
// and normalize: kNoiseFbm, 2, 0, 0 and true.
struct NoiseInputs {
  uint type;         // kNoise…
  bool normalize;    // fBM in 0 to 1 around 0.5, else around 0
  float detail;      // octaves above the first, held in 0 to 15; a part of one is blended in
  float roughness;   // amplitude of an octave over that of the one before, not negative
  float lacunarity;  // frequency of an octave over that of the one before
  float offset;      // of hybrid, ridged and hetero terrain
  float gain;        // of hybrid and ridged
  float distortion;  // by noise, in units of the scaled coordinates
};

// The node's coordinates as a point: `vector` and `w` times `scale`.
NODE_FUNCTION vec4 texture_point(int dimensions, vec3 vector, float w, float scale) {
  if (dimensions == 1) return vec4(w * scale, 0.0f, 0.0f, 0.0f);
  return vec4(vector.x * scale, vector.y * scale, dimensions > 2 ? vector.z * scale : 0.0f,
              dimensions > 3 ? w * scale : 0.0f);
}

// ---- one octave --------------------------------------------------------------------------------

NODE_INLINE float negative_where(uint bits, uint bit, float x) {
  return (bits & bit) != 0u ? -x : x;
}

// The dot product of `p` and the gradient that a corner's hash picks.
NODE_INLINE float noise_gradient(int dimensions, uint hash, vec4 p) {
  if (dimensions == 1) return negative_where(hash, 8u, 1.0f + float(hash & 7u)) * p.x;
  if (dimensions == 2) {
    bool first = (hash & 7u) < 4u;
    return negative_where(hash, 1u, first ? p.x : p.y) +
           negative_where(hash, 2u, 2.0f * (first ? p.y : p.x));
  }
  if (dimensions == 3) {
    uint h = hash & 15u;
    float v = h < 4u ? p.y : (h == 12u || h == 14u) ? p.x : p.z;
    return negative_where(hash, 1u, h < 8u ? p.x : p.y) + negative_where(hash, 2u, v);
  }
  uint h = hash & 31u;
  return negative_where(hash, 1u, h < 24u ? p.x : p.y) +
         negative_where(hash, 2u, h < 16u ? p.y : p.z) +
         negative_where(hash, 4u, h < 8u ? p.z : p.w);
}

NODE_INLINE uint noise_hash(int dimensions, uint x, uint y, uint z, uint w) {
  if (dimensions == 1) return hash_uint(x);
  if (dimensions == 2) return hash_uint2(x, y);
  if (dimensions == 3) return hash_uint3(x, y, z);
  return hash_uint4(x, y, z, w);
}

// The weight of a cell's far side: 0 to 1, with neither slope nor curvature at the ends.
NODE_FUNCTION float noise_fade(float t) {
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

// Perlin's noise, not scaled: the gradients at the corners of the cell, each with its weight.
NODE_INLINE float perlin_noise(int dimensions, vec4 p) {
  vec4 cell = floor(p);
  vec4 within = p - cell;
  uint x = uint(whole_number(cell.x));
  uint y = uint(whole_number(cell.y));
  uint z = uint(whole_number(cell.z));
  uint w = uint(whole_number(cell.w));
  vec4 far = vec4(noise_fade(within.x), noise_fade(within.y), noise_fade(within.z),
                  noise_fade(within.w));
  float sum = 0.0f;
  for (uint corner = 0u; corner < (1u << dimensions); ++corner) {
    uint i = corner & 1u;
    uint j = (corner >> 1) & 1u;
    uint k = (corner >> 2) & 1u;
    uint l = (corner >> 3) & 1u;
    vec4 from_corner = within - vec4(float(i), float(j), float(k), float(l));
    float weight = i != 0u ? far.x : 1.0f - far.x;
    if (dimensions > 1) weight *= j != 0u ? far.y : 1.0f - far.y;
    if (dimensions > 2) weight *= k != 0u ? far.z : 1.0f - far.z;
    if (dimensions > 3) weight *= l != 0u ? far.w : 1.0f - far.w;
    uint hash = noise_hash(dimensions, x + i, y + j, z + k, w + l);
    sum += weight * noise_gradient(dimensions, hash, from_corner);
  }
  return sum;
}

// Coordinates repeat after 100000, where floats become coarse, and are never whole beyond 1000000.
NODE_FUNCTION float noise_wrap(float x) {
  if (abs(x) < 100000.0f) return x;
  return signed_remainder(x, 100000.0f) + (abs(x) >= 1000000.0f ? 0.5f : 0.0f);
}

// Noise of about -1 to 1. Infinite and undefined coordinates give 0.
NODE_FUNCTION float signed_noise(int dimensions, vec4 point, int blender) {
  vec4 p = point;
  if (blender >= 4) p = vec4(noise_wrap(p.x), noise_wrap(p.y), noise_wrap(p.z), noise_wrap(p.w));
  float value = 0.0f;
  switch (dimensions) {
    case 1: value = 0.2500f * perlin_noise(1, p); break;
    case 2: value = 0.6616f * perlin_noise(2, p); break;
    case 3: value = 0.9820f * perlin_noise(3, p); break;
    default: value = 0.8344f * perlin_noise(4, p); break;
  }
  return abs(value) < 1e30f ? value : 0.0f;
}

// ---- sums of octaves ---------------------------------------------------------------------------

// `whole` octaves and the share `rest` of one more, as the type of noise combines them. Only what
// NoiseInputs says of the combination counts: type, normalize, roughness, lacunarity, offset, gain.
NODE_FUNCTION float noise_sum(int dimensions, vec4 point, NoiseInputs inputs, int whole, float rest,
                              int blender) {
  vec4 p = point;
  float frequency = 1.0f;
  float amplitude = 1.0f;
  float total = 0.0f;  // of the amplitudes
  float value = inputs.type == kNoiseMultifractal ? 1.0f : 0.0f;
  float signal = 0.0f;
  float weight = 1.0f;
  bool first_always =
      inputs.type == kNoiseHeteroTerrain || inputs.type == kNoiseRidgedMultifractal;
  int full = first_always ? max(whole, 1) : whole;
  int count = rest != 0.0f && inputs.type != kNoiseRidgedMultifractal ? full + 1 : full;
  for (int i = 0; i < count; ++i) {
    float share = i < full ? 1.0f : rest;
    float noise = signed_noise(dimensions, p, blender);
    switch (inputs.type) {
      case kNoiseFbm:
        if (i < full) {
          value += noise * amplitude;
          total += amplitude;
        } else if (inputs.normalize) {
          return mix(0.5f * value / total + 0.5f,
                     0.5f * (value + noise * amplitude) / (total + amplitude) + 0.5f, rest);
        } else {
          value = mix(value, value + noise * amplitude, rest);
        }
        break;
      case kNoiseMultifractal: value *= share * amplitude * noise + 1.0f; break;
      case kNoiseHybridMultifractal:
        weight = min(weight, 1.0f);
        signal = (noise + inputs.offset) * amplitude;
        value += share * weight * signal;
        weight *= inputs.gain * signal;
        if (!(weight > 0.001f)) return value;
        break;
      case kNoiseRidgedMultifractal:
        weight = i == 0 ? 1.0f : clamp(signal * inputs.gain, 0.0f, 1.0f);
        signal = inputs.offset - abs(noise);
        signal *= signal * weight;
        value += signal * amplitude;
        break;
      default:
        signal = noise + inputs.offset;
        value += i == 0 ? signal : share * signal * amplitude * value;
        break;
    }
    amplitude *= inputs.roughness;
    frequency *= inputs.lacunarity;
    // The versions round differently.
    if (blender >= 4 && inputs.type == kNoiseFbm) {
      p = frequency * point;
    } else {
      p *= inputs.lacunarity;
    }
  }
  if (inputs.type == kNoiseFbm && inputs.normalize) return 0.5f * value / total + 0.5f;
  return value;
}

// Noise Texture's Factor at a point of texture_point(), not distorted.
NODE_FUNCTION float noise_fractal(int dimensions, vec4 p, NoiseInputs inputs, int blender) {
  NoiseInputs held = inputs;
  float detail = clamp(inputs.detail, 0.0f, 15.0f);
  held.roughness = clamp(inputs.roughness, 0.0f, blender < 4 ? 1.0f : 1e30f);
  return noise_sum(dimensions, p, held, int(detail) + 1, fract(detail), blender);
}

// What makes another noise of the same function: an offset of 100 to 200 along each axis.
NODE_FUNCTION vec4 noise_seed_offset(int dimensions, float seed) {
  if (dimensions == 1) return vec4(100.0f + 100.0f * hash_float(seed), 0.0f, 0.0f, 0.0f);
  return vec4(100.0f) +
         100.0f * vec4(hash_vec2(vec2(seed, 0.0f)), hash_vec2(vec2(seed, 1.0f)),
                       hash_vec2(vec2(seed, 2.0f)), hash_vec2(vec2(seed, 3.0f)));
}

// ---- nodes -------------------------------------------------------------------------------------

// Noise Texture: Color; its first component is Factor. `channels` is 1 where only that is wanted,
// the others then being 0, else 3. `point` is that of texture_point().
NODE_FUNCTION vec3 node_noise(int dimensions, vec4 point, NoiseInputs inputs, int channels,
                              int blender) {
  vec4 p = point;
  if (inputs.distortion != 0.0f) {
    float moved[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    for (int i = 0; i < dimensions; ++i) {
      vec4 seeded = point + noise_seed_offset(dimensions, float(i));
      moved[i] = signed_noise(dimensions, seeded, blender);
    }
    p += inputs.distortion * vec4(moved[0], moved[1], moved[2], moved[3]);
  }
  float values[3] = {0.0f, 0.0f, 0.0f};
  for (int channel = 0; channel < channels; ++channel) {
    vec4 seeded = p;
    if (channel > 0) seeded += noise_seed_offset(dimensions, float(dimensions + channel - 1));
    values[channel] = noise_fractal(dimensions, seeded, inputs, blender);
  }
  return vec3(values[0], values[1], values[2]);
}

// Musgrave Texture: Height, as before Blender 4.1. `type` is kNoise…; `octaves` is the node's
// Detail, held in 0 to 15, `dimension` and `lacunarity` at least 0.00001.
NODE_FUNCTION float node_musgrave(int dimensions, vec4 point, uint type, float octaves,
                                  float dimension, float lacunarity, float offset, float gain) {
  NoiseInputs inputs;
  inputs.type = type;
  inputs.normalize = false;
  inputs.lacunarity = max(lacunarity, 1e-5f);
  inputs.roughness = pow(inputs.lacunarity, -max(dimension, 1e-5f));
  inputs.offset = offset;
  inputs.gain = gain;
  inputs.detail = clamp(octaves, 0.0f, 15.0f);
  inputs.distortion = 0.0f;
  return noise_sum(dimensions, point, inputs, int(inputs.detail), fract(inputs.detail), 3);
}
