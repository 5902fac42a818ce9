// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/embree_handles.h"

#include "base/error.h"
#include "base/log.h"

namespace kestrel::embree {
namespace {

void report_error(void*, RTCError code, const char* text) {
  if (code == RTC_ERROR_CANCELLED) return;  // as was asked for
  log::warning("Embree error {}: {}", static_cast<int>(code), text ? text : "");
}

}  // namespace

DeviceHandle new_device() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (!device) {
    fail(ErrorCode::unknown, "Embree could not start (error {}). It needs a processor with SSE2.",
         static_cast<int>(rtcGetDeviceError(nullptr)));
  }
  rtcSetDeviceErrorFunction(device, report_error, nullptr);
  if (!rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED)) {
    log::warning_once(
        "This Embree was built without EMBREE_RAY_MASK: objects that should be hidden from some "
        "rays are seen by all. Use an Embree that has it.");
  }
  return DeviceHandle(device);
}

void check_device(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_CANCELLED) fail(ErrorCode::cancelled, "The render was cancelled.");
  fail(error == RTC_ERROR_OUT_OF_MEMORY ? ErrorCode::out_of_memory : ErrorCode::unknown,
       "Embree could not build the scene (error {}). Try a scene with fewer triangles.",
       static_cast<int>(error));
}

}  // namespace kestrel::embree
