// SPDX-License-Identifier: GPL-3.0-or-later
// The scene as every stage reads it: validated, immutable, references resolved to indices.
// Space: world is right-handed, Z up, metres. Colours are linear Rec. 709, scene-referred.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/math.h"
#include "params/params.h"
#include "scene/pose.h"

namespace kestrel {

inline constexpr int kNone = -1;

/// A mesh at a moment: what of it may change.
struct MeshShape {
  std::vector<vec3> positions;
  std::vector<vec3> corner_normals;  // empty: flat faces
};

/// A mesh's shapes at even steps of time, two or more.
using MeshMotion = std::vector<MeshShape>;

/// A further UV map of a mesh; arrays as the mesh's own.
struct UvMap {
  uint64_t id = 0;
  std::vector<vec2> corner_uvs;
  std::vector<vec4> corner_tangents;  // empty: none
};

/// Colours of a mesh that multiply those of materials that ask for them.
struct ColorAttribute {
  uint64_t id = 0;
  std::vector<vec3> corner_colors;  // linear
};

/// Triangles in object space. Arrays of corners hold three entries per triangle, in its order.
struct Mesh {
  std::string name;
  std::vector<vec3> positions;               // per vertex; 4 bytes past the last are readable
  std::vector<uvec3> triangles;              // vertex indices
  std::vector<vec3> corner_normals;          // unit; empty: flat faces
  std::vector<vec2> corner_uvs;              // empty: (0, 0)
  std::vector<vec4> corner_tangents;         // xyz unit, w = sign of the bitangent; empty: none
  bool tangents_given = false;               // by the host, not made from the UVs
  std::vector<uint32_t> triangle_materials;  // slot of the object; empty: slot 0
  uint64_t uv_map = 0;                       // id of corner_uvs, where they have one
  std::vector<UvMap> more_uv_maps;
  std::vector<ColorAttribute> color_attributes;
  Bounds bounds;                             // object space
  std::shared_ptr<const MeshMotion> motion;  // null: keeps its shape

  /// The UVs that an id means, 0 being the mesh's own; empty, which reads as (0, 0), where the mesh
  /// has no map of this id.
  const std::vector<vec2>& uvs_of(uint64_t id) const {
    if (id == 0 || id == uv_map) return corner_uvs;
    const UvMap* map = find(more_uv_maps, id);
    return map ? map->corner_uvs : kNoUvs;
  }
  /// The tangents along that map; empty: none.
  const std::vector<vec4>& tangents_of(uint64_t id) const {
    if (id == 0 || id == uv_map) return corner_tangents;
    const UvMap* map = find(more_uv_maps, id);
    return map ? map->corner_tangents : kNoTangents;
  }
  /// Null, which reads as black, where the mesh has no such attribute.
  const ColorAttribute* colors_of(uint64_t id) const { return find(color_attributes, id); }

 private:
  static inline const std::vector<vec2> kNoUvs;
  static inline const std::vector<vec4> kNoTangents;

  template <typename Attribute>
  static const Attribute* find(const std::vector<Attribute>& attributes, uint64_t id) {
    for (const Attribute& attribute : attributes) {
      if (attribute.id == id) return &attribute;
    }
    return nullptr;
  }
};

enum class Extension : uint8_t { repeat, clamp, clip };

/// Texels, row 0 at the bottom (v = 0). Either 8-bit RGBA or float RGBA, never both.
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  bool srgb = false;     // 8-bit RGB is sRGB-encoded and decoded before filtering; alpha is linear
  bool nearest = false;  // no interpolation
  Extension extension = Extension::repeat;
  int channels8 = 4;                // 3 where every texel is opaque, so that it needs less memory
  std::vector<uint8_t> texels8;     // RGB or RGBA, straight alpha
  std::vector<float> texels_float;  // RGBA, linear
  std::string path;  // of the file that it was read from; empty: texels were given, or decoded from
                     // bytes, or stand in for a file that could not be read
};

enum class AlphaMode : uint8_t {
  opaque,  // diffuse alpha is ignored
  mask,    // below the cutoff there is no surface
  blend,   // alpha is coverage: what it leaves shines straight through
};

/// A material's textures, in the order of all arrays over them.
enum TextureSlot : uint8_t {
  kEmissionTexture,
  kAmbientTexture,
  kDiffuseTexture,
  kSpecularTexture,
  kNormalTexture,
  kOpticalTexture,
  kTextureSlots
};

/// The paper's Table 1: each property is a colour times a texture (texture index or kNone).
struct Material {
  std::string name;
  vec3 emission{0.0f};
  vec3 ambient{0.0f};
  vec4 diffuse{0.8f, 0.8f, 0.8f, 1.0f};   // A: alpha (coverage)
  vec4 specular{0.0f, 0.0f, 0.0f, 0.0f};  // A: 0 = exponent 1, 1 = exponent 255, linear between
  vec3 optical{0.0f, 1.0f, 1.0f};         // R reflectivity, G index of refraction, B opacity
  vec3 reflection_color{1.0f};            // tints what is reflected
  vec3 transmission_color{1.0f};          // tints what shines through
  int emission_texture = kNone;
  int ambient_texture = kNone;
  int diffuse_texture = kNone;
  int specular_texture = kNone;
  int normal_texture = kNone;  // tangent space, +Y up (OpenGL convention)
  int optical_texture = kNone;
  float normal_strength = 1.0f;
  vec2 tiling{1.0f};  // uv' = offset + uv * tiling (listing 2)
  vec2 offset{0.0f};
  bool casts_shadow = true;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  int pass_index = 0;                    // for compositing
  uint64_t uv_maps[kTextureSlots] = {};  // of the mesh, by texture; 0: its own
  bool several_uv_maps = false;          // else all of uv_maps are the same
  uint64_t tangent_map = 0;              // UV map along which the normal map lies
  uint64_t emission_colors = 0;          // colour attributes of the mesh that multiply; 0: none
  uint64_t ambient_colors = 0;
  uint64_t diffuse_colors = 0;

  bool has_colors() const { return (emission_colors | ambient_colors | diffuse_colors) != 0; }
  /// Whether one UV map is not all that it takes from the mesh.
  bool reads_attributes() const { return several_uv_maps || has_colors(); }
  int texture(int slot) const {
    const int textures[kTextureSlots] = {emission_texture, ambient_texture, diffuse_texture,
                                         specular_texture, normal_texture,  optical_texture};
    return textures[slot];
  }
  bool reflective() const { return optical.x > 0.0f; }
  bool refractive() const { return optical.z < 1.0f || alpha_mode == AlphaMode::blend; }
  /// Whether some shadow ray may get past it or must look at its texture.
  bool needs_any_hit() const {
    return !casts_shadow || alpha_mode != AlphaMode::opaque || optical.z < 1.0f ||
           optical_texture != kNone;
  }
};

enum class LightType : uint8_t { directional, point, spot };

struct Light {
  uint64_t id = 0;  // the host's
  std::string name;
  LightType type = LightType::point;
  vec3 color{1.0f};  // radiance that a white Lambert surface facing the light reflects, at 1 m
                     // for point and spot, anywhere for directional
  vec3 position{0.0f};
  vec3 direction{0.0f, 0.0f, -1.0f};   // unit, the way the light travels
  vec3 attenuation{0.0f, 0.0f, 1.0f};  // 1 / (x + y d + z d²), d in metres
  float spot_angle = 0.0f;             // spot: full angle of the cone, radians
  float cos_outer = 0.0f;              // spot: cosine of half of it
  float blend = 0.0f;                  // spot: 0 hard edge … 1 soft all the way
  float exponent = 0.0f;               // spot: power of the cosine to the axis
  float specular_factor = 1.0f;
  bool casts_shadow = true;
};

/// Kinds of rays. Those that go on straight through a surface stay what they were.
enum RayBits : uint8_t {
  kCameraRays = 1,
  kShadowRays = 2,
  kReflectionRays = 4,
  kRefractionRays = 8,
  kAllRays = 15
};

/// A mesh placed in the world.
struct Object {
  uint64_t id = 0;  // the host's
  std::string name;
  int mesh = kNone;
  int unit = kNone;
  std::vector<int> materials;  // by slot; holds every slot that the mesh uses
  mat4x3 world_from_object{1.0f};
  bool flips_orientation = false;              // negative determinant
  uint8_t hidden_from = 0;                     // RayBits that do not meet it
  bool holdout = false;                        // for camera rays a hole in the picture
  std::shared_ptr<const ObjectMotion> motion;  // null: stands still
  std::shared_ptr<const std::vector<mat4x3>> motion_matrices;  // what `motion` was made from
  int pass_index = 0;                                          // for compositing
  std::string asset;  // what it is a part of; its own name where it is none
};

/// What the heuristic selects: an object, or all instances of one instancer.
struct Unit {
  std::string name;
  ObjectSettings settings;
  Bounds bounds;  // world space
  bool reflective = false;
  bool refractive = false;
};

enum class Projection : uint8_t { perspective, orthographic };

/// Looks along its -Z with +Y up. The window is what the picture shows of the plane z = -1
/// (perspective, no unit) or of any plane (orthographic, metres).
struct Camera {
  Projection projection = Projection::perspective;
  mat4x3 world_from_camera{1.0f};  // rigid
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;
  float near_clip = 0.1f;  // metres
  float far_clip = 1000.0f;
  float focus_distance = 1.0f;     // metres along the view to the plane in focus
  float aperture_radius = 0.0f;    // metres; 0: everything is in focus
  int aperture_blades = 0;         // corners of the aperture; below 3: round
  float aperture_rotation = 0.0f;  // radians, anticlockwise
  float aperture_ratio = 1.0f;     // height over width
};

enum class WorldKind : uint8_t { color, equirectangular, cube };

/// How the Mist pass rises from 0 to 1 with the distance from the camera.
struct Mist {
  float start = 0.0f;    // metres
  float depth = 0.0f;    // metres from the start to 1; 0 or less: no surface has any
  float falloff = 1.0f;  // exponent: 1 linear, 2 quadratic, 0.5 inverse quadratic
};

/// What lies behind everything. Directions are turned by `map_from_world` before the lookup.
/// The formulas are in world.h.
struct World {
  WorldKind kind = WorldKind::color;
  vec3 color{0.0f};  // radiance, or factor on the textures
  int textures[6] = {kNone, kNone, kNone, kNone, kNone, kNone};  // cube: +X -X +Y -Y +Z -Z
  mat3 map_from_world{1.0f};
  Mist mist;
};

struct Scene {
  std::vector<std::shared_ptr<const Mesh>> meshes;  // shared with other snapshots when unchanged
  std::vector<std::shared_ptr<const Texture>> textures;
  std::vector<Material> materials;  // [0] is the default grey
  std::vector<Light> lights;
  std::vector<Object> objects;
  std::vector<Unit> units;
  Camera camera;
  std::vector<Camera> camera_motion;  // at even steps of time, two or more; empty: stands still
  World world;
  Settings settings;
  bool has_holdouts = false;  // whether some object is one

  /// Whether Combined's alpha may be below 1.
  bool has_alpha() const { return settings.film_transparent || has_holdouts; }
};

}  // namespace kestrel
