// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/shadow_queue.h"

#include <chrono>

namespace kestrel {

void ShadowQueue::push(const vec3& origin, const vec3& direction, float distance,
                       const Task& task) {
  const size_t lane = tasks_.size() % 8;
  if (lane == 0) packets_.emplace_back();
  RTCRay8& packet = packets_.back();
  packet.org_x[lane] = origin.x;
  packet.org_y[lane] = origin.y;
  packet.org_z[lane] = origin.z;
  packet.dir_x[lane] = direction.x;
  packet.dir_y[lane] = direction.y;
  packet.dir_z[lane] = direction.z;
  packet.tnear[lane] = 0.0f;
  packet.tfar[lane] = distance;
  packet.time[lane] = 0.0f;
  packet.mask[lane] = ~0u;
  packet.id[lane] = static_cast<unsigned>(tasks_.size());
  packet.flags[lane] = 0;
  tasks_.push_back(task);
}

double ShadowQueue::trace(const RtScene& scene, bool coherent) {
  states_.assign(tasks_.size(), embree::ShadowState());
  const auto begin = std::chrono::steady_clock::now();
  embree::ShadowQuery query(coherent, states_.data());
  for (size_t p = 0; p < packets_.size(); ++p) {
    alignas(32) int valid[8];
    for (size_t lane = 0; lane < 8; ++lane) valid[lane] = 8 * p + lane < tasks_.size() ? -1 : 0;
    embree::occluded8(scene.handle(), query, valid, packets_[p]);
  }
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

}  // namespace kestrel
