// SPDX-License-Identifier: GPL-3.0-or-later
// Wave Texture.

const uint kWaveBands = 0u;
const uint kWaveRings = 1u;

// Factor of 0 to 1. `type` is kWaveBands or kWaveRings; `direction` 0 X, 1 Y, 2 Z, 3 diagonal
// bands or spherical rings; `profile` 0 sine, 1 saw, 2 triangle; `phase` in radians; `detail` is
// held in 0 to 15. `blender` is that of noise.glsl.
NODE_FUNCTION float node_wave(uint type, uint direction, uint profile, vec3 vector, float scale,
                              float distortion, float detail, float detail_scale, float roughness,
                              float phase, int blender) {
  vec3 p = (vector * scale + vec3(0.000001f)) * 0.999999f;  // whole coordinates off the edges
  float angle = 0.0f;
  if (type == kWaveBands) {
    angle = direction == 0u   ? 20.0f * p.x
            : direction == 1u ? 20.0f * p.y
            : direction == 2u ? 20.0f * p.z
                              : 10.0f * (p.x + p.y + p.z);
  } else {
    vec3 across = vec3(direction == 0u ? 0.0f : p.x, direction == 1u ? 0.0f : p.y,
                       direction == 2u ? 0.0f : p.z);
    angle = 20.0f * length(across);
  }
  angle += phase;
  if (distortion != 0.0f) {
    NoiseInputs inputs;
    inputs.type = kNoiseFbm;
    inputs.normalize = true;
    inputs.detail = detail;
    inputs.roughness = roughness;
    inputs.lacunarity = 2.0f;
    inputs.offset = 0.0f;
    inputs.gain = 0.0f;
    inputs.distortion = 0.0f;
    vec4 point = texture_point(3, p, 0.0f, detail_scale);
    angle += distortion * (noise_fractal(3, point, inputs, blender) * 2.0f - 1.0f);
  }
  if (profile == 0u) return 0.5f + 0.5f * sin(angle - 1.57079632679f);
  float turns = angle / 6.28318530718f;
  if (profile == 1u) return turns - floor(turns);
  return 2.0f * abs(turns - floor(turns + 0.5f));
}
