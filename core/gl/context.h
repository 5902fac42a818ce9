// SPDX-License-Identifier: GPL-3.0-or-later
// Kestrel's own OpenGL: a thread with a surfaceless EGL context, core profile 4.5. The host's
// contexts are never current on that thread, and ours never on the host's.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace kestrel::gl {

struct DeviceInfo {
  std::string vendor;
  std::string renderer;
  std::string version;
  bool software = false;  // llvmpipe and the like: rays on the processor are faster
};

class Context {
 public:
  /// Starts the thread and the context. Throws Error(unsupported) with the reason where EGL or
  /// OpenGL 4.5 is missing. KESTREL_EGL_DEVICE=N picks the N-th EGL device.
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Runs `work` on the GL thread, waits for it, and rethrows what it throws.
  void run(const std::function<void()>& work);

  const DeviceInfo& info() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether a device that is not software rendering exists. Cheap: no context is made and no
/// driver is loaded; false where EGL is missing.
bool hardware_available();

}  // namespace kestrel::gl
