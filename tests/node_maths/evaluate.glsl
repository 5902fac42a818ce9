// SPDX-License-Identifier: GPL-3.0-or-later
// One call of a node's function, for the shaders and for C++: which by its place in the table of
// evaluate.h, where its parameters `q` are named. `at` are the node's Vector and W, or the colour
// that it changes.

NODE_FUNCTION vec4 wide(vec3 v) { return vec4(v.x, v.y, v.z, 0.0f); }

NODE_FUNCTION vec4 evaluate(int function, float q[12], vec4 at) {
  vec3 v = vec3(at.x, at.y, at.z);
  int dimensions = int(q[0]);
  switch (function) {
    case 0: return wide(node_white_noise(dimensions, texture_point(dimensions, v, at.w, 1.0f)));
    case 1: {
      NoiseInputs inputs;
      inputs.type = uint(q[1]);
      inputs.normalize = q[2] != 0.0f;
      inputs.detail = q[4];
      inputs.roughness = q[5];
      inputs.lacunarity = q[6];
      inputs.offset = q[7];
      inputs.gain = q[8];
      inputs.distortion = q[9];
      vec4 point = texture_point(dimensions, v, at.w, q[3]);
      return wide(node_noise(dimensions, point, inputs, 3, int(q[10])));
    }
    case 2: {
      vec4 point = texture_point(dimensions, v, at.w, q[2]);
      return vec4(node_musgrave(dimensions, point, uint(q[1]), q[3], q[4], q[5], q[6], q[7]));
    }
    case 3: {
      // Four values in two calls: the distance and the colour, or the position.
      VoronoiInputs inputs;
      inputs.feature = uint(q[1]) % 5u;
      inputs.metric = uint(q[2]);
      inputs.normalize = q[3] != 0.0f;
      inputs.scale = q[4];
      inputs.detail = q[5];
      inputs.roughness = q[6];
      inputs.lacunarity = q[7];
      inputs.smoothness = q[8];
      inputs.exponent = q[9];
      inputs.randomness = q[10];
      vec4 point = texture_point(dimensions, v, at.w, q[4]);
      VoronoiFeature found = node_voronoi(dimensions, point, inputs, int(q[11]));
      if (q[1] >= 5.0f) return found.position;
      return vec4(found.color.x, found.color.y, found.color.z, found.distance);
    }
    case 4:
      return vec4(node_wave(uint(q[0]), uint(q[1]), uint(q[2]), v, q[3], q[4], q[5], q[6], q[7],
                            q[8], int(q[9])));
    case 5: return wide(node_magic(int(q[0]), v, q[1], q[2], int(q[3])));
    case 6: return vec4(node_gradient(uint(q[0]), v));
    case 7: return vec4(node_checker(v, q[0]));
    case 8: {
      vec2 brick = node_brick(v, q[0], q[1], q[2], q[3], q[4], q[5], q[6], int(q[7]), q[8],
                              int(q[9]));
      return vec4(brick.x, brick.y, 0.0f, 0.0f);
    }
    case 9: return wide(node_blend(uint(q[0]), q[1], v, vec3(q[2], q[3], q[4])));
    case 10: return wide(node_color_space(uint(q[0]), v));
    case 11: return wide(node_hue_saturation(v, q[0], q[1], q[2]));
    case 12: return wide(node_bright_contrast(v, q[0], q[1]));
    case 13: return wide(node_gamma(v, q[0]));
    case 14: return wide(node_invert(v, q[0]));
    case 15: return vec4(color_luminance(v));
    case 16: return wide(node_blackbody(q[0] + q[1] * v.x));
    case 17: return wide(node_wavelength(q[0] + q[1] * v.x));
    default: return vec4(0.0f);
  }
}
