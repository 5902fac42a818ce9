// SPDX-License-Identifier: GPL-3.0-or-later
// The scene in Embree: one bottom-level scene per mesh, one instance per object.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "scene/scene.h"
#include "tracers/embree/embree_api.h"

namespace kestrel {

namespace embree {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
using SceneHandle = std::unique_ptr<RTCSceneTy, ReleaseScene>;

/// A device whose errors go to the log. Throws Error(unknown) where Embree cannot start.
DeviceHandle new_device();

/// What a shadow ray has met so far.
struct ShadowState {
  /// A ray through an edge meets both triangles; the light is to be taken off once. Crossings of
  /// one object at practically the same distance count as one.
  static constexpr int kRemembered = 8;

  vec3 transmitted{1.0f};
  uint32_t crossings = 0;
  float distances[kRemembered];
  uint32_t objects[kRemembered];

  /// Whether this crossing is new; remembers it.
  bool enter(uint32_t object, float distance);
};

/// Query with what shadow rays need: their states, by RTCRay::id.
struct ShadowQuery : Query {
  ShadowState* states;
  ShadowQuery(bool coherent, ShadowState* states_by_id) : Query(coherent), states(states_by_id) {}
};

}  // namespace embree

class RtScene {
 public:
  /// `device` must outlive the scene.
  explicit RtScene(RTCDevice device) : device_(device) {}

  /// Builds what differs from the last scene; meshes are compared by identity.
  void update(const std::shared_ptr<const Scene>& scene);

  RTCScene handle() const { return top_.get(); }
  const Scene& scene() const { return *scene_; }

  /// Inverse transpose of an object's matrix.
  const mat3& normal_from_object(int object) const { return normal_from_object_[object]; }

 private:
  struct MeshEntry {
    embree::SceneHandle scene;
    RTCGeometry geometry = nullptr;  // owned by `scene`
    bool filtered = false;           // shadow or primary rays must look at its materials
    std::shared_ptr<const Mesh> mesh;
  };
  void build_meshes();
  void build_top();

  RTCDevice device_;
  std::shared_ptr<const Scene> scene_;
  std::unordered_map<const Mesh*, MeshEntry> meshes_;
  embree::SceneHandle top_;
  std::vector<mat3> normal_from_object_;
};

}  // namespace kestrel
