// SPDX-License-Identifier: GPL-3.0-or-later
// Structs that C++ (core/gl/shared_structs.h) and GLSL share, word for word. Every vec3 is followed
// by one scalar, so that std140, std430 and C++ lay them out alike. World space, metres, linear
// Rec. 709, as in core/scene/scene.h.

// One frame's view and surroundings (uniform block).
struct GpuFrame {
  mat4 clip_from_world;    // reversed z: 1 at the near plane, 0 at the far one
  mat4 world_from_camera;  // rigid
  mat4 map_from_world;     // rotation of directions before the world's lookup, in the upper 3x3
  vec4 window;             // left, right, bottom, top: Camera's
  vec2 picture_size;       // pixels
  vec2 subpixel;           // offset of the sample from the pixel's centre, pixels
  vec3 ambient;            // global ambient light
  float environment_ior;
  vec3 world_color;        // radiance, or factor on the world's textures
  uint world_kind;         // WorldKind
  uint orthographic;       // 1: orthographic, 0: perspective
  uint light_count;
  uint unused_0;
  uint unused_1;
};

// One object (uniform block, one range each).
struct GpuObject {
  mat4 world_from_object;
  mat4 normal_from_object;  // inverse transpose up to a positive factor, in the upper 3x3
  uint id;                  // scene object index + 1
  float bitangent_sign;     // -1 where the transform mirrors, else 1
  uint unused_0;
  uint unused_1;
};

// One material (storage buffer); its textures are bound beside it.
struct GpuMaterial {
  vec3 emission;
  float normal_strength;
  vec3 ambient;
  float alpha_cutoff;
  vec4 diffuse;
  vec4 specular;
  vec3 optical;
  uint alpha_mode;  // AlphaMode
  vec2 tiling;
  vec2 offset;
  uint textures;  // bit i: a texture is bound to unit i (shaders/raster/material.glsl)
  uint unused_0;
  uint unused_1;
  uint unused_2;
};

// One light (storage buffer).
struct GpuLight {
  vec3 color;
  float cos_outer;
  vec3 position;
  float blend;
  vec3 direction;  // unit, the way the light travels
  float specular_factor;
  vec3 attenuation;
  uint type;  // LightType
  float exponent;  // spot: power of the cosine to the axis
  float unused_0;
  float unused_1;
  float unused_2;
};
