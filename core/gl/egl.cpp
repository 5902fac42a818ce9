// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/egl.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string_view>

#include "base/error.h"

namespace kestrel::gl {
namespace {

constexpr EGLint kDeviceLimit = 64;
// EGL_DRM_RENDER_NODE_FILE_EXT, which older headers lack.
constexpr EGLint kDrmRenderNodeFile = 0x3377;

bool open_library(std::initializer_list<const char*> names) {
  // Kept open on purpose: epoxy holds the same libraries until the process ends.
  return std::any_of(names.begin(), names.end(),
                     [](const char* name) { return dlopen(name, RTLD_LAZY | RTLD_LOCAL); });
}

bool has_extension(const char* list, std::string_view name) {
  if (!list) return false;
  const std::string_view text(list);
  for (size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
    const size_t end = at + name.size();
    const bool starts = at == 0 || text[at - 1] == ' ';
    if (starts && (end == text.size() || text[end] == ' ')) return true;
  }
  return false;
}

template <typename Function>
Function egl_function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool may_open(const char* render_node) {
  return !render_node || access(render_node, R_OK | W_OK) == 0;
}

const char* egl_error_name() {
  switch (eglGetError()) {
    case EGL_SUCCESS:
      return "no EGL error";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    default:
      return "another EGL error";
  }
}

EGLDisplay platform_display(EGLenum platform, void* native) {
  const auto get = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  return get ? get(platform, native, nullptr) : EGL_NO_DISPLAY;
}

/// Any config that OpenGL can render with; EGL_NO_CONFIG_KHR where the display needs none.
EGLConfig choose_config(EGLDisplay display) {
  if (has_extension(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_no_config_context")) {
    return EGL_NO_CONFIG_KHR;
  }
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  eglChooseConfig(display, wanted, &config, 1, &count);
  return config;
}

/// The context, or EGL_NO_CONTEXT with the reason in `why`.
EGLContext create_context(EGLDisplay display, bool debug, std::string& why) {
  if (display == EGL_NO_DISPLAY) {
    why = "no display";
    return EGL_NO_CONTEXT;
  }
  if (!eglInitialize(display, nullptr, nullptr)) {
    why = fmt::format("eglInitialize: {}", egl_error_name());
    return EGL_NO_CONTEXT;
  }
  if (!has_extension(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
    why = "no EGL_KHR_surfaceless_context";
    return EGL_NO_CONTEXT;
  }
  if (!eglBindAPI(EGL_OPENGL_API)) {
    why = "no desktop OpenGL";
    return EGL_NO_CONTEXT;
  }
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_CONTEXT_OPENGL_DEBUG,
                               debug ? EGL_TRUE : EGL_FALSE,
                               EGL_NONE};
  const EGLContext context =
      eglCreateContext(display, choose_config(display), EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) {
    why = fmt::format("OpenGL 4.5 core: {}", egl_error_name());
  }
  return context;
}

/// Device indices in the order to try: the chosen one alone, else hardware before software.
std::vector<int> order_to_try(const std::vector<EglDevice>& devices) {
  const int chosen = chosen_egl_device(static_cast<int>(devices.size()));
  if (chosen >= 0) return {chosen};
  std::vector<int> order(devices.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::stable_partition(order.begin(), order.end(), [&](int i) { return !devices[i].software; });
  return order;
}

}  // namespace

void require_libraries() {
  const char* disabled = std::getenv("KESTREL_NO_GL");
  if (disabled && std::strcmp(disabled, "1") == 0) {
    fail(ErrorCode::unsupported,
         "OpenGL is switched off by KESTREL_NO_GL=1; unset it, or render with primary=rays.");
  }
  if (!open_library({"libEGL.so.1"})) {
    fail(ErrorCode::unsupported,
         "libEGL.so.1 cannot be loaded; install libegl1 (or the graphics driver), or render with "
         "primary=rays.");
  }
  if (!open_library({"libOpenGL.so.0", "libGL.so.1"})) {
    fail(ErrorCode::unsupported,
         "Neither libOpenGL.so.0 nor libGL.so.1 can be loaded; install libopengl0 or libgl1, or "
         "render with primary=rays.");
  }
}

std::vector<EglDevice> egl_devices() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_extension(extensions, "EGL_EXT_device_base") &&
      !has_extension(extensions, "EGL_EXT_device_enumeration")) {
    return {};
  }
  const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  EGLDeviceEXT handles[kDeviceLimit];
  EGLint count = 0;
  if (!query || !query_string || !query(kDeviceLimit, handles, &count)) return {};

  std::vector<EglDevice> devices;
  for (EGLint i = 0; i < count; ++i) {
    const char* supported = query_string(handles[i], EGL_EXTENSIONS);
    EglDevice device{handles[i]};
    device.software = has_extension(supported, "EGL_MESA_device_software");
    if (!device.software && has_extension(supported, "EGL_EXT_device_drm_render_node")) {
      device.accessible = may_open(query_string(handles[i], kDrmRenderNodeFile));
    }
    devices.push_back(device);
  }
  return devices;
}

int chosen_egl_device(int device_count) {
  const char* text = std::getenv("KESTREL_EGL_DEVICE");
  if (!text || !*text) return -1;
  int index = -1;
  const char* end = text + std::strlen(text);
  const auto [stopped_at, error] = std::from_chars(text, end, index);
  if (error != std::errc() || stopped_at != end || index < 0 || index >= device_count) {
    fail(ErrorCode::invalid_argument,
         "KESTREL_EGL_DEVICE={} names no EGL device: there are {}, counted from 0.", text,
         device_count);
  }
  return index;
}

EglContext::EglContext(bool debug) {
  require_libraries();
  const std::vector<EglDevice> devices = egl_devices();
  std::string reasons, why;
  for (int i : order_to_try(devices)) {
    display_ = platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i].handle);
    context_ = create_context(display_, debug, why);
    source_ = fmt::format("EGL device {}", i);
    if (context_ != EGL_NO_CONTEXT) return;
    reasons += fmt::format("{}: {}; ", source_, why);
  }
  if (chosen_egl_device(static_cast<int>(devices.size())) < 0 &&
      has_extension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS),
                    "EGL_MESA_platform_surfaceless")) {
    display_ = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
    context_ = create_context(display_, debug, why);
    source_ = "surfaceless platform";
    if (context_ != EGL_NO_CONTEXT) return;
    reasons += fmt::format("{}: {}; ", source_, why);
  }
  fail(ErrorCode::unsupported,
       "No OpenGL 4.5 context without a window ({}{} EGL devices); install a driver such as Mesa "
       "(libegl-mesa0, libgl1-mesa-dri), or render with primary=rays.",
       reasons, devices.size());
}

EglContext::~EglContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglReleaseThread();
}

void EglContext::make_current() {
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    fail(ErrorCode::unsupported, "The {} gives no context without surfaces: {}.", source_,
         egl_error_name());
  }
}

}  // namespace kestrel::gl
