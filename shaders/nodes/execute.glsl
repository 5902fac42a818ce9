// SPDX-License-Identifier: GPL-3.0-or-later
// One instruction of a node program. For the shaders and for C++.
//
// Who includes it brings, after NODE_HOST's arguments:
//   vec4 node_texture(int texture, vec2 uv)       RGBA, linear
//   vec4 node_attribute(int attribute, int place) value of the mesh: here, or a step beside
//   vec4 node_constant(int index)
//   vec3 node_transform(vec3 v, uint type, uint from, uint to)  as kNodeVectorTransform has them
// NODE_HOST is empty in GLSL; in C++ it hands the point's own data from function to function.

// The lowest digit of a mode with so many values; the rest stays in `mode`.
NODE_FUNCTION uint node_digit(INOUT(uint) mode, uint count) {
  uint digit = mode % count;
  mode = mode / count;
  return digit;
}

// Which Blender's textures are meant, by a mode that holds nothing else.
NODE_FUNCTION int node_blender(uint mode) { return 3 + int(mode); }

// `place`: 0 here, 1 and 2 a step beside (for bumps).
NODE_FUNCTION vec4 node_input(NODE_HOST_PARAMETER uint what, int place, NodePoint p) {
  vec3 beside = place == 1 ? p.step_x : place == 2 ? p.step_y : vec3(0.0f);
  vec3 beside_os = place == 1 ? p.step_x_os : place == 2 ? p.step_y_os : vec3(0.0f);
  switch (what) {
    case kInputPosition: return node_vector(p.position + beside);
    case kInputObject: return node_vector(p.position_os + beside_os);
    case kInputGenerated:
      return node_vector((p.position_os + beside_os - p.texture_space_from) *
                         p.texture_space_scale);
    case kInputCamera: return node_vector(p.position_camera);
    case kInputWindow: return vec4(p.window.x, p.window.y, 0.0f, 1.0f);
    case kInputReflection: return node_vector(2.0f * dot(p.incoming, p.normal) * p.normal - p.incoming);
    case kInputNormal: return node_vector(p.normal);
    case kInputObjectNormal: return node_vector(p.normal_os);
    case kInputTrueNormal: return node_vector(p.true_normal);
    case kInputTangent:
      return node_vector(node_normalize(
          node_transform(NODE_HOST node_xyz(p.tangent_os), 0u, 1u, 0u), vec3(0.0f)));
    case kInputIncoming: return node_vector(p.incoming);
    case kInputParametric: return vec4(p.parametric.x, p.parametric.y, 0.0f, 1.0f);
    case kInputBackfacing: return node_scalar(p.backfacing ? 1.0f : 0.0f);
    case kInputObjectLocation: return node_vector(p.object_location);
    case kInputObjectIndex: return node_scalar(p.object_index);
    case kInputObjectRandom: return node_scalar(p.object_random);
    case kInputMaterialIndex: return node_scalar(p.material_index);
    case kInputIsCamera: return node_scalar(p.ray == kCameraRay ? 1.0f : 0.0f);
    case kInputIsShadow: return node_scalar(p.ray == kShadowRay ? 1.0f : 0.0f);
    case kInputIsReflection: return node_scalar(p.ray == kReflectionRay ? 1.0f : 0.0f);
    case kInputIsTransmission: return node_scalar(p.ray == kRefractionRay ? 1.0f : 0.0f);
    case kInputRayLength: return node_scalar(p.ray_length);
    case kInputRayDepth: return node_scalar(float(p.ray_depth));
    case kInputViewVector: return node_vector(node_normalize(p.position_camera, vec3(0.0f)));
    case kInputViewDepth: return node_scalar(abs(p.position_camera.z));
    case kInputViewDistance: return node_scalar(length(p.position_camera));
    default: return vec4(0.0f);
  }
}

// `projection`: the mode of kNodeImage.
NODE_FUNCTION vec4 node_image(NODE_HOST_PARAMETER uint projection, int texture_index, vec3 v,
                              float blend, NodePoint p) {
  vec2 uv = vec2(v.x, v.y);
  if (projection == 1u) {
    vec3 weights = node_box_weights(p.normal_os, blend);
    vec4 sum = vec4(0.0f);
    if (weights.x > 0.0f) {
      sum += weights.x * node_texture(NODE_HOST texture_index, node_box_side(0u, v, p.normal_os));
    }
    if (weights.y > 0.0f) {
      sum += weights.y * node_texture(NODE_HOST texture_index, node_box_side(1u, v, p.normal_os));
    }
    if (weights.z > 0.0f) {
      sum += weights.z * node_texture(NODE_HOST texture_index, node_box_side(2u, v, p.normal_os));
    }
    return sum;
  }
  if (projection == 2u) uv = node_sphere(v);
  if (projection == 3u) uv = node_tube(v);
  if (projection == 4u) uv = node_equirectangular(node_normalize(v, vec3(0.0f)));
  if (projection == 5u) uv = node_mirror_ball(node_normalize(v, vec3(0.0f)));
  return node_texture(NODE_HOST texture_index, uv);
}

// The entry of a table at 0 ... 1, or between two; `first` is its first constant.
NODE_FUNCTION vec4 node_table(NODE_HOST_PARAMETER bool stepped, int first, float x) {
  float place = clamp(x, 0.0f, 1.0f) * float(kNodeTableSize - 1);
  int entry = min(int(place), kNodeTableSize - 2);
  if (stepped) return node_constant(NODE_HOST first + int(place));
  return mix(node_constant(NODE_HOST first + entry), node_constant(NODE_HOST first + entry + 1),
             place - float(entry));
}

// Each component of `v` through the table of that component; the constant before the table says which
// range it covers, and whether the curves go on straight beyond (z).
NODE_FUNCTION vec4 node_curves(NODE_HOST_PARAMETER int first, vec3 v) {
  vec4 range = node_constant(NODE_HOST first);
  float scale = node_divide(1.0f, range.y - range.x);
  vec3 place = (v - vec3(range.x)) * scale;
  vec4 x = node_table(NODE_HOST false, first + 1, place.x);
  vec4 y = node_table(NODE_HOST false, first + 1, place.y);
  vec4 z = node_table(NODE_HOST false, first + 1, place.z);
  vec3 result = vec3(x.x, y.y, z.z);
  if (range.z == 0.0f) return node_vector(result);
  int last = first + kNodeTableSize;
  float steps = float(kNodeTableSize - 1);
  vec4 begin = (node_constant(NODE_HOST first + 2) - node_constant(NODE_HOST first + 1)) * steps;
  vec4 end = (node_constant(NODE_HOST last) - node_constant(NODE_HOST last - 1)) * steps;
  vec3 below = min(place, vec3(0.0f)), above = max(place - vec3(1.0f), vec3(0.0f));
  return node_vector(result + below * node_xyz(begin) + above * node_xyz(end));
}

// `space`: the mode of kNodeNormalMap.
NODE_FUNCTION vec3 node_normal_map(NODE_HOST_PARAMETER uint space, vec3 color, float strength,
                                   NodePoint p) {
  vec3 painted = color * 2.0f - vec3(1.0f);
  float side = p.backfacing ? -1.0f : 1.0f;
  if (space == 0u) {
    if (p.tangent_os.w == 0.0f) return p.normal;
    vec3 own = p.mesh_normal_os;
    vec3 tangent = node_xyz(p.tangent_os);
    vec3 bitangent = cross(own, tangent) * p.tangent_os.w;
    float height = mix(1.0f, painted.z, clamp(strength, 0.0f, 1.0f));
    vec3 bent =
        painted.x * strength * tangent + painted.y * strength * bitangent + height * own;
    return side * node_normalize(node_transform(NODE_HOST bent, 2u, 1u, 0u), side * p.normal);
  }
  if (space >= 3u) painted = vec3(painted.x, -painted.y, -painted.z);  // as old Blenders baked them
  vec3 n = painted;
  if (space == 1u || space == 3u) n = node_transform(NODE_HOST painted, 2u, 1u, 0u);
  n = side * node_normalize(n, side * p.normal);
  return node_normalize(p.normal + (n - p.normal) * max(strength, 0.0f), p.normal);
}

// What an instruction makes of its operands `v`.
NODE_FUNCTION vec4 node_execute(NODE_HOST_PARAMETER uint op, uint all_modes, int data,
                                vec4 v[kNodeInputs], NodePoint p) {
  uint mode = all_modes;
  switch (op) {
    case kNodeInput: return node_input(NODE_HOST mode, data, p);
    case kNodeAttribute: return node_attribute(NODE_HOST data, int(mode));
    case kNodeImage: return node_image(NODE_HOST mode, data, node_xyz(v[0]), v[1].x, p);
    case kNodeComponent:
      return node_scalar(mode == 0u   ? v[0].x
                         : mode == 1u ? v[0].y
                         : mode == 2u ? v[0].z
                                      : v[0].w);
    case kNodeScalar:
      return node_scalar(mode == 0u ? 0.2126f * v[0].x + 0.7152f * v[0].y + 0.0722f * v[0].z
                                    : (v[0].x + v[0].y + v[0].z) * (1.0f / 3.0f));
    case kNodeCombine: return vec4(v[0].x, v[1].x, v[2].x, 1.0f);
    case kNodeColorSpace: return node_vector(node_color_space(mode, node_xyz(v[0])));
    case kNodeMath: {
      uint operation = node_digit(mode, 41u);
      float value = node_math(operation, v[0].x, v[1].x, v[2].x);
      return node_scalar(mode == 0u ? value : clamp(value, 0.0f, 1.0f));
    }
    case kNodeVectorMath:
      return node_vector_math(mode, node_xyz(v[0]), node_xyz(v[1]), node_xyz(v[2]), v[3].x);
    case kNodeMix: {
      vec4 factor = mode == 0u ? v[0] : clamp(v[0], vec4(0.0f), vec4(1.0f));
      return (vec4(1.0f) - factor) * v[1] + factor * v[2];
    }
    case kNodeMixColor: {
      uint blend = node_digit(mode, kNodeBlendTypes);
      float factor = node_digit(mode, 2u) == 0u ? v[0].x : clamp(v[0].x, 0.0f, 1.0f);
      vec3 mixed = node_blend(blend, factor, node_xyz(v[1]), node_xyz(v[2]));
      return node_vector(mode == 0u ? mixed : clamp(mixed, vec3(0.0f), vec3(1.0f)));
    }
    case kNodeTable:
      if (mode == 2u) return node_curves(NODE_HOST data, node_xyz(v[0]));
      return node_table(NODE_HOST mode == 1u, data, v[0].x);
    case kNodeHueSaturation:
      return node_vector(node_hue_saturation(node_xyz(v[0]), v[1].x, v[2].x, v[3].x));
    case kNodeBrightContrast:
      return node_vector(node_bright_contrast(node_xyz(v[0]), v[1].x, v[2].x));
    case kNodeGamma: return node_vector(node_gamma(node_xyz(v[0]), v[1].x));
    case kNodeBlackbody: return node_vector(node_blackbody(v[0].x));
    case kNodeWavelength: return node_vector(node_wavelength(v[0].x));
    case kNodeMapping:
      return node_vector(node_mapping(mode, node_xyz(v[0]), node_xyz(v[1]), node_xyz(v[2]),
                                      node_xyz(v[3])));
    case kNodeVectorRotate: {
      uint type = node_digit(mode, 5u);
      return node_vector(node_vector_rotate(type, mode != 0u, node_xyz(v[0]), node_xyz(v[1]),
                                            node_xyz(v[2]), v[3].x, node_xyz(v[4])));
    }
    case kNodeVectorTransform: {
      uint type = node_digit(mode, 3u);
      uint from = node_digit(mode, 3u);
      return node_vector(node_transform(NODE_HOST node_xyz(v[0]), type, from, mode));
    }
    case kNodeNormalMap:
      return node_vector(node_normal_map(NODE_HOST mode, node_xyz(v[0]), v[1].x, p));
    case kNodeBump:
      return node_vector(node_bump(node_xyz(v[3]), p.step_x, p.step_y, v[0].x, v[1].x, v[2].x,
                                   v[4].x, mode == 0u ? v[5].x : -v[5].x));
    case kNodeFresnel: {
      float ior = max(v[0].x, 1e-5f);
      return node_scalar(
          node_fresnel(dot(p.incoming, node_xyz(v[1])), p.backfacing ? 1.0f / ior : ior));
    }
    case kNodeLayerWeight: {
      float cosine = dot(p.incoming, node_xyz(v[1]));
      if (mode != 0u) return node_scalar(node_facing(cosine, v[0].x));
      float eta = max(1.0f - v[0].x, 1e-5f);
      return node_scalar(node_fresnel(cosine, p.backfacing ? eta : 1.0f / eta));
    }
    case kNodeChecker: {
      float first = node_checker(node_xyz(v[0]), v[3].x);
      return mode != 0u ? node_scalar(first) : (first != 0.0f ? v[1] : v[2]);
    }
    case kNodeGradient: return node_scalar(node_gradient(mode, node_xyz(v[0])));
    case kNodeMagic: {
      int depth = int(node_digit(mode, 11u));
      return node_vector(
          node_magic(depth, node_xyz(v[0]), v[1].x, v[2].x, node_blender(mode)));
    }
    case kNodeWave: {
      uint type = node_digit(mode, 2u), direction = node_digit(mode, 4u);
      uint profile = node_digit(mode, 3u);
      return node_scalar(node_wave(type, direction, profile, node_xyz(v[0]), v[1].x, v[2].x,
                                   v[3].x, v[4].x, v[5].x, v[6].x, node_blender(mode)));
    }
    case kNodeBrick: {
      vec4 rows = node_constant(NODE_HOST data);
      vec2 brick = node_brick(node_xyz(v[0]), v[1].x, v[2].x, v[3].x, v[4].x, v[5].x, v[6].x,
                              rows.x, int(rows.y), rows.z, int(rows.w));
      return vec4(brick.x, brick.y, 0.0f, 1.0f);
    }
    case kNodeWhiteNoise: {
      int dimensions = 1 + int(node_digit(mode, 4u));
      vec3 noise = node_white_noise(dimensions,
                                    texture_point(dimensions, node_xyz(v[0]), v[1].x, 1.0f));
      return mode == 0u ? node_scalar(noise.x) : node_vector(noise);
    }
    case kNodeNoise: {
      int dimensions = 1 + int(node_digit(mode, 4u));
      NoiseInputs inputs;
      inputs.type = node_digit(mode, 5u);
      inputs.normalize = node_digit(mode, 2u) != 0u;
      bool colored = node_digit(mode, 2u) != 0u;
      inputs.detail = v[3].x;
      inputs.roughness = v[4].x;
      inputs.lacunarity = v[5].x;
      inputs.distortion = v[6].x;
      inputs.offset = v[7].x;
      inputs.gain = v[7].y;
      vec3 noise = node_noise(dimensions,
                              texture_point(dimensions, node_xyz(v[0]), v[1].x, v[2].x), inputs,
                              colored ? 3 : 1, node_blender(mode));
      return colored ? node_vector(noise) : node_scalar(noise.x);
    }
    case kNodeMusgrave: {
      int dimensions = 1 + int(node_digit(mode, 4u));
      return node_scalar(node_musgrave(dimensions,
                                       texture_point(dimensions, node_xyz(v[0]), v[1].x, v[2].x),
                                       mode, v[3].x, v[4].x, v[5].x, v[6].x, v[7].x));
    }
    case kNodeVoronoi: {
      int dimensions = 1 + int(node_digit(mode, 4u));
      VoronoiInputs inputs;
      inputs.metric = node_digit(mode, 4u);
      inputs.feature = node_digit(mode, 5u);
      inputs.normalize = node_digit(mode, 2u) != 0u;
      uint wanted = node_digit(mode, 4u);
      inputs.scale = v[2].x;
      inputs.smoothness = v[3].x;
      inputs.exponent = v[4].x;
      inputs.randomness = v[5].x;
      inputs.detail = v[6].x;
      inputs.roughness = v[6].y;
      inputs.lacunarity = v[6].z;
      VoronoiFeature found = node_voronoi(
          dimensions, texture_point(dimensions, node_xyz(v[0]), v[1].x, v[2].x), inputs,
          node_blender(mode));
      if (wanted == 0u) return node_scalar(found.distance);
      if (wanted == 1u) return node_vector(found.color);
      if (wanted == 2u) {
        return vec4(found.position.x, found.position.y, found.position.z, 1.0f);
      }
      return node_scalar(found.position.w);
    }
    default: return vec4(0.0f);
  }
}
