// SPDX-License-Identifier: GPL-3.0-or-later
// Camera, world and lights.
#include <climits>
#include <cmath>

#include "cli/camera.h"
#include "cli/parse.h"
#include "cli/scene_data.h"
#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

/// Directions of a Z-up world in a map whose +Y is up.
const mat3 kYUpFromZUp(1, 0, 0, 0, 0, -1, 0, 1, 0);

// ---- camera ------------------------------------------------------------------------------------

void parse_field_of_view(const JsonNode& node, CameraDescription& camera) {
  static const char* kKeys[] = {"fov", "fov_x", "fov_y"};
  static constexpr CameraFit kFits[] = {CameraFit::larger, CameraFit::horizontal,
                                        CameraFit::vertical};
  int found = 0;
  for (int i = 0; i < 3; ++i) {
    const auto fov = node.find(kKeys[i]);
    if (!fov) continue;
    camera.fit = kFits[i];
    camera.extent = 2.0f * std::tan(0.5f * fov->radians(0.01, 179.0));
    ++found;
  }
  if (found != 1) {
    node.fail("expected one of 'fov' (larger side of the picture), 'fov_x' and 'fov_y', degrees");
  }
}

/// What any picture shows, whatever its size.
vec4 parse_window(const JsonNode& node, const JsonNode& window) {
  for (const char* other : {"fov", "fov_x", "fov_y", "scale", "shift_x", "shift_y"}) {
    if (node.has(other)) node.fail("has both 'window' and '{}'; use one of them", other);
  }
  const std::vector<float> v = window.numbers(4, 4, -kMaximumSceneNumber, kMaximumSceneNumber);
  return {v[0], v[1], v[2], v[3]};
}

void parse_aperture(const JsonNode& node, CameraDescription& camera) {
  if (const auto v = node.find("aperture_radius")) {
    camera.aperture_radius = v->number(0, kMaximumLength);
    camera.focus_distance = node.require("focus_distance").number(1e-5, kMaximumLength);
  }
  if (const auto v = node.find("aperture_blades")) {
    camera.aperture_blades = v->integer(INT_MIN, INT_MAX);
  }
  if (const auto v = node.find("aperture_rotation")) {
    camera.aperture_rotation = v->radians(-kMaximumLength, kMaximumLength);
  }
  if (const auto v = node.find("aperture_ratio")) camera.aperture_ratio = v->number(0.01, 100.0);
}

mat4x3 parse_camera_matrix(const JsonNode& node, bool may_mirror) {
  const mat4x3 m = parse_matrix(node);
  const mat3 linear(m);
  const mat3 product = glm::transpose(linear) * linear;
  for (int i = 0; i < 9; ++i) {
    if (std::abs(product[i / 3][i % 3] - (i % 4 == 0 ? 1.0f : 0.0f)) > 1e-3f) {
      node.fail(
          "a camera's matrix must not scale or shear: its first three columns must be unit "
          "vectors at right angles");
    }
  }
  if (glm::determinant(linear) < 0.0f && !may_mirror) {
    node.fail("a camera's matrix must not mirror");
  }
  return m;
}

mat4x3 parse_camera_placement(const JsonNode& node, const vec3& up) {
  if (const auto matrix = node.find("matrix")) {
    for (const char* other : {"position", "rotation", "look_at"}) {
      if (node.has(other)) node.fail("has both 'matrix' and '{}'; use one of them", other);
    }
    return parse_camera_matrix(*matrix, node.has("window"));
  }
  const vec3 position = parse_vec3(node, "position", vec3(0.0f));
  if (const auto target = node.find("look_at")) {
    if (node.has("rotation")) node.fail("has both 'look_at' and 'rotation'; use one of them");
    const vec3 look_at = parse_vec3(node, "look_at", vec3(0.0f));
    if (glm::distance(look_at, position) < 1e-6f) {
      target->fail("must differ from the camera's position");
    }
    return world_from_camera_looking(position, look_at, up);
  }
  const mat3 r = rotation_from_degrees(parse_vec3(node, "rotation", vec3(0.0f), -1e6, 1e6));
  return mat4x3(r[0], r[1], r[2], position);
}

std::vector<CameraKey> parse_path(const JsonNode& node) {
  std::vector<CameraKey> path;
  for (const JsonNode& item : node.items(100'000)) {
    item.expect_keys({"time", "position", "look_at"});
    CameraKey key;
    key.time = item.require("time").number(-1e6, 1e6);
    item.require("position");
    key.position = parse_vec3(item, "position", vec3(0.0f));
    const JsonNode target = item.require("look_at");
    key.look_at = parse_vec3(item, "look_at", vec3(0.0f));
    if (glm::distance(key.look_at, key.position) < 1e-6f) {
      target.fail("must differ from the position");
    }
    if (!path.empty() && !(key.time > path.back().time)) {
      item.require("time").fail("expected a time after {} s, that of the key before",
                                path.back().time);
    }
    path.push_back(key);
  }
  if (path.size() < 2) node.fail("expected at least 2 keys");
  return path;
}

// ---- world -------------------------------------------------------------------------------------

void parse_mist(const JsonNode& node, WorldDescription& world) {
  node.expect_keys({"start", "depth", "falloff"});
  if (const auto n = node.find("start"))
    world.mist_start = n->number(-kMaximumLength, kMaximumLength);
  world.mist_depth = node.require("depth").number(-kMaximumLength, kMaximumLength);
  if (const auto n = node.find("falloff"))
    world.mist_falloff = n->number(-kMaximumLength, kMaximumLength);
}

int add_world_image(const JsonNode& file, KestrelExtension extension, SceneDescription& scene) {
  TextureDescription texture;
  texture.source = TextureFile{resolve_file(file)};
  texture.name = file.text();
  texture.extension = extension;
  scene.textures.push_back(std::move(texture));
  return static_cast<int>(scene.textures.size()) - 1;
}

void parse_cube(const JsonNode& node, const JsonNode& images, WorldDescription& world,
                SceneDescription& scene) {
  world.kind = KESTREL_WORLD_CUBE;
  const std::vector<JsonNode> faces = images.items(6);
  if (faces.size() != 6) images.fail("expected 6 images: +X -X +Y -Y +Z -Z");
  for (int i = 0; i < 6; ++i) {
    world.textures[i] = add_world_image(faces[i], KESTREL_EXTENSION_CLAMP, scene);
  }
  const auto flip = node.find("flip");
  if (flip && flip->boolean()) {
    // Six images turned upside down show the mirror image in Y, with the two Y faces swapped.
    std::swap(world.textures[2], world.textures[3]);
    world.map_from_world = mat3(1, 0, 0, 0, -1, 0, 0, 0, 1);
  }
}

void parse_world_textures(const JsonNode& node, const Names& textures, WorldDescription& world) {
  const std::vector<JsonNode> names = node.items(6);
  if (names.size() != 1 && names.size() != 6) {
    node.fail("expected 1 texture, or 6: +X -X +Y -Y +Z -Z");
  }
  world.kind = names.size() == 1 ? KESTREL_WORLD_EQUIRECTANGULAR : KESTREL_WORLD_CUBE;
  for (size_t i = 0; i < names.size(); ++i) world.textures[i] = textures.find(names[i]);
}

// ---- lights ------------------------------------------------------------------------------------

void parse_direction(const JsonNode& node, KestrelLight& light) {
  vec3 direction(light.direction[0], light.direction[1], light.direction[2]);
  if (const auto target = node.find("target")) {
    if (node.has("direction")) node.fail("has both 'direction' and 'target'; use one of them");
    direction = parse_vec3(node, "target", vec3(0.0f)) -
                vec3(light.position[0], light.position[1], light.position[2]);
    if (glm::length(direction) < 1e-6f) target->fail("must differ from the light's position");
  } else if (const auto given = node.find("direction")) {
    direction = parse_vec3(node, "direction", direction);
    if (glm::length(direction) < 1e-6f) given->fail("must not be zero");
  }
  direction = normalized(direction);
  for (int i = 0; i < 3; ++i) light.direction[i] = direction[i];
}

std::vector<std::string> light_keys(int type) {
  std::vector<std::string> keys = {
      "name", "type", "color", "intensity", "specular_factor", "casts_shadow", "position"};
  if (type != KESTREL_LIGHT_DIRECTIONAL) keys.push_back("attenuation");
  if (type != KESTREL_LIGHT_POINT) keys.insert(keys.end(), {"direction", "target"});
  if (type == KESTREL_LIGHT_SPOT) keys.insert(keys.end(), {"spot_angle", "blend", "exponent"});
  return keys;
}

}  // namespace

CameraDescription parse_camera(const JsonNode& node) {
  node.expect_keys({"type",
                    "fov",
                    "fov_x",
                    "fov_y",
                    "scale",
                    "window",
                    "shift_x",
                    "shift_y",
                    "position",
                    "look_at",
                    "up",
                    "rotation",
                    "matrix",
                    "near",
                    "far",
                    "path",
                    "aperture_radius",
                    "focus_distance",
                    "aperture_blades",
                    "aperture_rotation",
                    "aperture_ratio"});
  CameraDescription camera;
  const auto type = node.find("type");
  const bool orthographic = type && type->choice(kProjectionWords) == 1;
  if (orthographic) camera.projection = KESTREL_ORTHOGRAPHIC;
  if (const auto window = node.find("window")) {
    camera.window = parse_window(node, *window);
  } else if (orthographic) {
    camera.extent = node.require("scale").number(1e-6, kMaximumLength);
    for (const char* key : {"fov", "fov_x", "fov_y"}) {
      if (node.has(key)) node.require(key).fail("an orthographic camera has 'scale' instead");
    }
  } else {
    parse_field_of_view(node, camera);
    if (node.has("scale")) node.require("scale").fail("is for orthographic cameras only");
  }
  if (const auto shift = node.find("shift_x")) camera.shift.x = shift->number(-100, 100);
  if (const auto shift = node.find("shift_y")) camera.shift.y = shift->number(-100, 100);
  if (const auto v = node.find("near")) {
    camera.near_clip = v->number(orthographic ? -kMaximumSceneNumber : 1e-6, kMaximumSceneNumber);
  }
  if (const auto v = node.find("far")) {
    camera.far_clip = v->number(-kMaximumSceneNumber, kMaximumSceneNumber);
  }
  if (!(camera.near_clip < camera.far_clip)) {
    node.fail("'near' ({}) must be below 'far' ({})", camera.near_clip, camera.far_clip);
  }
  parse_aperture(node, camera);
  camera.up = parse_vec3(node, "up", camera.up);
  if (glm::length(camera.up) < 1e-6f) node.require("up").fail("must not be zero");
  if (const auto path = node.find("path")) camera.path = parse_path(*path);
  const bool placed =
      node.has("matrix") || node.has("position") || node.has("look_at") || node.has("rotation");
  camera.world_from_camera =
      placed || camera.path.empty()
          ? parse_camera_placement(node, camera.up)
          : world_from_camera_looking(camera.path[0].position, camera.path[0].look_at, camera.up);
  return camera;
}

WorldDescription parse_world(const JsonNode& node, const Names& textures, SceneDescription& scene) {
  node.expect_keys({"color", "strength", "image", "cube", "textures", "flip", "up", "rotation",
                    "matrix", "mist"});
  WorldDescription world;
  if (const auto mist = node.find("mist")) parse_mist(*mist, world);
  const auto image = node.find("image");
  const auto cube = node.find("cube");
  const auto named = node.find("textures");
  if (image.has_value() + cube.has_value() + named.has_value() > 1) {
    node.fail("has several of 'image', 'cube' and 'textures'; use one of them");
  }
  const float factor = image || cube || named ? 1.0f : 0.0f;
  world.color = parse_vec3(node, "color", vec3(factor), -kMaximumRadiance, kMaximumRadiance);
  if (const auto strength = node.find("strength")) {
    world.color *= strength->number(0, kMaximumRadiance);
  }
  if (node.has("flip") && !cube) node.require("flip").fail("is for 'cube' only");
  if (image) {
    world.kind = KESTREL_WORLD_EQUIRECTANGULAR;
    world.textures[0] = add_world_image(*image, KESTREL_EXTENSION_REPEAT, scene);
  }
  if (cube) parse_cube(node, *cube, world, scene);
  if (named) parse_world_textures(*named, textures, world);
  if (const auto matrix = node.find("matrix")) {
    for (const char* other : {"up", "rotation"}) {
      if (node.has(other)) node.fail("has both 'matrix' and '{}'; use one of them", other);
    }
    const std::vector<float> v = matrix->numbers(9, 9, -kMaximumLength, kMaximumLength);
    for (int i = 0; i < 9; ++i) world.map_from_world[i / 3][i % 3] = v[i];
  }
  if (parse_up(node) == UpAxis::y) world.map_from_world = world.map_from_world * kYUpFromZUp;
  if (const auto angle = node.find("rotation")) {
    // The picture turns anticlockwise seen from above: directions turn the other way.
    world.map_from_world =
        world.map_from_world * rotation_from_degrees({0.0f, 0.0f, -angle->number(-1e6, 1e6)});
  }
  return world;
}

LightDescription parse_light(const JsonNode& node, size_t index) {
  const int type = node.require("type").choice(kLightWords);
  node.expect_keys(light_keys(type));
  LightDescription light;
  KestrelLight& v = light.values;
  kestrelDefaultLight(&v);
  v.type = type;
  const auto name = node.find("name");
  light.name = name ? name->text() : fmt::format("Light {}", index);
  const auto intensity = node.find("intensity");
  const vec3 color = parse_vec3(node, "color", vec3(1.0f), 0, kMaximumRadiance) *
                     (intensity ? intensity->number(0, kMaximumRadiance) : 1.0f);
  const vec3 position = parse_vec3(node, "position", vec3(0.0f));
  for (int i = 0; i < 3; ++i) {
    v.color[i] = color[i];
    v.position[i] = position[i];
  }
  if (type != KESTREL_LIGHT_POINT) parse_direction(node, v);
  if (const auto attenuation = node.find("attenuation")) {
    const vec3 a = parse_vec3(node, "attenuation", vec3(0.0f), 0, kMaximumLength);
    if (a == vec3(0.0f)) attenuation->fail("at least one of the three must be above 0");
    for (int i = 0; i < 3; ++i) v.attenuation[i] = a[i];
  }
  if (const auto n = node.find("spot_angle")) v.spot_angle = n->radians(0.0, 180.0);
  if (const auto n = node.find("blend")) v.spot_blend = n->number(0.0, 1.0);
  if (const auto n = node.find("exponent")) v.spot_exponent = n->number(0.0, 1000.0);
  if (const auto n = node.find("specular_factor")) v.specular_factor = n->number(0.0, 1e6);
  if (const auto n = node.find("casts_shadow")) v.casts_shadow = n->boolean();
  return light;
}

}  // namespace kestrel::cli
