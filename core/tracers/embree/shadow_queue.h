// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow rays, gathered and traced in packets.
#pragma once

#include <vector>

#include "scene/rt_scene.h"
#include "tracers/embree/shadow_query.h"

namespace kestrel {

class ShadowQueue {
 public:
  /// One ray: the light it stands for and where that light goes.
  struct Task {
    vec3 light;       // what arrives if nothing is in between
    uint32_t target;  // the caller's index
  };

  /// From `origin` to `distance` along `direction`; all in world space, metres.
  void push(const vec3& origin, const vec3& direction, float distance, const Task& task);

  /// Traces all, calls `receive(task, transmitted)` in the order of the pushes, and empties the
  /// queue. `transmitted` is the share of light left, per colour. Returns milliseconds in Embree.
  template <typename Receive>
  double resolve(const RtScene& scene, Receive&& receive) {
    const double ms = trace(scene);
    for (size_t i = 0; i < tasks_.size(); ++i) {
      const bool blocked = packets_[i / embree::kPacket].tfar[i % embree::kPacket] < 0.0f;
      receive(tasks_[i], blocked ? vec3(0.0f) : states_[i].transmitted);
    }
    packets_.clear();
    tasks_.clear();
    return ms;
  }

 private:
  double trace(const RtScene& scene);

  std::vector<embree::RayPacket> packets_;
  std::vector<Task> tasks_;
  std::vector<embree::ShadowState> states_;
};

}  // namespace kestrel
