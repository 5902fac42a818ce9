// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_builder.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <unordered_map>
#include <unordered_set>

#include "base/error.h"
#include "base/log.h"
#include "scene/motion.h"
#include "scene/tangents.h"

namespace kestrel {
namespace {

/// Messages and units need a name; an item without one is called by its id.
void name_by_id(std::string& name, const char* kind, uint64_t id) {
  if (name.empty()) name = fmt::format("{} {}", kind, id);
}

void require_id(uint64_t id, const char* kind) {
  if (id == 0) {
    fail(ErrorCode::invalid_argument, "0 is no id of a {}. Choose a number from 1 on.", kind);
  }
}

std::array<uint64_t, 6> texture_ids(const MaterialInput& m) {
  return {m.emission_texture, m.ambient_texture, m.diffuse_texture,
          m.specular_texture, m.normal_texture,  m.optical_texture};
}

/// Slots without a texture take the UV map of the others, so that one map is known as one.
void unite_uv_maps(Material& material) {
  uint64_t first = 0;
  bool any = false;
  material.several_uv_maps = false;
  for (int slot = 0; slot < kTextureSlots; ++slot) {
    if (material.texture(slot) == kNone) continue;
    const uint64_t map = material.uv_maps[slot];
    if (any && map != first) material.several_uv_maps = true;
    if (!any) first = map;
    any = true;
  }
  for (int slot = 0; slot < kTextureSlots; ++slot) {
    if (material.texture(slot) == kNone) material.uv_maps[slot] = first;
  }
}

/// A mesh with tangents along a UV map; null where it has them already or lacks the map.
std::shared_ptr<const Mesh> with_tangents(const Mesh& mesh, uint64_t uv_map) {
  const bool own = uv_map == 0 || uv_map == mesh.uv_map;
  if (!mesh.tangents_of(uv_map).empty()) return nullptr;
  if (!own && mesh.uvs_of(uv_map).empty()) return nullptr;
  auto out = std::make_shared<Mesh>(mesh);
  pad_positions(*out);
  std::vector<vec4> tangents = make_tangents(*out, out->uvs_of(uv_map));
  if (own) out->corner_tangents = std::move(tangents);
  for (UvMap& map : out->more_uv_maps) {
    if (own || map.id != uv_map) continue;
    map.corner_tangents = std::move(tangents);
    break;
  }
  return out;
}

}  // namespace

struct SceneBuilder::Assembly {
  std::shared_ptr<Scene> scene = std::make_shared<Scene>();
  std::unordered_map<const Texture*, int> texture_indices;
  std::unordered_map<uint64_t, int> material_indices;
  std::unordered_map<uint64_t, int> mesh_indices;
  std::unordered_map<std::string, int> unit_indices;

  /// Adds the texture on first use; the same texels under two ids become one.
  int texture_index(TextureStore& store, uint64_t id) {
    if (id == 0) return kNone;
    std::shared_ptr<const Texture> texture = store.get(id);
    const auto [place, added] =
        texture_indices.emplace(texture.get(), static_cast<int>(scene->textures.size()));
    if (added) scene->textures.push_back(std::move(texture));
    return place->second;
  }
  int unit_index(const std::string& name) {
    const auto [place, added] = unit_indices.emplace(name, static_cast<int>(scene->units.size()));
    if (added) scene->units.push_back({.name = name});
    return place->second;
  }
};

void SceneBuilder::set_mesh(uint64_t id, const MeshInput& input) {
  require_id(id, "mesh");
  MeshInput named = input;
  name_by_id(named.name, "mesh", id);
  meshes_.put(id, validate_mesh(named));
}

void SceneBuilder::set_texture_file(uint64_t id, std::string path, const TextureOptions& options) {
  require_id(id, "texture");
  textures_.set_file(id, std::move(path), options);
}

void SceneBuilder::set_texture_memory(uint64_t id, std::span<const uint8_t> bytes,
                                      const TextureOptions& options) {
  require_id(id, "texture");
  textures_.set_memory(id, bytes, options);
}

void SceneBuilder::set_texture_pixels8(uint64_t id, int width, int height,
                                       std::span<const uint8_t> rgba,
                                       const TextureOptions& options) {
  require_id(id, "texture");
  textures_.set_pixels8(id, width, height, rgba, options);
}

void SceneBuilder::set_texture_pixels_float(uint64_t id, int width, int height,
                                            std::span<const float> rgba,
                                            const TextureOptions& options) {
  require_id(id, "texture");
  textures_.set_pixels_float(id, width, height, rgba, options);
}

void SceneBuilder::set_material(uint64_t id, MaterialInput input) {
  require_id(id, "material");
  name_by_id(input.values.name, "material", id);
  check_material(input);
  materials_.put(id, std::move(input));
}

void SceneBuilder::set_light(uint64_t id, LightInput input) {
  require_id(id, "light");
  name_by_id(input.values.name, "light", id);
  lights_.put(id, checked_light(std::move(input)));
}

void SceneBuilder::set_object(uint64_t id, ObjectInput input) {
  require_id(id, "object");
  name_by_id(input.name, "object", id);
  if (input.unit.empty()) input.unit = input.name;
  if (input.asset.empty()) input.asset = input.name;
  check_matrix(input.world_from_object, fmt::format("Object '{}'", input.name),
               "world_from_object");
  if (ObjectEntry* known = objects_.find(id)) {
    known->input = std::move(input);
  } else {
    objects_.put(id, {.input = std::move(input)});
  }
}

void SceneBuilder::set_object_transform(uint64_t id, const mat4x3& world_from_object) {
  ObjectEntry* object = objects_.find(id);
  if (!object) {
    fail(ErrorCode::invalid_argument,
         "There is no object {} to move. Set it with kestrelSetObject() first.", id);
  }
  check_matrix(world_from_object, fmt::format("Object '{}'", object->input.name),
               "world_from_object");
  object->input.world_from_object = world_from_object;
}

void SceneBuilder::set_object_motion(uint64_t id, const std::vector<mat4x3>& world_from_object) {
  ObjectEntry* object = objects_.find(id);
  if (!object) {
    fail(ErrorCode::invalid_argument,
         "There is no object {} to give a motion. Set it with kestrelSetObject() first.", id);
  }
  for (const mat4x3& matrix : world_from_object) {
    check_matrix(matrix, fmt::format("Object '{}'", object->input.name), "motion");
  }
  object->motion = motion_from(world_from_object);
  object->motion_matrices.reset();
  if (object->motion) {
    object->motion_matrices = std::make_shared<const std::vector<mat4x3>>(world_from_object);
  }
}

void SceneBuilder::set_object_setting(uint64_t id, std::string_view name, std::string_view value) {
  ObjectEntry* object = objects_.find(id);
  if (!object) {
    fail(ErrorCode::invalid_argument,
         "There is no object {} to set '{}' of. Set it with kestrelSetObject() first.", id, name);
  }
  ObjectSettings scratch;
  set_parameter(scratch, name, value);
  object->settings[std::string(name)] = {std::string(value), ++setting_calls_};
}

void SceneBuilder::set_camera(const Camera& camera) {
  camera_ = checked_camera(camera);
  camera_motion_.clear();
}

void SceneBuilder::set_camera_motion(const std::vector<Camera>& states) {
  std::vector<Camera> checked;
  for (const Camera& state : states) {
    checked.push_back(checked_camera(state));
    if (!camera_ || camera_->projection != state.projection) {
      fail(ErrorCode::invalid_operation,
           "The camera's motion needs a camera of the same projection. Set it with "
           "kestrelSetCamera() first.");
    }
  }
  camera_motion_ = std::move(checked);
}

void SceneBuilder::set_world(const WorldInput& input) {
  check_world(input);
  world_ = input;
}

void SceneBuilder::set_setting(std::string_view name, std::string_view value) {
  Settings changed = settings_;
  set_parameter(changed, name, value);
  settings_ = changed;
}

std::string SceneBuilder::setting(std::string_view name) const {
  return get_parameter(settings_, name);
}

void SceneBuilder::remove(ItemKind kind, uint64_t id) {
  bool known = false;
  const char* what = "";
  switch (kind) {
    case ItemKind::mesh:
      known = meshes_.erase(id), what = "mesh";
      break;
    case ItemKind::texture:
      known = textures_.erase(id), what = "texture";
      break;
    case ItemKind::material:
      known = materials_.erase(id), what = "material";
      break;
    case ItemKind::light:
      known = lights_.erase(id), what = "light";
      break;
    case ItemKind::object:
      known = objects_.erase(id), what = "object";
      break;
  }
  if (!known) {
    fail(ErrorCode::invalid_argument, "There is no {} {} to remove. Check its id and kind.", what,
         id);
  }
}

void SceneBuilder::require_references() {
  if (!camera_) {
    fail(ErrorCode::invalid_operation,
         "The scene has no camera. Set one with kestrelSetCamera() before the commit.");
  }
  const auto require_texture = [this](uint64_t texture, const std::string* material) {
    if (texture == 0 || textures_.contains(texture)) return;
    fail(ErrorCode::invalid_argument,
         "{} uses texture {}, which is not in the scene. Set that texture, or use 0 for none.",
         material ? fmt::format("Material '{}'", *material) : "The world", texture);
  };
  for (const auto& [id, material] : materials_) {
    for (const uint64_t texture : texture_ids(material)) {
      require_texture(texture, &material.values.name);
    }
  }
  for (int i = 0; i < texture_count(world_.values.kind); ++i) {
    require_texture(world_.textures[i], nullptr);
  }
  for (const auto& [id, object] : objects_) {
    const ObjectInput& input = object.input;
    if (!meshes_.find(input.mesh)) {
      fail(ErrorCode::invalid_argument,
           "Object '{}' uses mesh {}, which is not in the scene. Set that mesh, or remove the "
           "object.",
           input.name, input.mesh);
    }
    for (const uint64_t material : input.materials) {
      if (material == 0 || materials_.find(material)) continue;
      fail(ErrorCode::invalid_argument,
           "Object '{}' uses material {}, which is not in the scene. Set that material, or use 0 "
           "for the default grey.",
           input.name, material);
    }
  }
}

std::vector<uint64_t> SceneBuilder::textures_in_use() {
  std::vector<uint64_t> ids;
  std::unordered_set<uint64_t> seen{0};
  const auto use = [&](uint64_t id) {
    if (seen.insert(id).second) ids.push_back(id);
  };
  for (const auto& [id, material] : materials_) {
    for (const uint64_t texture : texture_ids(material)) use(texture);
  }
  for (int i = 0; i < texture_count(world_.values.kind); ++i) use(world_.textures[i]);
  return ids;
}

void SceneBuilder::add_materials(Assembly& out) {
  out.scene->materials.push_back({.name = "Default"});
  out.scene->materials[0].ambient = vec3(0.8f);
  for (const auto& [id, input] : materials_) {
    Material material = input.values;
    material.emission_texture = out.texture_index(textures_, input.emission_texture);
    material.ambient_texture = out.texture_index(textures_, input.ambient_texture);
    material.diffuse_texture = out.texture_index(textures_, input.diffuse_texture);
    material.specular_texture = out.texture_index(textures_, input.specular_texture);
    material.normal_texture = out.texture_index(textures_, input.normal_texture);
    material.optical_texture = out.texture_index(textures_, input.optical_texture);
    unite_uv_maps(material);
    out.material_indices[id] = static_cast<int>(out.scene->materials.size());
    out.scene->materials.push_back(std::move(material));
  }
}

int SceneBuilder::mesh_index(Assembly& out, uint64_t id,
                             const std::vector<uint64_t>& tangent_maps) {
  ValidMesh& valid = *meshes_.find(id);
  const auto known = out.mesh_indices.find(id);
  for (const uint64_t map : tangent_maps) {
    std::shared_ptr<const Mesh> changed = with_tangents(*valid.mesh, map);
    if (!changed) continue;
    valid.mesh = std::move(changed);
    if (known != out.mesh_indices.end()) out.scene->meshes[known->second] = valid.mesh;
  }
  if (known != out.mesh_indices.end()) return known->second;
  out.scene->meshes.push_back(valid.mesh);
  return out.mesh_indices[id] = static_cast<int>(out.scene->meshes.size()) - 1;
}

void SceneBuilder::add_object(Assembly& out, uint64_t id, const ObjectEntry& entry) {
  const ObjectInput& input = entry.input;
  const ValidMesh& valid = *meshes_.find(input.mesh);
  if (valid.mesh->triangles.empty()) return;
  if (!invertible(input.world_from_object)) {
    log::warning_once(
        "Object '{}' is not rendered: its matrix has no inverse. Give it a scale other than 0.",
        input.name);
    return;
  }
  Object object;
  object.id = id;
  object.name = input.name;
  object.asset = input.asset;
  object.pass_index = input.pass_index;
  object.world_from_object = input.world_from_object;
  object.flips_orientation = glm::determinant(mat3(input.world_from_object)) < 0.0f;
  object.hidden_from = input.hidden_from;
  object.holdout = input.holdout;
  object.motion = entry.motion;
  object.motion_matrices = entry.motion_matrices;
  out.scene->has_holdouts = out.scene->has_holdouts || input.holdout;
  object.materials.assign(valid.used_slots.back() + 1, 0);
  for (size_t slot = 0; slot < std::min(object.materials.size(), input.materials.size()); ++slot) {
    const uint64_t id = input.materials[slot];
    if (id != 0) object.materials[slot] = out.material_indices.at(id);
  }
  object.unit = out.unit_index(input.unit);
  Unit& unit = out.scene->units[object.unit];
  std::vector<uint64_t> tangent_maps;
  for (const uint32_t slot : valid.used_slots) {
    const Material& material = out.scene->materials[object.materials[slot]];
    unit.reflective = unit.reflective || material.reflective();
    unit.refractive = unit.refractive || material.refractive();
    if (material.normal_texture != kNone) tangent_maps.push_back(material.tangent_map);
  }
  unit.bounds.extend(transformed(valid.mesh->bounds, input.world_from_object));
  object.mesh = mesh_index(out, input.mesh, tangent_maps);
  out.scene->objects.push_back(std::move(object));
}

void SceneBuilder::apply_unit_settings(Assembly& out) {
  struct Call {
    uint64_t order;
    int unit;
    const std::string* name;
    const std::string* value;
  };
  std::vector<Call> calls;
  for (const auto& [id, object] : objects_) {
    const auto unit = out.unit_indices.find(object.input.unit);
    if (unit == out.unit_indices.end()) continue;
    for (const auto& [name, setting] : object.settings) {
      calls.push_back({setting.order, unit->second, &name, &setting.value});
    }
  }
  std::sort(calls.begin(), calls.end(),
            [](const Call& a, const Call& b) { return a.order < b.order; });
  for (const Call& call : calls) {
    set_parameter(out.scene->units[call.unit].settings, *call.name, *call.value);
  }
}

void SceneBuilder::add_world(Assembly& out) {
  out.scene->world = world_.values;
  const int count = texture_count(world_.values.kind);
  for (int i = 0; i < 6; ++i) {
    out.scene->world.textures[i] =
        i < count ? out.texture_index(textures_, world_.textures[i]) : kNone;
  }
}

std::shared_ptr<Scene> SceneBuilder::assemble(const std::function<bool()>& cancelled) {
  textures_.decode(textures_in_use(), cancelled);
  Assembly out;
  add_materials(out);
  for (const auto& [id, light] : lights_) {
    out.scene->lights.push_back(light);
    out.scene->lights.back().id = id;
  }
  std::sort(out.scene->lights.begin(), out.scene->lights.end(),
            [](const Light& a, const Light& b) { return a.id < b.id; });
  for (const auto& [id, object] : objects_) {
    if (cancelled && cancelled()) fail(ErrorCode::cancelled, "The commit was cancelled.");
    add_object(out, id, object);
  }
  apply_unit_settings(out);
  add_world(out);
  out.scene->camera = *camera_;
  out.scene->camera_motion = camera_motion_;
  out.scene->settings = settings_;
  return out.scene;
}

std::shared_ptr<const Scene> SceneBuilder::commit(const std::function<bool()>& cancelled) {
  require_references();
  // Isolated: while this thread waits for others, it must not pick up work that wants the lock
  // which the caller holds.
  published_ = tbb::this_task_arena::isolate([&] { return assemble(cancelled); });
  return published_;
}

}  // namespace kestrel
