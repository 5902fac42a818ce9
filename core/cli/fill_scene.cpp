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
    check(kestrelSetTexturePixelsFloat(scene, id, pixels.width, pixels.height, pixels.rgba.data(),
                                       &options));
  }
}

template <typename T>
const float* floats(const std::vector<T>& values) {
  return values.empty() ? nullptr : &values[0][0];
}

void set_mesh(KestrelScene scene, uint64_t id, const MeshDescription& mesh) {
  static_assert(sizeof(vec3) == 12 && sizeof(vec2) == 8 && sizeof(uvec3) == 12);
  KestrelMesh m{};
  m.name = mesh.name.c_str();
  m.vertex_count = mesh.positions.size();
  m.positions = floats(mesh.positions);
  m.triangle_count = mesh.triangles.size();
  m.triangles = &mesh.triangles[0][0];
  m.corner_normals = floats(mesh.corner_normals);
  m.corner_uvs = floats(mesh.corner_uvs);
  m.triangle_materials = mesh.triangle_slots.empty() ? nullptr : mesh.triangle_slots.data();
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
  check(kestrelSetObject(scene, id, &o));
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
  check(kestrelSetWorld(scene, &w));
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
  for (size_t i = 0; i < description.textures.size(); ++i) {
    set_texture(scene, i + 1, description.textures[i]);
  }
  for (size_t i = 0; i < description.materials.size(); ++i) {
    KestrelMaterial material = description.materials[i].values;
    material.name = description.materials[i].name.c_str();
    check(kestrelSetMaterial(scene, i + 1, &material));
  }
  for (size_t i = 0; i < description.lights.size(); ++i) {
    KestrelLight light = description.lights[i].values;
    light.name = description.lights[i].name.c_str();
    check(kestrelSetLight(scene, i + 1, &light));
  }
  for (size_t i = 0; i < description.meshes.size(); ++i) {
    set_mesh(scene, i + 1, description.meshes[i]);
  }
  for (size_t i = 0; i < description.objects.size(); ++i) {
    set_object(scene, i + 1, description.objects[i]);
  }
  set_world(scene, description.world);
  check(kestrelCommitScene(scene));
}

}  // namespace kestrel::cli
