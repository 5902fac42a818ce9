// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic of nodes, as Blender's render engines define it. For the shaders and for C++.

NODE_FUNCTION vec4 node_scalar(float x) { return vec4(x, x, x, 1.0f); }
NODE_FUNCTION vec4 node_vector(vec3 v) { return vec4(v.x, v.y, v.z, 1.0f); }
NODE_FUNCTION vec3 node_xyz(vec4 v) { return vec3(v.x, v.y, v.z); }

NODE_FUNCTION float node_divide(float a, float b) { return b != 0.0f ? a / b : 0.0f; }

NODE_FUNCTION float node_power(float a, float b) {
  if (b == 0.0f) return 1.0f;
  if (a == 0.0f) return 0.0f;
  if (a > 0.0f) return pow(a, b);
  if (b != floor(b)) return 0.0f;  // a root of a negative number
  float magnitude = pow(-a, b);
  return fract(b * 0.5f) == 0.0f ? magnitude : -magnitude;
}

NODE_FUNCTION float node_truncate(float a) { return a < 0.0f ? ceil(a) : floor(a); }

NODE_FUNCTION float node_modulo(float a, float b) {
  return b != 0.0f ? a - b * node_truncate(a / b) : 0.0f;
}

NODE_FUNCTION float node_floored_modulo(float a, float b) {
  return b != 0.0f ? a - b * floor(a / b) : 0.0f;
}

NODE_FUNCTION float node_wrap(float a, float upper, float lower) {
  float range = upper - lower;
  return range != 0.0f ? a - range * floor((a - lower) / range) : lower;
}

NODE_FUNCTION float node_pingpong(float a, float scale) {
  if (scale == 0.0f) return 0.0f;
  return abs(fract((a - scale) / (scale * 2.0f)) * scale * 2.0f - scale);
}

NODE_FUNCTION float node_smooth_min(float a, float b, float k) {
  if (k == 0.0f) return min(a, b);
  float h = max(k - abs(a - b), 0.0f) / k;
  return min(a, b) - h * h * h * k * (1.0f / 6.0f);
}

// `operation`: the first mode of kNodeMath.
NODE_FUNCTION float node_math(uint operation, float a, float b, float c) {
  switch (operation) {
    case 0u: return a + b;
    case 1u: return a - b;
    case 2u: return a * b;
    case 3u: return node_divide(a, b);
    case 4u: return a * b + c;
    case 5u: return node_power(a, b);
    case 6u: return a > 0.0f && b > 0.0f ? node_divide(log(a), log(b)) : 0.0f;
    case 7u: return a > 0.0f ? sqrt(a) : 0.0f;
    case 8u: return a > 0.0f ? 1.0f / sqrt(a) : 0.0f;
    case 9u: return abs(a);
    case 10u: return exp(a);
    case 11u: return min(a, b);
    case 12u: return max(a, b);
    case 13u: return a < b ? 1.0f : 0.0f;
    case 14u: return a > b ? 1.0f : 0.0f;
    case 15u: return a > 0.0f ? 1.0f : (a < 0.0f ? -1.0f : 0.0f);
    case 16u: return a == b || abs(a - b) <= max(c, 1e-5f) ? 1.0f : 0.0f;
    case 17u: return node_smooth_min(a, b, c);
    case 18u: return -node_smooth_min(-a, -b, c);
    case 19u: return floor(a + 0.5f);
    case 20u: return floor(a);
    case 21u: return ceil(a);
    case 22u: return node_truncate(a);
    case 23u: return a - floor(a);
    case 24u: return node_modulo(a, b);
    case 25u: return node_floored_modulo(a, b);
    case 26u: return node_wrap(a, b, c);
    case 27u: return floor(node_divide(a, b)) * b;
    case 28u: return node_pingpong(a, b);
    case 29u: return sin(a);
    case 30u: return cos(a);
    case 31u: return tan(a);
    case 32u: return asin(clamp(a, -1.0f, 1.0f));
    case 33u: return acos(clamp(a, -1.0f, 1.0f));
    case 34u: return atan(a);
    case 35u: return a == 0.0f && b == 0.0f ? 0.0f : atan(a, b);
    case 36u: return 0.5f * (exp(a) - exp(-a));
    case 37u: return 0.5f * (exp(a) + exp(-a));
    case 38u: return 1.0f - 2.0f / (exp(2.0f * a) + 1.0f);
    case 39u: return a * (3.14159265f / 180.0f);
    case 40u: return a * (180.0f / 3.14159265f);
    default: return 0.0f;
  }
}

NODE_FUNCTION vec3 node_divide3(vec3 a, vec3 b) {
  return vec3(node_divide(a.x, b.x), node_divide(a.y, b.y), node_divide(a.z, b.z));
}

NODE_FUNCTION vec3 node_normalize(vec3 v, vec3 fallback) {
  float squared = dot(v, v);
  return squared > 1e-30f ? v * (1.0f / sqrt(squared)) : fallback;
}

// By component what node_math() does.
NODE_FUNCTION vec3 node_math3(uint operation, vec3 a, vec3 b, vec3 c) {
  return vec3(node_math(operation, a.x, b.x, c.x), node_math(operation, a.y, b.y, c.y),
              node_math(operation, a.z, b.z, c.z));
}

NODE_FUNCTION vec3 node_refract(vec3 incident, vec3 normal, float eta) {
  float cosine = dot(normal, incident);
  float k = 1.0f - eta * eta * (1.0f - cosine * cosine);
  return k < 0.0f ? vec3(0.0f) : eta * incident - (eta * cosine + sqrt(k)) * normal;
}

// `operation`: the mode of kNodeVectorMath.
NODE_FUNCTION vec4 node_vector_math(uint operation, vec3 a, vec3 b, vec3 c, float scale) {
  switch (operation) {
    case 0u: return node_vector(a + b);
    case 1u: return node_vector(a - b);
    case 2u: return node_vector(a * b);
    case 3u: return node_vector(node_divide3(a, b));
    case 4u: return node_vector(a * b + c);
    case 5u: return node_vector(cross(a, b));
    case 6u: return node_vector(b * node_divide(dot(a, b), dot(b, b)));
    case 7u: {
      vec3 n = node_normalize(b, vec3(0.0f));
      return node_vector(a - 2.0f * dot(n, a) * n);
    }
    case 8u: return node_vector(node_refract(a, node_normalize(b, vec3(0.0f)), scale));
    case 9u: return node_vector(dot(c, b) < 0.0f ? a : -a);
    case 10u: return node_scalar(dot(a, b));
    case 11u: return node_scalar(length(a - b));
    case 12u: return node_scalar(length(a));
    case 13u: return node_vector(a * scale);
    case 14u: return node_vector(node_normalize(a, vec3(0.0f)));
    case 15u: return node_vector(abs(a));
    case 16u: return node_vector(min(a, b));
    case 17u: return node_vector(max(a, b));
    case 18u: return node_vector(floor(a));
    case 19u: return node_vector(ceil(a));
    case 20u: return node_vector(a - floor(a));
    case 21u: return node_vector(node_math3(24u, a, b, c));
    case 22u: return node_vector(node_math3(26u, a, b, c));
    case 23u: return node_vector(node_math3(27u, a, b, c));
    case 24u: return node_vector(sin(a));
    case 25u: return node_vector(cos(a));
    case 26u: return node_vector(tan(a));
    case 27u: return node_vector(node_math3(5u, a, b, c));
    case 28u: return node_vector(node_math3(15u, a, b, c));
    case 29u: return node_vector(node_math3(19u, a, b, c));
    default: return vec4(0.0f);
  }
}

// Turns by Euler angles in radians, X first.
NODE_FUNCTION mat3 node_euler(vec3 angles) {
  float cx = cos(angles.x), sx = sin(angles.x);
  float cy = cos(angles.y), sy = sin(angles.y);
  float cz = cos(angles.z), sz = sin(angles.z);
  return mat3(vec3(cy * cz, cy * sz, -sy),
              vec3(sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy),
              vec3(cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy));
}

// `type`: the mode of kNodeMapping.
NODE_FUNCTION vec3 node_mapping(uint type, vec3 v, vec3 location, vec3 rotation, vec3 scale) {
  mat3 turn = node_euler(rotation);
  switch (type) {
    case 0u: return turn * (v * scale) + location;
    case 1u: return node_divide3(transpose(turn) * (v - location), scale);
    case 2u: return turn * (v * scale);
    default: return node_normalize(turn * node_divide3(v, scale), vec3(0.0f));
  }
}

NODE_FUNCTION vec3 node_rotate_around(vec3 v, vec3 axis, float angle) {
  float c = cos(angle), s = sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0f - c));
}

// `type`: the first mode of kNodeVectorRotate.
NODE_FUNCTION vec3 node_vector_rotate(uint type, bool invert, vec3 v, vec3 center, vec3 axis,
                                      float angle, vec3 rotation) {
  vec3 from_center = v - center;
  if (type == 4u) {
    mat3 turn = node_euler(rotation);
    return (invert ? transpose(turn) * from_center : turn * from_center) + center;
  }
  vec3 around = type == 1u   ? vec3(1.0f, 0.0f, 0.0f)
                : type == 2u ? vec3(0.0f, 1.0f, 0.0f)
                : type == 3u ? vec3(0.0f, 0.0f, 1.0f)
                             : node_normalize(axis, vec3(0.0f));
  if (around == vec3(0.0f)) return v;
  return node_rotate_around(from_center, around, invert ? -angle : angle) + center;
}

// Reflectance of a boundary between dielectrics; `eta` is the index beyond over that on this side.
NODE_FUNCTION float node_fresnel(float cosine, float eta) {
  float c = abs(cosine);
  float g = eta * eta - 1.0f + c * c;
  if (g <= 0.0f) return 1.0f;
  g = sqrt(g);
  float a = (g - c) / (g + c);
  float b = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
  return 0.5f * a * a * (1.0f + b * b);
}

NODE_FUNCTION float node_facing(float cosine, float blend) {
  float f = abs(cosine);
  if (blend != 0.5f) {
    float b = clamp(blend, 0.0f, 1.0f - 1e-5f);
    f = pow(f, b < 0.5f ? 2.0f * b : 0.5f / (1.0f - b));
  }
  return 1.0f - f;
}

// `height` here and one step beside, along `step_x` and `step_y` on the surface.
NODE_FUNCTION vec3 node_bump(vec3 normal, vec3 step_x, vec3 step_y, float height, float height_x,
                             float height_y, float strength, float distance) {
  vec3 across_x = cross(step_y, normal);
  vec3 across_y = cross(normal, step_x);
  float determinant = dot(step_x, across_x);
  vec3 gradient = (height_x - height) * across_x + (height_y - height) * across_y;
  vec3 bent = node_normalize(
      abs(determinant) * normal - distance * (determinant < 0.0f ? -1.0f : 1.0f) * gradient,
      normal);
  float s = max(strength, 0.0f);
  return node_normalize(s * bent + (1.0f - s) * normal, normal);
}

// ---- where an image is looked up; all return texture coordinates ------------------------------

NODE_FUNCTION vec2 node_equirectangular(vec3 v) {
  float flat_length = sqrt(v.x * v.x + v.y * v.y);
  float around = v.x == 0.0f && v.y == 0.0f ? 0.0f : atan(v.y, v.x);
  return vec2(0.5f - around * (0.5f / 3.14159265f),
              (flat_length == 0.0f && v.z == 0.0f ? 0.0f : atan(v.z, flat_length)) / 3.14159265f +
                  0.5f);
}

NODE_FUNCTION vec2 node_mirror_ball(vec3 v) {
  float y = v.y - 1.0f;
  float width = 2.0f * sqrt(max(-0.5f * y, 0.0f));
  float factor = width > 0.0f ? 1.0f / width : 1.0f;
  return vec2(0.5f * (v.x * factor + 1.0f), 0.5f * (v.z * factor + 1.0f));
}

NODE_FUNCTION vec2 node_sphere(vec3 unit_cube) {
  vec3 v = (unit_cube - vec3(0.5f)) * 2.0f;
  float l = length(v);
  if (!(l > 0.0f)) return vec2(0.0f);
  float u = v.x == 0.0f && v.y == 0.0f ? 0.0f : 0.5f * (1.0f - atan(v.x, v.y) / 3.14159265f);
  return vec2(u, 1.0f - acos(clamp(v.z / l, -1.0f, 1.0f)) / 3.14159265f);
}

NODE_FUNCTION vec2 node_tube(vec3 unit_cube) {
  vec3 v = (unit_cube - vec3(0.5f)) * 2.0f;
  if (v.x == 0.0f && v.y == 0.0f) return vec2(0.0f);
  return vec2(0.5f * (1.0f - atan(v.x, v.y) / 3.14159265f), 0.5f * (v.z + 1.0f));
}

NODE_FUNCTION float node_box_edge(float a, float b, float blend) {
  return clamp((a / (a + b) - 0.5f * (1.0f - blend)) / blend, 0.0f, 1.0f);
}

// How much each side of a box counts where the surface has this normal.
NODE_FUNCTION vec3 node_box_weights(vec3 normal, float blend) {
  vec3 n = abs(normal);
  n = n * node_divide(1.0f, n.x + n.y + n.z);
  float limit = 0.5f * (1.0f + blend);
  if (n.x > limit * (n.x + n.y) && n.x > limit * (n.x + n.z)) return vec3(1.0f, 0.0f, 0.0f);
  if (n.y > limit * (n.x + n.y) && n.y > limit * (n.y + n.z)) return vec3(0.0f, 1.0f, 0.0f);
  if (n.z > limit * (n.x + n.z) && n.z > limit * (n.y + n.z)) return vec3(0.0f, 0.0f, 1.0f);
  if (!(blend > 0.0f)) return vec3(1.0f, 0.0f, 0.0f);
  if (n.z < (1.0f - limit) * (n.y + n.x)) {
    float x = node_box_edge(n.x, n.y, blend);
    return vec3(x, 1.0f - x, 0.0f);
  }
  if (n.x < (1.0f - limit) * (n.y + n.z)) {
    float y = node_box_edge(n.y, n.z, blend);
    return vec3(0.0f, y, 1.0f - y);
  }
  if (n.y < (1.0f - limit) * (n.x + n.z)) {
    float x = node_box_edge(n.x, n.z, blend);
    return vec3(x, 0.0f, 1.0f - x);
  }
  return ((2.0f - limit) * n + vec3(limit - 1.0f)) * (1.0f / (2.0f * limit - 1.0f));
}

NODE_FUNCTION vec2 node_box_side(uint side, vec3 v, vec3 normal) {
  if (side == 0u) return vec2(normal.x < 0.0f ? 1.0f - v.y : v.y, v.z);
  if (side == 1u) return vec2(normal.y > 0.0f ? 1.0f - v.x : v.x, v.z);
  return vec2(normal.z > 0.0f ? 1.0f - v.y : v.y, v.x);
}
