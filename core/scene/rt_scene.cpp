// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/rt_scene.h"

#include <tbb/parallel_for.h>

#include "base/error.h"

namespace kestrel {
namespace {

embree::SceneHandle new_scene(RTCDevice device) {
  embree::SceneHandle scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  return scene;
}

/// RayBits that meet an object.
unsigned ray_mask(uint8_t hidden_from) {
  return kAllRays & ~unsigned{hidden_from};
}

void attach_instance(RTCDevice device, RTCScene top, RTCScene mesh, const mat4x3& transform,
                     unsigned mask, unsigned id) {
  RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, mesh);
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &transform);
  rtcSetGeometryMask(instance, mask);
  rtcCommitGeometry(instance);
  rtcAttachGeometryByID(top, instance, id);
  rtcReleaseGeometry(instance);
}

}  // namespace

void RtScene::update(const std::shared_ptr<const Scene>& scene, const GoOn& go_on) {
  if (scene == scene_) return;
  scene_ = scene;
  try {
    build(go_on);
  } catch (...) {
    forget();
    throw;
  }
}

/// What is half built is not used again.
void RtScene::forget() {
  top_.reset();
  instances_.clear();
  instanced_.clear();
  static_.reset();
  static_built_.clear();
  static_geometry_.clear();
  static_objects_.clear();
  scene_.reset();
}

void RtScene::check(const GoOn& go_on) const {
  if (go_on && !go_on()) fail(ErrorCode::cancelled, "The render was cancelled.");
}

void RtScene::commit(RTCScene scene, const GoOn& go_on) {
  const auto ask = [](void* user, double) { return (*static_cast<const GoOn*>(user))(); };
  if (go_on) rtcSetSceneProgressMonitorFunction(scene, ask, const_cast<GoOn*>(&go_on));
  rtcCommitScene(scene);
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
  embree::check_device(device_);
}

void RtScene::build(const GoOn& go_on) {
  normal_from_object_.clear();
  for (const Object& object : scene_->objects) {
    normal_from_object_.push_back(glm::transpose(glm::inverse(mat3(object.world_from_object))));
  }
  inspect_meshes();
  const std::vector<int> static_objects = choose_static_objects();
  build_static(static_objects, go_on);
  build_instanced_meshes(static_objects, go_on);
  build_top(static_objects, go_on);
  embree::check_device(device_);
}

SurfaceHit RtScene::resolve(unsigned instance, unsigned geometry, unsigned primitive,
                            const vec2& barycentric) const {
  const bool filtered = geometry & 1u;
  if (instance == RTC_INVALID_GEOMETRY_ID || instance == 0) {
    const unsigned slot = geometry / 2;
    return {static_objects_[slot], static_geometry_[slot].triangle(filtered, primitive),
            barycentric};
  }
  const Instance& instanced = instances_[instance];
  return {instanced.object, instanced.geometry->triangle(filtered, primitive), barycentric};
}

/// Counts who uses each mesh, and finds the slots whose material, in any of them, needs a filter
/// function.
void RtScene::inspect_meshes() {
  users_.assign(scene_->meshes.size(), 0);
  filtered_slots_.assign(scene_->meshes.size(), std::vector<bool>(1, false));
  for (const Object& object : scene_->objects) {
    ++users_[object.mesh];
    std::vector<bool>& slots = filtered_slots_[object.mesh];
    if (slots.size() < object.materials.size()) slots.resize(object.materials.size(), false);
    for (size_t s = 0; s < slots.size(); ++s) {
      const int material = object.materials[std::min(s, object.materials.size() - 1)];
      if (scene_->materials[material].needs_any_hit()) slots[s] = true;
    }
  }
}

std::vector<int> RtScene::choose_static_objects() {
  std::vector<int> chosen;
  std::unordered_map<std::string, mat4x3> transforms;
  for (size_t i = 0; i < scene_->objects.size(); ++i) {
    const Object& object = scene_->objects[i];
    if (users_[object.mesh] != 1) continue;
    const auto last = last_transforms_.find(object.name);
    const bool moved = last != last_transforms_.end() && last->second != object.world_from_object;
    if (moved || object.motion || scene_->meshes[object.mesh]->motion) {
      moving_.insert(object.name);
    }
    transforms.emplace(object.name, object.world_from_object);
    if (!moving_.contains(object.name)) chosen.push_back(static_cast<int>(i));
  }
  last_transforms_ = std::move(transforms);
  return chosen;
}

void RtScene::build_static(const std::vector<int>& objects, const GoOn& go_on) {
  static_objects_ = objects;
  std::vector<StaticObject> wanted;
  for (const int i : objects) {
    const Object& object = scene_->objects[i];
    wanted.push_back({scene_->meshes[object.mesh], object.world_from_object,
                      filtered_slots_[object.mesh], object.hidden_from});
  }
  if (static_ && wanted == static_built_) return;
  static_built_ = std::move(wanted);
  static_ = new_scene(device_);
  static_geometry_.clear();
  for (const StaticObject& o : static_built_) {
    check(go_on);
    static_geometry_.emplace_back(o.mesh, o.filtered_slots, &o.world_from_object);
  }
  for (size_t i = 0; i < static_geometry_.size(); ++i) {
    static_geometry_[i].attach(device_, static_.get(), static_cast<unsigned>(i),
                               ray_mask(static_built_[i].hidden_from), this);
  }
  commit(static_.get(), go_on);
}

void RtScene::build_instanced_meshes(const std::vector<int>& static_objects, const GoOn& go_on) {
  std::unordered_set<int> wanted;
  for (const Object& object : scene_->objects) wanted.insert(object.mesh);
  for (const int i : static_objects) wanted.erase(scene_->objects[i].mesh);

  std::unordered_map<const Mesh*, Instanced> kept;
  std::vector<Instanced*> dirty;
  for (const int index : wanted) {
    check(go_on);
    const std::shared_ptr<const Mesh>& mesh = scene_->meshes[index];
    const std::vector<bool>& slots = filtered_slots_[index];
    const auto known = instanced_.find(mesh.get());
    if (known != instanced_.end() && known->second.filtered_slots == slots) {
      kept.insert(instanced_.extract(known));
    } else {
      const auto [entry, is_new] =
          kept.try_emplace(mesh.get(), Instanced{mesh, slots, RtMesh(mesh, slots, nullptr), {}});
      if (is_new) dirty.push_back(&entry->second);
    }
  }
  instanced_ = std::move(kept);
  tbb::parallel_for(size_t{0}, dirty.size(), [&](size_t i) {
    dirty[i]->scene = new_scene(device_);
    dirty[i]->geometry.attach(device_, dirty[i]->scene.get(), 0, kAllRays, this);
    commit(dirty[i]->scene.get(), go_on);
  });
}

void RtScene::build_top(const std::vector<int>& static_objects, const GoOn& go_on) {
  top_.reset();
  instances_.assign(1, {kNone, nullptr});
  if (static_objects.size() == scene_->objects.size()) return;
  top_ = new_scene(device_);
  attach_instance(device_, top_.get(), static_.get(), mat4x3(1.0f), kAllRays, 0);
  const std::unordered_set<int> in_static(static_objects.begin(), static_objects.end());
  for (size_t i = 0; i < scene_->objects.size(); ++i) {
    if (in_static.contains(static_cast<int>(i))) continue;
    check(go_on);
    const Object& object = scene_->objects[i];
    const Instanced& mesh = instanced_.at(scene_->meshes[object.mesh].get());
    attach_instance(device_, top_.get(), mesh.scene.get(), object.world_from_object,
                    ray_mask(object.hidden_from), static_cast<unsigned>(instances_.size()));
    instances_.push_back({static_cast<int>(i), &mesh.geometry});
  }
  commit(top_.get(), go_on);
}

}  // namespace kestrel
