// SPDX-License-Identifier: GPL-3.0-or-later
// The scene in Embree. Objects that share a mesh instance it; all others lie, in world space, in
// one static part, which is faster to trace. An object that moves becomes an instance, so that
// moving it again does not rebuild the static part.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "scene/rt_mesh.h"
#include "scene/scene.h"
#include "shading/surface.h"
#include "tracers/embree/embree_handles.h"

namespace kestrel {

class RtScene {
 public:
  /// `device` must outlive the scene.
  explicit RtScene(RTCDevice device) : device_(device) {}

  /// Asked now and then, from any thread, whether to go on.
  using GoOn = std::function<bool()>;

  /// Builds what differs from the last scene; meshes are compared by identity. Throws
  /// Error(cancelled) where `go_on` said no; the next update then builds everything.
  void update(const std::shared_ptr<const Scene>& scene, const GoOn& go_on = {});

  RTCScene handle() const { return top_ ? top_.get() : static_.get(); }
  const Scene& scene() const { return *scene_; }

  /// Which surface Embree's ids mean.
  SurfaceHit resolve(unsigned instance, unsigned geometry, unsigned primitive,
                     const vec2& barycentric) const;

  /// Inverse transpose of every object's matrix.
  std::span<const mat3> normal_from_object() const { return normal_from_object_; }

 private:
  /// An object of the static part as it was built.
  struct StaticObject {
    std::shared_ptr<const Mesh> mesh;
    mat4x3 world_from_object;
    std::vector<bool> filtered_slots;
    uint8_t hidden_from;
    bool operator==(const StaticObject&) const = default;
  };
  struct Instanced {
    std::shared_ptr<const Mesh> mesh;
    std::vector<bool> filtered_slots;
    RtMesh geometry;
    embree::SceneHandle scene;
  };

  void build(const GoOn& go_on);
  void forget();
  void check(const GoOn& go_on) const;
  void commit(RTCScene scene, const GoOn& go_on);
  void inspect_meshes();
  std::vector<int> choose_static_objects();
  void build_static(const std::vector<int>& objects, const GoOn& go_on);
  void build_instanced_meshes(const std::vector<int>& static_objects, const GoOn& go_on);
  void build_top(const std::vector<int>& static_objects, const GoOn& go_on);

  RTCDevice device_;
  std::shared_ptr<const Scene> scene_;
  std::vector<mat3> normal_from_object_;
  std::vector<int> users_;                         // objects by mesh
  std::vector<std::vector<bool>> filtered_slots_;  // by mesh and material slot

  embree::SceneHandle static_;
  std::vector<StaticObject> static_built_;
  std::vector<RtMesh> static_geometry_;  // parallel to static_built_
  std::vector<int> static_objects_;      // the same, as indices in Scene::objects
  std::unordered_map<std::string, mat4x3> last_transforms_;
  std::unordered_set<std::string> moving_;  // names of objects that moved once

  std::unordered_map<const Mesh*, Instanced> instanced_;
  embree::SceneHandle top_;  // null where everything is static
  struct Instance {
    int object;
    const RtMesh* geometry;
  };
  std::vector<Instance> instances_;  // by instance id; [0] is the static part
};

}  // namespace kestrel
