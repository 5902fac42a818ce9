// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "tracers/embree/embree_api.h"

namespace kestrel::embree {

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

/// Throws what the device met on this thread since the last check; Error(cancelled) where a build
/// was.
void check_device(RTCDevice device);

}  // namespace kestrel::embree
