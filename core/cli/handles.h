// SPDX-License-Identifier: GPL-3.0-or-later
// Owners of the C interface's handles.
#pragma once

#include <memory>
#include <type_traits>

#include "cli/scene_file.h"
#include "kestrel/kestrel.h"

namespace kestrel::cli {

template <auto release>
struct Release {
  template <typename T>
  void operator()(T* handle) const {
    release(handle);
  }
};

using DevicePtr =
    std::unique_ptr<std::remove_pointer_t<KestrelDevice>, Release<kestrelReleaseDevice>>;
using ScenePtr = std::unique_ptr<std::remove_pointer_t<KestrelScene>, Release<kestrelReleaseScene>>;
using RendererPtr =
    std::unique_ptr<std::remove_pointer_t<KestrelRenderer>, Release<kestrelReleaseRenderer>>;

/// The handle, or the library's reason as std::runtime_error where it is NULL.
template <typename Ptr>
Ptr owned(typename Ptr::pointer handle) {
  if (!handle) {
    const char* message = nullptr;
    kestrelGetError(&message);
    throw std::runtime_error(message ? message : "out of memory");
  }
  return Ptr(handle);
}

}  // namespace kestrel::cli
