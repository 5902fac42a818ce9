// SPDX-License-Identifier: GPL-3.0-or-later
// The scene while it is edited: items by the host's ids, turned into an immutable Scene.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/item_store.h"
#include "scene/mesh_validation.h"
#include "scene/scene.h"
#include "scene/scene_inputs.h"
#include "scene/texture_store.h"

namespace kestrel {

enum class ItemKind { mesh, texture, material, light, object };

/// Not thread-safe. A set function replaces the item with that id; ids are not 0. What fails
/// throws Error and changes nothing.
class SceneBuilder {
 public:
  void set_mesh(uint64_t id, const MeshInput& input);
  void set_texture_file(uint64_t id, std::string path, const TextureOptions& options);
  void set_texture_memory(uint64_t id, std::span<const uint8_t> bytes,
                          const TextureOptions& options);
  void set_texture_pixels8(uint64_t id, int width, int height, std::span<const uint8_t> rgba,
                           const TextureOptions& options);
  void set_texture_pixels_float(uint64_t id, int width, int height, std::span<const float> rgba,
                                const TextureOptions& options);
  void set_material(uint64_t id, MaterialInput input);
  void set_light(uint64_t id, LightInput input);
  void set_object(uint64_t id, ObjectInput input);
  void set_object_transform(uint64_t id, const mat4x3& world_from_object);
  /// Matrices at even steps of time, empty: it stands still. Throws Error for an unknown id.
  void set_object_motion(uint64_t id, const std::vector<mat4x3>& world_from_object);
  /// Of the object's unit; of several objects of one unit the last call decides.
  void set_object_setting(uint64_t id, std::string_view name, std::string_view value);
  void set_camera(const Camera& camera);
  /// States at even steps of time. Throws Error where there is no camera of that projection.
  void set_camera_motion(const std::vector<Camera>& states);
  void set_world(const WorldInput& input);
  void set_setting(std::string_view name, std::string_view value);
  std::string setting(std::string_view name) const;
  void remove(ItemKind kind, uint64_t id);

  /// Resolves ids, decodes textures in use, makes tangents in use. Throws Error where an id is
  /// unknown or the camera missing; published() then stays. Items are in the order in which their
  /// ids were first set, but lights, whose sum must not depend on it, in that of their ids; units
  /// in that of their first rendered object; meshes and textures only where something uses them.
  /// Unchanged ones keep their pointer from commit to commit. Throws Error(cancelled) soon after
  /// `cancelled()` says so; it is asked from any thread.
  std::shared_ptr<const Scene> commit(const std::function<bool()>& cancelled = {});

  /// The last commit's; null before.
  std::shared_ptr<const Scene> published() const { return published_; }

 private:
  struct ObjectSetting {
    std::string value;
    uint64_t order;  // of the call
  };
  struct ObjectEntry {
    ObjectInput input;
    std::map<std::string, ObjectSetting> settings;  // by name
    std::shared_ptr<const ObjectMotion> motion;     // null: stands still
    std::shared_ptr<const std::vector<mat4x3>> motion_matrices;
  };

  /// What a commit works with; indices are those of the new scene.
  struct Assembly;

  void require_references();
  std::shared_ptr<Scene> assemble(const std::function<bool()>& cancelled);
  std::vector<uint64_t> textures_in_use();
  void add_materials(Assembly& out);
  void add_object(Assembly& out, uint64_t id, const ObjectEntry& entry);
  void apply_unit_settings(Assembly& out);
  void add_world(Assembly& out);
  int mesh_index(Assembly& out, uint64_t id, const std::vector<uint64_t>& tangent_maps);

  ItemStore<ValidMesh> meshes_;
  TextureStore textures_;
  ItemStore<MaterialInput> materials_;
  ItemStore<Light> lights_;
  ItemStore<ObjectEntry> objects_;
  std::optional<Camera> camera_;
  std::vector<Camera> camera_motion_;
  WorldInput world_;
  Settings settings_;
  uint64_t setting_calls_ = 0;
  std::shared_ptr<const Scene> published_;
};

}  // namespace kestrel
