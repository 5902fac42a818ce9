// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/shadow_queue.h"

#include <chrono>

namespace kestrel {

void ShadowQueue::push(const vec3& origin, const vec3& direction, float distance,
                       const Task& task) {
  const size_t lane = tasks_.size() % embree::kPacket;
  if (lane == 0) packets_.emplace_back();
  embree::set_ray(packets_.back(), lane, origin, direction, 0.0f, distance, kShadowRays,
                  tasks_.size());
  tasks_.push_back(task);
}

double ShadowQueue::trace(const RtScene& scene) {
  if (states_.size() < tasks_.size()) states_.resize(tasks_.size());
  for (size_t i = 0; i < tasks_.size(); ++i) states_[i].reset();
  const auto begin = std::chrono::steady_clock::now();
  embree::ShadowQuery query(states_.data());
  for (size_t p = 0; p < packets_.size(); ++p) {
    const embree::ValidLanes valid(tasks_.size() - embree::kPacket * p);
    embree::occluded(scene.handle(), query, valid.mask, packets_[p]);
  }
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
      .count();
}

}  // namespace kestrel
