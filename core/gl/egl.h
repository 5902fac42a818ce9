// SPDX-License-Identifier: GPL-3.0-or-later
// EGL without a window system: which devices there are, and a surfaceless OpenGL 4.5 context.
#pragma once

#include <epoxy/egl.h>

#include <string>
#include <vector>

namespace kestrel::gl {

/// Opens the EGL and OpenGL libraries, which epoxy needs and would end the process without.
/// Throws Error(unsupported) that names the missing library; always where KESTREL_NO_GL=1.
void require_libraries();

struct EglDevice {
  EGLDeviceEXT handle = nullptr;
  bool software = false;   // EGL_MESA_device_software: the processor draws
  bool accessible = true;  // false: its render node exists but this user may not open it
};

/// Every device in EGL's order; empty where EGL cannot enumerate. Loads no driver.
std::vector<EglDevice> egl_devices();

/// The value of KESTREL_EGL_DEVICE, or -1 where it is not set. Throws Error(invalid_argument)
/// where it is no number in [0, device_count).
int chosen_egl_device(int device_count);

/// An OpenGL 4.5 core context, current on no thread until asked.
class EglContext {
 public:
  /// Takes KESTREL_EGL_DEVICE, else the first hardware device that works, else a software one,
  /// else the surfaceless platform. Throws Error(unsupported) with every reason.
  explicit EglContext(bool debug);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Binds the context to the calling thread, without surfaces.
  void make_current();

  /// "EGL device 0" or "surfaceless platform".
  const std::string& source() const { return source_; }

 private:
  // The display stays initialised: EGL gives one display per device and process, which the host
  // may use too.
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string source_;
};

}  // namespace kestrel::gl
