// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/convert.h"

#include <algorithm>
#include <cstring>

#include "api/errors.h"
#include "images/image_plugin.h"

namespace kestrel::api {
namespace {

/// Keeps every index of a corner and of a buffer's byte within what Embree and OpenGL count.
constexpr size_t kMaxElements = size_t{1} << 29;
constexpr size_t kMaxMotionSteps = 129;
constexpr size_t kMaxSlots = size_t{kMaxMaterialSlot} + 1;

/// The length of the UTF-8 sequence at `s`, 0 where there is none (RFC 3629).
size_t utf8_length(const unsigned char* s) {
  const auto follows = [s](size_t i) { return (s[i] & 0xC0) == 0x80; };
  if (s[0] < 0x80) return 1;
  if (s[0] >= 0xC2 && s[0] < 0xE0) return follows(1) ? 2 : 0;
  if (s[0] >= 0xE0 && s[0] < 0xF0) {
    const bool overlong = s[0] == 0xE0 && s[1] < 0xA0;
    const bool surrogate = s[0] == 0xED && s[1] >= 0xA0;
    return follows(1) && !overlong && !surrogate && follows(2) ? 3 : 0;
  }
  if (s[0] >= 0xF0 && s[0] < 0xF5) {
    const bool overlong = s[0] == 0xF0 && s[1] < 0x90;
    const bool beyond = s[0] == 0xF4 && s[1] >= 0x90;
    return follows(1) && !overlong && !beyond && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

void check_count(size_t count, const std::string& name, const char* what) {
  if (count <= kMaxElements) return;
  fail(ErrorCode::invalid_argument, "Mesh '{}' has {} {}; at most {} are supported. Split it.",
       name, count, what, kMaxElements);
}

template <typename T>
std::span<const T> optional_array(const T* values, size_t count) {
  return values ? std::span<const T>(values, count) : std::span<const T>();
}

/// Maps 0, 1, … of a C enumeration.
template <typename E>
E enumerated(int32_t value, std::initializer_list<E> values, const char* name) {
  if (value < 0 || static_cast<size_t>(value) >= values.size()) {
    fail(ErrorCode::invalid_argument, "{} is no {}. Use a constant of kestrel.h, 0 to {}.", value,
         name, values.size() - 1);
  }
  return *(values.begin() + value);
}

vec3 vec3_from(const float v[3]) {
  return {v[0], v[1], v[2]};
}
vec4 vec4_from(const float v[4]) {
  return {v[0], v[1], v[2], v[3]};
}

/// Steps of a motion, checked.
size_t motion_steps(size_t count) {
  if (count < 2 || count > kMaxMotionSteps) {
    fail(ErrorCode::invalid_argument, "A motion of {} steps is not supported. Use 2 to {}.", count,
         kMaxMotionSteps);
  }
  return count;
}

AttributeInput attribute_from(const KestrelMeshAttribute& attribute, size_t corners,
                              const std::string& mesh) {
  if (attribute.channels != 2 && attribute.channels != 3) {
    fail(ErrorCode::invalid_argument,
         "Mesh '{}': an attribute has {} channels. Use 2 for a UV map, 3 for colours.", mesh,
         attribute.channels);
  }
  if (attribute.id == 0) {
    fail(ErrorCode::invalid_argument, "Mesh '{}': 0 is no id of an attribute. Use another number.",
         mesh);
  }
  const auto channels = static_cast<size_t>(attribute.channels);
  return {attribute.id, attribute.channels,
          array(attribute.values, channels * corners, "attributes[].values")};
}

}  // namespace

std::string text_from(const char* text) {
  std::string out;
  if (!text) return out;
  const auto* s = reinterpret_cast<const unsigned char*>(text);
  while (*s) {
    const size_t length = utf8_length(s);
    if (length) {
      out.append(reinterpret_cast<const char*>(s), length);
    } else {
      out.push_back('?');
    }
    s += std::max<size_t>(length, 1);
  }
  return out;
}

MeshInput mesh_from(const KestrelMesh& mesh) {
  MeshInput out;
  out.name = text_from(mesh.name);
  check_count(mesh.vertex_count, out.name, "vertices");
  check_count(mesh.triangle_count, out.name, "triangles");
  const size_t corners = 3 * mesh.triangle_count;
  out.positions = array(mesh.positions, 3 * mesh.vertex_count, "positions");
  out.triangles = array(mesh.triangles, corners, "triangles");
  out.corner_normals = optional_array(mesh.corner_normals, 3 * corners);
  out.corner_uvs = optional_array(mesh.corner_uvs, 2 * corners);
  out.corner_tangents = optional_array(mesh.corner_tangents, 4 * corners);
  out.triangle_materials = optional_array(mesh.triangle_materials, mesh.triangle_count);
  if (mesh.motion_count > 0) {
    out.motion_count = motion_steps(mesh.motion_count);
    out.motion_positions =
        array(mesh.motion_positions, 3 * mesh.vertex_count * out.motion_count, "motion_positions");
    out.motion_corner_normals =
        optional_array(mesh.motion_corner_normals, 3 * corners * out.motion_count);
  }
  out.uv_map = mesh.uv_map;
  for (const KestrelMeshAttribute& attribute :
       array(mesh.attributes, mesh.attribute_count, "attributes")) {
    out.attributes.push_back(attribute_from(attribute, corners, out.name));
  }
  return out;
}

TextureOptions options_from(const KestrelTextureOptions* options) {
  require(options, "options");
  return {text_from(options->name), options->srgb, options->nearest,
          enumerated(options->extension, {Extension::repeat, Extension::clamp, Extension::clip},
                     "KestrelExtension")};
}

size_t texel_values(int width, int height) {
  constexpr int kMax = KESTREL_IMAGE_MAX_SIDE;
  if (width < 1 || height < 1 || width > kMax || height > kMax) {
    fail(ErrorCode::invalid_argument,
         "A texture of {} x {} pixels is not supported. Use 1 to {} on each side.", width, height,
         kMax);
  }
  return 4 * static_cast<size_t>(width) * static_cast<size_t>(height);
}

static_assert(sizeof(KestrelNodeInstruction) == sizeof(nodes::NodeInstruction) &&
              KESTREL_NODE_OUTPUTS == nodes::kNodeOutputs && KESTREL_NODE_UNSET == kNodeUnset);

std::shared_ptr<NodeProgram> program_from(const KestrelNodeProgram& program,
                                          const std::string& material) {
  check_count(program.constant_count, material, "constants");
  auto out = std::make_shared<NodeProgram>();
  const auto steps = array(program.instructions, program.instruction_count, "instructions");
  out->instructions.resize(steps.size());
  if (!steps.empty()) std::memcpy(out->instructions.data(), steps.data(), steps.size_bytes());
  const auto constants = array(program.constants, 4 * program.constant_count, "constants");
  for (size_t i = 0; i < constants.size(); i += 4) {
    out->constants.push_back(vec4_from(&constants[i]));
  }
  const auto textures = array(program.textures, program.texture_count, "textures");
  out->texture_ids.assign(textures.begin(), textures.end());
  const auto attributes = array(program.attributes, program.attribute_count, "attributes");
  out->attributes.assign(attributes.begin(), attributes.end());
  std::copy(std::begin(program.outputs), std::end(program.outputs), out->outputs.begin());
  return out;
}

MaterialInput material_from(const KestrelMaterial& material) {
  MaterialInput out;
  Material& m = out.values;
  m.name = text_from(material.name);
  m.emission = vec3_from(material.emission);
  m.ambient = vec3_from(material.ambient);
  m.diffuse = vec4_from(material.diffuse);
  m.specular = vec4_from(material.specular);
  m.optical = vec3_from(material.optical);
  m.reflection_color = vec3_from(material.reflection_color);
  m.transmission_color = vec3_from(material.transmission_color);
  m.normal_strength = material.normal_strength;
  m.tiling = {material.tiling[0], material.tiling[1]};
  m.offset = {material.offset[0], material.offset[1]};
  m.casts_shadow = material.casts_shadow;
  m.alpha_mode =
      enumerated(material.alpha_mode, {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend},
                 "KestrelAlphaMode");
  m.alpha_cutoff = material.alpha_cutoff;
  m.pass_index = material.pass_index;
  out.emission_texture = material.emission_texture;
  out.ambient_texture = material.ambient_texture;
  out.diffuse_texture = material.diffuse_texture;
  out.specular_texture = material.specular_texture;
  out.normal_texture = material.normal_texture;
  out.optical_texture = material.optical_texture;
  std::copy(std::begin(material.uv_maps), std::end(material.uv_maps), m.uv_maps);
  m.tangent_map = material.tangent_map;
  m.emission_colors = material.emission_attribute;
  m.ambient_colors = material.ambient_attribute;
  m.diffuse_colors = material.diffuse_attribute;
  if (material.program) out.program = program_from(*material.program, m.name);
  return out;
}

LightInput light_from(const KestrelLight& light) {
  LightInput out;
  Light& l = out.values;
  l.name = text_from(light.name);
  l.type = enumerated(light.type, {LightType::directional, LightType::point, LightType::spot},
                      "KestrelLightType");
  l.color = vec3_from(light.color);
  l.position = vec3_from(light.position);
  l.direction = vec3_from(light.direction);
  l.attenuation = vec3_from(light.attenuation);
  l.blend = light.spot_blend;
  l.exponent = light.spot_exponent;
  l.specular_factor = light.specular_factor;
  l.casts_shadow = light.casts_shadow;
  out.spot_angle = light.spot_angle;
  return out;
}

ObjectInput object_from(const KestrelObject& object) {
  ObjectInput out;
  out.name = text_from(object.name);
  out.mesh = object.mesh;
  if (object.material_count > kMaxSlots) {
    fail(ErrorCode::invalid_argument,
         "Object '{}' has {} material slots; at most {} are supported.", out.name,
         object.material_count, kMaxSlots);
  }
  const auto materials = array(object.materials, object.material_count, "materials");
  out.materials.assign(materials.begin(), materials.end());
  out.world_from_object = matrix_from(object.world_from_object);
  out.unit = text_from(object.unit);
  if (object.hidden_from & ~uint32_t{kAllRays}) {
    fail(ErrorCode::invalid_argument,
         "Object '{}': {} of 'hidden_from' is no sum of KestrelRays. Use 0 to {}.", out.name,
         object.hidden_from, uint32_t{kAllRays});
  }
  out.hidden_from = static_cast<uint8_t>(object.hidden_from);
  out.holdout = object.holdout;
  out.pass_index = object.pass_index;
  out.asset = text_from(object.asset);
  return out;
}

mat4x3 matrix_from(const float values[12]) {
  mat4x3 m;
  for (int column = 0; column < 4; ++column) m[column] = vec3_from(values + 3 * column);
  return m;
}

Camera camera_from(const KestrelCamera& camera) {
  Camera out;
  out.projection = enumerated(
      camera.projection, {Projection::perspective, Projection::orthographic}, "KestrelProjection");
  out.world_from_camera = matrix_from(camera.world_from_camera);
  out.left = camera.left;
  out.right = camera.right;
  out.bottom = camera.bottom;
  out.top = camera.top;
  out.near_clip = camera.near_clip;
  out.far_clip = camera.far_clip;
  out.aperture_radius = glm::max(camera.aperture_radius, 0.0f);
  out.focus_distance = camera.focus_distance;
  out.aperture_blades = camera.aperture_blades;
  out.aperture_rotation = camera.aperture_rotation;
  out.aperture_ratio = camera.aperture_ratio == 0.0f ? 1.0f : camera.aperture_ratio;
  return out;
}

std::vector<mat4x3> matrices_from(const float* values, size_t count) {
  std::vector<mat4x3> out;
  if (count == 0) return out;
  require(values, "world_from_object");
  motion_steps(count);
  for (size_t i = 0; i < count; ++i) out.push_back(matrix_from(values + 12 * i));
  return out;
}

std::vector<Camera> cameras_from(const KestrelCamera* states, size_t count) {
  require(states, "states");
  motion_steps(count);
  std::vector<Camera> out;
  for (size_t i = 0; i < count; ++i) out.push_back(camera_from(states[i]));
  return out;
}

WorldInput world_from(const KestrelWorld& world) {
  WorldInput out;
  out.values.kind =
      enumerated(world.kind, {WorldKind::color, WorldKind::equirectangular, WorldKind::cube},
                 "KestrelWorldKind");
  out.values.color = vec3_from(world.color);
  std::copy(std::begin(world.textures), std::end(world.textures), out.textures);
  for (int column = 0; column < 3; ++column) {
    out.values.map_from_world[column] = vec3_from(world.map_from_world + 3 * column);
  }
  const float falloff = world.mist_falloff == 0.0f ? 1.0f : world.mist_falloff;
  out.values.mist = {world.mist_start, world.mist_depth, falloff};
  return out;
}

ItemKind kind_from(KestrelKind kind) {
  int32_t value;  // copied as bytes: a host may pass what the enumeration does not hold
  static_assert(sizeof(kind) == sizeof(value));
  std::memcpy(&value, &kind, sizeof(value));
  return enumerated(
      value,
      {ItemKind::mesh, ItemKind::texture, ItemKind::material, ItemKind::light, ItemKind::object},
      "KestrelKind");
}

}  // namespace kestrel::api
