// SPDX-License-Identifier: GPL-3.0-or-later
// kestrel.h: scene.
#include <string>

#include "api/convert.h"
#include "api/errors.h"
#include "api/handles.h"
#include "scene/scene_writer.h"

using namespace kestrel;
using namespace kestrel::api;

namespace {

/// Runs `edit` on the scene's builder, alone.
template <typename Edit>
KestrelError edit_scene(KestrelScene scene, Edit&& edit) noexcept {
  return guarded([&] {
    const auto state = scenes().get(scene);
    const std::lock_guard lock(state->mutex);
    edit(state->builder);
  });
}

/// Lets a commit be cancelled while this lives.
class CommitScope {
 public:
  explicit CommitScope(SceneState& state) : state_(state) {
    state.commit_cancelled = false;
    state.committing = true;
  }
  ~CommitScope() { state_.committing = false; }
  CommitScope(const CommitScope&) = delete;
  CommitScope& operator=(const CommitScope&) = delete;

 private:
  SceneState& state_;
};

}  // namespace

KestrelScene kestrelNewScene(KestrelDevice device) {
  return guarded_or(KestrelScene{nullptr}, [&] {
    return scenes().insert(std::make_shared<SceneState>(devices().get(device)));
  });
}

void kestrelRetainScene(KestrelScene scene) {
  guarded([&] { scenes().retain(scene); });
}

void kestrelReleaseScene(KestrelScene scene) {
  guarded([&] { scenes().release(scene); });
}

KestrelError kestrelSetMesh(KestrelScene scene, uint64_t id, const KestrelMesh* mesh) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_mesh(id, mesh_from(*require(mesh, "mesh")));
  });
}

KestrelError kestrelSetTextureFile(KestrelScene scene, uint64_t id, const char* path,
                                   const KestrelTextureOptions* options) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_texture_file(id, require(path, "path"), options_from(options));
  });
}

KestrelError kestrelSetTextureMemory(KestrelScene scene, uint64_t id, const void* data,
                                     size_t byte_count, const KestrelTextureOptions* options) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    const auto* bytes = static_cast<const uint8_t*>(require(data, "data"));
    builder.set_texture_memory(id, {bytes, byte_count}, options_from(options));
  });
}

KestrelError kestrelSetTexturePixels8(KestrelScene scene, uint64_t id, int width, int height,
                                      const uint8_t* rgba, const KestrelTextureOptions* options) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    const size_t count = texel_values(width, height);
    builder.set_texture_pixels8(id, width, height, {require(rgba, "rgba"), count},
                                options_from(options));
  });
}

KestrelError kestrelSetTexturePixelsFloat(KestrelScene scene, uint64_t id, int width, int height,
                                          const float* rgba, const KestrelTextureOptions* options) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    const size_t count = texel_values(width, height);
    builder.set_texture_pixels_float(id, width, height, {require(rgba, "rgba"), count},
                                     options_from(options));
  });
}

void kestrelDefaultMaterial(KestrelMaterial* material) {
  guarded([&] {
    *require(material, "material") = KestrelMaterial{
        .ambient = {0.8f, 0.8f, 0.8f},
        .diffuse = {0.8f, 0.8f, 0.8f, 1.0f},
        .optical = {0.0f, 1.0f, 1.0f},
        .reflection_color = {1.0f, 1.0f, 1.0f},
        .transmission_color = {1.0f, 1.0f, 1.0f},
        .normal_strength = 1.0f,
        .tiling = {1.0f, 1.0f},
        .casts_shadow = true,
        .alpha_mode = KESTREL_ALPHA_OPAQUE,
        .alpha_cutoff = 0.5f,
    };
  });
}

KestrelError kestrelSetMaterial(KestrelScene scene, uint64_t id, const KestrelMaterial* material) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_material(id, material_from(*require(material, "material")));
  });
}

void kestrelDefaultLight(KestrelLight* light) {
  guarded([&] {
    *require(light, "light") = KestrelLight{
        .type = KESTREL_LIGHT_POINT,
        .color = {1.0f, 1.0f, 1.0f},
        .direction = {0.0f, 0.0f, -1.0f},
        .attenuation = {0.0f, 0.0f, 1.0f},
        .spot_angle = 0.785398163f,
        .spot_blend = 0.15f,
        .spot_exponent = 0.0f,
        .specular_factor = 1.0f,
        .casts_shadow = true,
    };
  });
}

KestrelError kestrelSetLight(KestrelScene scene, uint64_t id, const KestrelLight* light) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_light(id, light_from(*require(light, "light")));
  });
}

KestrelError kestrelSetObject(KestrelScene scene, uint64_t id, const KestrelObject* object) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_object(id, object_from(*require(object, "object")));
  });
}

KestrelError kestrelSetObjects(KestrelScene scene, const uint64_t* ids,
                               const float* world_from_object, size_t count,
                               const KestrelObject* object) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    const auto all = array(ids, count, "ids");
    const auto matrices = array(world_from_object, 12 * count, "world_from_object");
    ObjectInput input = object_from(*require(object, "object"));
    for (size_t i = 0; i < count; ++i) {
      input.world_from_object = matrix_from(&matrices[12 * i]);
      builder.set_object(all[i], input);
    }
  });
}

KestrelError kestrelSetObjectTransform(KestrelScene scene, uint64_t id,
                                       const float world_from_object[12]) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_object_transform(id, matrix_from(require(world_from_object, "world_from_object")));
  });
}

KestrelError kestrelSetObjectTransforms(KestrelScene scene, const uint64_t* ids,
                                        const float* world_from_object, size_t count) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    const auto all = array(ids, count, "ids");
    const auto matrices = array(world_from_object, 12 * count, "world_from_object");
    for (size_t i = 0; i < count; ++i) {
      builder.set_object_transform(all[i], matrix_from(&matrices[12 * i]));
    }
  });
}

KestrelError kestrelSetObjectMotion(KestrelScene scene, uint64_t id, const float* world_from_object,
                                    size_t count) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_object_motion(id, matrices_from(world_from_object, count));
  });
}

KestrelError kestrelSetObjectSetting(KestrelScene scene, uint64_t id, const char* name,
                                     const char* value) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_object_setting(id, require(name, "name"), require(value, "value"));
  });
}

KestrelError kestrelRemove(KestrelScene scene, KestrelKind kind, uint64_t id) {
  return edit_scene(scene, [&](SceneBuilder& builder) { builder.remove(kind_from(kind), id); });
}

KestrelError kestrelRemoveItems(KestrelScene scene, KestrelKind kind, const uint64_t* ids,
                                size_t count) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    const ItemKind items = kind_from(kind);
    for (const uint64_t id : array(ids, count, "ids")) builder.remove(items, id);
  });
}

KestrelError kestrelSetCamera(KestrelScene scene, const KestrelCamera* camera) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_camera(camera_from(*require(camera, "camera")));
  });
}

KestrelError kestrelSetCameraMotion(KestrelScene scene, const KestrelCamera* states, size_t count) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_camera_motion(cameras_from(states, count));
  });
}

KestrelError kestrelSetWorld(KestrelScene scene, const KestrelWorld* world) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_world(world_from(*require(world, "world")));
  });
}

KestrelError kestrelSetSetting(KestrelScene scene, const char* name, const char* value) {
  return edit_scene(scene, [&](SceneBuilder& builder) {
    builder.set_setting(require(name, "name"), require(value, "value"));
  });
}

const char* kestrelGetSetting(KestrelScene scene, const char* name) {
  return guarded_or(static_cast<const char*>(nullptr), [&] {
    thread_local std::string value;
    const auto state = scenes().get(scene);
    const std::lock_guard lock(state->mutex);
    value = state->builder.setting(require(name, "name"));
    return value.c_str();
  });
}

KestrelError kestrelCommitScene(KestrelScene scene) {
  return guarded([&] {
    const auto state = scenes().get(scene);
    const std::lock_guard lock(state->mutex);
    const CommitScope scope(*state);
    auto published = state->builder.commit([&] { return state->commit_cancelled.load(); });
    const std::lock_guard published_lock(state->published_mutex);
    state->published = std::move(published);
  });
}

void kestrelCancelCommit(KestrelScene scene) {
  guarded([&] {
    const auto state = scenes().get(scene);
    if (state->committing) state->commit_cancelled = true;
  });
}

KestrelError kestrelWriteScene(KestrelScene scene, const char* path, int width, int height) {
  return guarded([&] {
    const auto state = scenes().get(scene);
    const std::string target = require(path, "path");
    std::shared_ptr<const Scene> published;
    {
      const std::lock_guard lock(state->published_mutex);
      published = state->published;
    }
    if (!published) {
      fail(ErrorCode::invalid_operation,
           "The scene was never committed. Call kestrelCommitScene() before writing it.");
    }
    write_scene(*published, target, width, height);
  });
}
