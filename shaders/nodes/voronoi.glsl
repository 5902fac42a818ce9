// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi Texture. Points, dimensions and `blender` are those of noise.glsl. Each cell of the
// unit grid holds one feature point.

const uint kVoronoiEuclidean = 0u;
const uint kVoronoiManhattan = 1u;
const uint kVoronoiChebychev = 2u;
const uint kVoronoiMinkowski = 3u;

const uint kVoronoiF1 = 0u;
const uint kVoronoiF2 = 1u;
const uint kVoronoiSmoothF1 = 2u;
const uint kVoronoiDistanceToEdge = 3u;
const uint kVoronoiNSphereRadius = 4u;

// Inputs of Voronoi Texture. Before Blender 4 there are neither detail, roughness, lacunarity and
// normalize: 0, 0, 2 and false.
struct VoronoiInputs {
  uint feature;      // kVoronoiF1 …
  uint metric;       // kVoronoiEuclidean …, of F1, F2 and smooth F1 in more than one dimension
  bool normalize;    // distances so that they end at about 1
  float scale;       // the one that the point was made with
  float detail;      // octaves above the first, held in 0 to 15
  float roughness;   // held in 0 to 1
  float lacunarity;
  float smoothness;  // held in 0 to 1
  float exponent;    // of Minkowski
  float randomness;  // held in 0 to 1; 0 puts the points into their cells' lower corners
};

// What a feature gives; position in the units of the node's coordinates, W in its w.
struct VoronoiFeature {
  float distance;  // N-sphere radius: the radius
  vec3 color;
  vec4 position;
};

const float kVoronoiFar = 3.402823466e+38f;

// ---- cells -------------------------------------------------------------------------------------

// Where in its cell a feature point is at a randomness of 1, each component in 0 to 1.
NODE_FUNCTION vec4 voronoi_place(int dimensions, vec4 cell, int blender) {
  if (dimensions == 1) return vec4(hash_float(cell.x), 0.0f, 0.0f, 0.0f);
  if (blender >= 5) {
    int x = whole_number(cell.x);
    int y = whole_number(cell.y);
    if (dimensions == 2) {
      vec2 place = pcg_ivec2_to_vec2(x, y);
      return vec4(place.x, place.y, 0.0f, 0.0f);
    }
    int z = whole_number(cell.z);
    if (dimensions == 4) return pcg_ivec4_to_vec4(x, y, z, whole_number(cell.w));
    vec3 place = pcg_ivec3_to_vec3(x, y, z);
    return vec4(place.x, place.y, place.z, 0.0f);
  }
  if (dimensions == 2) {
    vec2 place = hash_vec2_to_vec2(vec2(cell.x, cell.y));
    return vec4(place.x, place.y, 0.0f, 0.0f);
  }
  if (dimensions == 4) return hash_vec4_to_vec4(cell);
  vec3 place = hash_vec3_to_vec3(vec3(cell.x, cell.y, cell.z));
  return vec4(place.x, place.y, place.z, 0.0f);
}

NODE_FUNCTION vec3 voronoi_color(int dimensions, vec4 cell, int blender) {
  if (dimensions == 1) return hash_float_to_vec3(cell.x);
  if (blender >= 5) {
    int x = whole_number(cell.x);
    int y = whole_number(cell.y);
    if (dimensions == 2) return pcg_ivec3_to_vec3(x, y, 0);
    int z = whole_number(cell.z);
    if (dimensions == 3) return pcg_ivec3_to_vec3(x, y, z);
    vec4 color = pcg_ivec4_to_vec4(x, y, z, whole_number(cell.w));
    return vec3(color.x, color.y, color.z);
  }
  if (dimensions == 2) return hash_vec2_to_vec3(vec2(cell.x, cell.y));
  if (dimensions == 3) return hash_vec3_to_vec3(vec3(cell.x, cell.y, cell.z));
  return hash_vec4_to_vec3(cell);
}

// From the cell on one side of all others up to `reach` cells away along each axis...
NODE_FUNCTION vec4 voronoi_first(int dimensions, int reach) {
  float side = -float(reach);
  return vec4(side, dimensions > 1 ? side : 0.0f, dimensions > 2 ? side : 0.0f,
              dimensions > 3 ? side : 0.0f);
}

// ... to the next of them, x running fastest...
NODE_FUNCTION vec4 voronoi_next(int reach, vec4 cell) {
  float side = float(reach);
  if (cell.x < side) return vec4(cell.x + 1.0f, cell.y, cell.z, cell.w);
  if (cell.y < side) return vec4(-side, cell.y + 1.0f, cell.z, cell.w);
  if (cell.z < side) return vec4(-side, -side, cell.z + 1.0f, cell.w);
  return vec4(-side, -side, -side, cell.w + 1.0f);
}

// ... so many times.
NODE_FUNCTION int voronoi_count(int dimensions, int reach) {
  int width = 2 * reach + 1;
  int square = width * width;
  return dimensions == 1 ? width : dimensions == 2 ? square : dimensions == 3 ? square * width
                                                                             : square * square;
}

NODE_FUNCTION float voronoi_distance(int dimensions, vec4 way, VoronoiInputs inputs) {
  vec4 d = abs(way);
  if (dimensions == 1) return d.x;
  switch (inputs.metric) {
    case kVoronoiEuclidean: return length(way);
    case kVoronoiManhattan: return d.x + d.y + d.z + d.w;
    case kVoronoiChebychev: return max(max(d.x, d.y), max(d.z, d.w));
    default: {
      float sum = pow(d.x, inputs.exponent) + pow(d.y, inputs.exponent);
      if (dimensions > 2) sum += pow(d.z, inputs.exponent);
      if (dimensions > 3) sum += pow(d.w, inputs.exponent);
      return pow(sum, 1.0f / inputs.exponent);
    }
  }
}

// ---- features of one octave --------------------------------------------------------------------

// F1, F2 and smooth F1; `inputs` as node_voronoi() holds them.
NODE_FUNCTION VoronoiFeature voronoi_point(int dimensions, vec4 p, VoronoiInputs inputs,
                                           int blender) {
  vec4 cell = floor(p);
  vec4 within = p - cell;
  bool is_smooth = inputs.feature == kVoronoiSmoothF1;
  float far = blender < 4 ? 8.0f : kVoronoiFar;
  float nearest = far;
  float second = far;
  vec4 nearest_offset = vec4(0.0f);
  vec4 second_offset = vec4(0.0f);
  vec4 nearest_point = vec4(0.0f);
  vec4 second_point = vec4(0.0f);
  vec3 color = vec3(0.0f);
  int reach = is_smooth ? 2 : 1;
  int count = voronoi_count(dimensions, reach);
  vec4 offset = voronoi_first(dimensions, reach);
  for (int i = 0; i < count; ++i) {
    vec4 point = offset + inputs.randomness * voronoi_place(dimensions, cell + offset, blender);
    float distance = voronoi_distance(dimensions, point - within, inputs);
    if (is_smooth) {
      float share = i == 0 && blender >= 4
                        ? 1.0f
                        : smoothstep(0.0f, 1.0f,
                                     0.5f + 0.5f * (nearest - distance) / inputs.smoothness);
      float correction = inputs.smoothness * share * (1.0f - share);
      nearest = (i == 0 && share == 1.0f ? distance : mix(nearest, distance, share)) - correction;
      correction /= 1.0f + 3.0f * inputs.smoothness;
      vec3 cell_color = voronoi_color(dimensions, cell + offset, blender);
      color = mix(color, cell_color, share) - vec3(correction);
      nearest_point = mix(nearest_point, point, share) - vec4(correction);
    } else if (distance < nearest) {
      second = nearest;
      second_offset = nearest_offset;
      second_point = nearest_point;
      nearest = distance;
      nearest_offset = offset;
      nearest_point = point;
    } else if (distance < second) {
      second = distance;
      second_offset = offset;
      second_point = point;
    }
    offset = voronoi_next(reach, offset);
  }
  bool is_second = inputs.feature == kVoronoiF2;
  VoronoiFeature result;
  result.distance = is_second ? second : nearest;
  result.position = cell + (is_second ? second_point : nearest_point);
  result.color = color;
  if (!is_smooth) {
    vec4 own_cell = cell + (is_second ? second_offset : nearest_offset);
    result.color = voronoi_color(dimensions, own_cell, blender);
  }
  return result;
}

NODE_FUNCTION float voronoi_edge(int dimensions, vec4 p, VoronoiInputs inputs, int blender) {
  vec4 cell = floor(p);
  vec4 within = p - cell;
  float largest = blender < 4 ? 8.0f : kVoronoiFar;
  if (dimensions == 1) {
    float left = -1.0f + inputs.randomness * hash_float(cell.x - 1.0f);
    float middle = inputs.randomness * hash_float(cell.x);
    float right = 1.0f + inputs.randomness * hash_float(cell.x + 1.0f);
    return min(abs((middle + left) * 0.5f - within.x), abs((middle + right) * 0.5f - within.x));
  }
  int count = voronoi_count(dimensions, 1);
  float smallest = largest;
  vec4 nearest = vec4(0.0f);
  float distance = largest;
  // First the nearest point, then the nearest plane halfway between it and another.
  for (int pass = 0; pass < 2; ++pass) {
    vec4 offset = voronoi_first(dimensions, 1);
    for (int i = 0; i < count; ++i) {
      vec4 point =
          offset + inputs.randomness * voronoi_place(dimensions, cell + offset, blender) - within;
      vec4 across = point - nearest;
      float square = dot(point, point);
      if (pass == 0 && square < smallest) {
        smallest = square;
        nearest = point;
      }
      if (pass == 1 && dot(across, across) > 0.0001f) {
        distance = min(distance, dot((nearest + point) * 0.5f, normalize(across)));
      }
      offset = voronoi_next(1, offset);
    }
  }
  return distance;
}

// Half the way from the nearest feature point to the one nearest to that.
NODE_FUNCTION float voronoi_radius(int dimensions, vec4 p, VoronoiInputs inputs, int blender) {
  vec4 cell = floor(p);
  vec4 within = p - cell;
  int count = voronoi_count(dimensions, 1);
  vec4 center = vec4(0.0f);
  vec4 center_offset = vec4(0.0f);
  vec4 found = vec4(0.0f);
  vec4 found_offset = vec4(0.0f);
  float nearest = blender < 4 ? 8.0f : kVoronoiFar;
  float second = nearest;
  for (int pass = 0; pass < 2; ++pass) {
    vec4 offset = voronoi_first(dimensions, 1);
    for (int i = 0; i < count; ++i) {
      vec4 there = offset + center_offset;  // center_offset is 0 in the first pass
      vec4 point = there + inputs.randomness * voronoi_place(dimensions, cell + there, blender);
      if (pass == 1) {
        if (i != count / 2) second = min(second, length(point - center));
      } else if (length(point - within) < nearest) {
        nearest = length(point - within);
        found = point;
        found_offset = offset;
      }
      offset = voronoi_next(1, offset);
    }
    center = found;
    center_offset = found_offset;
  }
  return second * 0.5f;
}

// ---- octaves -----------------------------------------------------------------------------------

// Voronoi Texture: Distance, Color, Position and W, or the radius as the distance. `point` is that
// of texture_point().
NODE_FUNCTION VoronoiFeature node_voronoi(int dimensions, vec4 point, VoronoiInputs given,
                                          int blender) {
  VoronoiInputs inputs = given;
  inputs.detail = clamp(given.detail, 0.0f, 15.0f);
  inputs.roughness = clamp(given.roughness, 0.0f, 1.0f);
  inputs.randomness = clamp(given.randomness, 0.0f, 1.0f);
  inputs.smoothness = clamp(given.smoothness * 0.5f, 0.0f, 0.5f);
  if (inputs.feature == kVoronoiSmoothF1 && inputs.smoothness == 0.0f) inputs.feature = kVoronoiF1;
  bool edge = inputs.feature == kVoronoiDistanceToEdge;
  VoronoiFeature result;
  result.distance = edge ? 8.0f : 0.0f;
  result.color = vec3(0.0f);
  result.position = vec4(0.0f);
  if (inputs.feature == kVoronoiNSphereRadius) {
    result.distance = voronoi_radius(dimensions, point, inputs, blender);
    return result;
  }
  // The farthest that a point can be.
  float half_cell = 0.5f + 0.5f * inputs.randomness;
  float largest = half_cell;
  if (!edge) {
    largest = voronoi_distance(dimensions,
                               vec4(half_cell, half_cell, dimensions > 2 ? half_cell : 0.0f,
                                    dimensions > 3 ? half_cell : 0.0f),
                               inputs);
    if (inputs.feature == kVoronoiF2) largest *= 2.0f;
  }
  bool one_octave = inputs.detail == 0.0f || inputs.roughness == 0.0f;
  int full = one_octave ? 1 : int(inputs.detail) + 1;
  float rest = one_octave ? 0.0f : fract(inputs.detail);
  int count = rest != 0.0f ? full + 1 : full;
  float amplitude = 1.0f;
  float frequency = 1.0f;
  float total = edge ? largest : 0.0f;
  for (int i = 0; i < count; ++i) {
    float share = i < full ? 1.0f : rest;
    if (edge) {
      float distance = voronoi_edge(dimensions, frequency * point, inputs, blender);
      if (one_octave) {
        result.distance = distance;
      } else {
        float nearer = min(result.distance, distance / frequency);
        float blended = mix(result.distance, nearer, amplitude);
        if (i >= full) blended = min(result.distance, blended);
        result.distance = mix(result.distance, blended, share);
        total = mix(total, mix(total, largest / frequency, amplitude), share);
      }
    } else {
      VoronoiFeature octave = voronoi_point(dimensions, frequency * point, inputs, blender);
      result.distance += share * amplitude * octave.distance;
      result.color += share * amplitude * octave.color;
      vec4 position = mix(result.position, octave.position / frequency, amplitude);
      result.position = mix(result.position, position, share);
      total += share * amplitude;
    }
    frequency *= inputs.lacunarity;
    amplitude *= inputs.roughness;
  }
  if (inputs.normalize) {
    result.distance /= edge ? total : total * largest;
    result.color /= total;
  }
  if (edge) {
    result.color = vec3(0.0f);
    return result;
  }
  vec4 position = inputs.scale != 0.0f ? result.position / inputs.scale : vec4(0.0f);
  result.position = vec4(position.x, position.y, dimensions > 2 ? position.z : 0.0f,
                         dimensions > 3 ? position.w : 0.0f);
  if (dimensions == 1) result.position = vec4(0.0f, 0.0f, 0.0f, position.x);
  return result;
}
