// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/info.h>
#include <tbb/version.h>

#include <mutex>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/log.h"
#include "images/images.h"
#include "renderer.h"
#include "tracers/embree/embree_handles.h"

namespace kestrel {

struct Device::Impl {
  embree::DeviceHandle embree = embree::new_device();
  std::mutex gl_mutex;
  std::shared_ptr<gl::Context> gl;
  std::string gl_error;  // why there is none, once tried
};

Device::Device() : impl_(std::make_unique<Impl>()) {}
Device::~Device() = default;

RTCDevice Device::embree() const {
  return impl_->embree.get();
}

std::shared_ptr<gl::Context> Device::gl() {
  const std::lock_guard lock(impl_->gl_mutex);
  if (!impl_->gl_error.empty()) throw Error(ErrorCode::unsupported, impl_->gl_error);
  if (!impl_->gl) {
    try {
      impl_->gl = std::make_shared<gl::Context>();
    } catch (const Error& error) {
      impl_->gl_error = error.what();
      throw;
    }
  }
  return impl_->gl;
}

std::string Device::info_json() {
  const auto property = [this](RTCDeviceProperty p) { return rtcGetDeviceProperty(embree(), p); };
  nlohmann::ordered_json info;
  info["kestrel"] = KESTREL_VERSION;
  info["embree"] = fmt::format("{}.{}.{}", property(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                               property(RTC_DEVICE_PROPERTY_VERSION_MINOR),
                               property(RTC_DEVICE_PROPERTY_VERSION_PATCH));
  info["tbb"] = TBB_runtime_version();
  info["threads"] = tbb::info::default_concurrency();
  info["image_plugin"] = nullptr;
  if (images::plugin_available()) {
    info["image_plugin"] = images::plugin_version();
  } else {
    info["image_plugin_error"] = images::plugin_version();
  }
  info["gl"] = nullptr;
  try {
    const gl::DeviceInfo& device = gl()->info();
    info["gl"] = {{"vendor", device.vendor},
                  {"renderer", device.renderer},
                  {"version", device.version},
                  {"software", device.software}};
  } catch (const Error& error) {
    info["gl_error"] = error.what();
  }
  return info.dump();
}

}  // namespace kestrel
