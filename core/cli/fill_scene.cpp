// SPDX-License-Identifier: GPL-3.0-or-later
// A description into the library, through the C interface.
#include <stdexcept>

#include "cli/camera.h"
#include "cli/scene_file.h"

namespace kestrel::cli {
namespace {

uint64_t id_of(int index) {
  return static_cast<uint64_t>(index) + 1;
}

void set_texture(KestrelScene scene, uint64_t id, const TextureDescription& texture) {
  const KestrelTextureOptions options{texture.name.c_str(), texture.srgb, texture.nearest,
                                      texture.extension};
  if (const auto* file = std::get_if<TextureFile>(&texture.source)) {
    check(kestrelSetTextureFile(scene, id, file->path.c_str(), &options));
  } else if (const auto* bytes = std::get_if<TextureBytes>(&texture.source)) {
    check(kestrelSetTextureMemory(scene, id, bytes->data.data(), bytes->data.size(), &options));
  } else {
    const auto& pixels = std::get<TexturePixels>(texture.source);
    check(pixels.rgba.empty() ? kestrelSetTexturePixels8(scene, id, pixels.width, pixels.height,
                                                         pixels.bytes.data(), &options)
                              : kestrelSetTexturePixelsFloat(scene, id, pixels.width, pixels.height,
                                                             pixels.rgba.data(), &options));
  }
}

template <typename T>
const float* floats(const std::vector<T>& values) {
  return values.empty() ? nullptr : &values[0][0];
}

void set_mesh(KestrelScene scene, uint64_t id, const MeshDescription& mesh) {
  static_assert(sizeof(mat4x3) == 48 && sizeof(vec4) == 16 && sizeof(vec3) == 12 &&
                sizeof(vec2) == 8 && sizeof(uvec3) == 12);
  KestrelMesh m{};
  m.name = mesh.name.c_str();
  m.vertex_count = mesh.positions.size();
  m.positions = floats(mesh.positions);
  m.triangle_count = mesh.triangles.size();
  m.triangles = &mesh.triangles[0][0];
  m.corner_normals = floats(mesh.corner_normals);
  m.corner_uvs = floats(mesh.corner_uvs);
  m.corner_tangents = floats(mesh.corner_tangents);
  m.triangle_materials = mesh.triangle_slots.empty() ? nullptr : mesh.triangle_slots.data();
  std::vector<vec3> positions, normals;  // shape after shape
  for (const ShapeDescription& shape : mesh.motion) {
    positions.insert(positions.end(), shape.positions.begin(), shape.positions.end());
    normals.insert(normals.end(), shape.corner_normals.begin(), shape.corner_normals.end());
  }
  m.motion_count = mesh.motion.size();
  m.motion_positions = floats(positions);
  m.motion_corner_normals = floats(normals);
  m.uv_map = mesh.uv_map;
  std::vector<KestrelMeshAttribute> attributes;
  for (const AttributeDescription& attribute : mesh.attributes) {
    attributes.push_back({attribute.id, attribute.channels, attribute.values.data()});
  }
  m.attribute_count = attributes.size();
  m.attributes = attributes.data();
  check(kestrelSetMesh(scene, id, &m));
}

void set_object(KestrelScene scene, uint64_t id, const ObjectDescription& object) {
  std::vector<uint64_t> materials;
  for (const int index : object.materials) {
    materials.push_back(index == kNoIndex ? 0 : id_of(index));
  }
  KestrelObject o{};
  o.name = object.name.c_str();
  o.mesh = id_of(object.mesh);
  o.materials = materials.data();
  o.material_count = materials.size();
  for (int i = 0; i < 12; ++i) o.world_from_object[i] = object.world_from_object[i / 3][i % 3];
  o.unit = object.unit.empty() ? nullptr : object.unit.c_str();
  o.hidden_from = object.hidden_from;
  o.holdout = object.holdout;
  o.pass_index = object.pass_index;
  o.asset = object.asset.empty() ? nullptr : object.asset.c_str();
  check(kestrelSetObject(scene, id, &o));
  if (!object.motion.empty()) {
    check(kestrelSetObjectMotion(scene, id, &object.motion[0][0][0], object.motion.size()));
  }
  for (const auto& [name, value] : object.settings) {
    check(kestrelSetObjectSetting(scene, id, name.c_str(), value.c_str()));
  }
}

void set_world(KestrelScene scene, const WorldDescription& world) {
  KestrelWorld w{};
  w.kind = world.kind;
  for (int i = 0; i < 3; ++i) w.color[i] = world.color[i];
  for (int i = 0; i < 6; ++i) {
    w.textures[i] = world.textures[i] == kNoIndex ? 0 : id_of(world.textures[i]);
  }
  for (int i = 0; i < 9; ++i) w.map_from_world[i] = world.map_from_world[i / 3][i % 3];
  w.mist_start = world.mist_start;
  w.mist_depth = world.mist_depth;
  w.mist_falloff = world.mist_falloff;
  check(kestrelSetWorld(scene, &w));
}

/// Which items something refers to: files may hold many more, which need not be loaded.
struct Used {
  explicit Used(const SceneDescription& scene)
      : meshes(scene.meshes.size()),
        materials(scene.materials.size()),
        textures(scene.textures.size()) {
    for (const ObjectDescription& object : scene.objects) {
      meshes[object.mesh] = true;
      for (const int index : object.materials) {
        if (index != kNoIndex) materials[index] = true;
      }
    }
    for (size_t i = 0; i < materials.size(); ++i) {
      if (materials[i]) add_textures(scene.materials[i].values);
    }
    for (const int index : scene.world.textures) {
      if (index != kNoIndex) textures[index] = true;
    }
  }

  std::vector<bool> meshes, materials, textures;

 private:
  void add_textures(const KestrelMaterial& m) {
    for (const uint64_t id : {m.emission_texture, m.ambient_texture, m.diffuse_texture,
                              m.specular_texture, m.normal_texture, m.optical_texture}) {
      if (id) textures[id - 1] = true;
    }
  }
};

void set_material(KestrelScene scene, uint64_t id, const MaterialDescription& description) {
  KestrelMaterial material = description.values;
  material.name = description.name.c_str();
  check(kestrelSetMaterial(scene, id, &material));
}

void set_light(KestrelScene scene, uint64_t id, const LightDescription& description) {
  KestrelLight light = description.values;
  light.name = description.name.c_str();
  check(kestrelSetLight(scene, id, &light));
}

/// Calls `set` for every item that is used.
template <typename T>
void set_used(KestrelScene scene, const std::vector<T>& items, const std::vector<bool>& used,
              void (*set)(KestrelScene, uint64_t, const T&)) {
  for (size_t i = 0; i < items.size(); ++i) {
    if (used[i]) set(scene, i + 1, items[i]);
  }
}

}  // namespace

void check(KestrelError error) {
  if (error == KESTREL_ERROR_NONE) return;
  const char* message = nullptr;
  kestrelGetError(&message);
  throw std::runtime_error(message && *message ? message : "the library gave no reason");
}

void fill_scene(const SceneDescription& description, int width, int height, KestrelScene scene) {
  for (const auto& [name, value] : description.settings) {
    check(kestrelSetSetting(scene, name.c_str(), value.c_str()));
  }
  const KestrelCamera camera = camera_for(description.camera, width, height);
  check(kestrelSetCamera(scene, &camera));
  std::vector<KestrelCamera> states;
  for (const CameraDescription& state : description.camera_motion) {
    states.push_back(camera_for(state, width, height));
  }
  if (!states.empty()) check(kestrelSetCameraMotion(scene, states.data(), states.size()));
  const Used used(description);
  set_used(scene, description.textures, used.textures, set_texture);
  set_used(scene, description.materials, used.materials, set_material);
  set_used(scene, description.meshes, used.meshes, set_mesh);
  set_used(scene, description.lights, std::vector<bool>(description.lights.size(), true),
           set_light);
  set_used(scene, description.objects, std::vector<bool>(description.objects.size(), true),
           set_object);
  set_world(scene, description.world);
  check(kestrelCommitScene(scene));
}

}  // namespace kestrel::cli
