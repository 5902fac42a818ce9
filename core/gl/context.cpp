// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/context.h"

#include <epoxy/gl.h>

#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "gl/debug.h"
#include "gl/egl.h"

namespace kestrel::gl {
namespace {

std::string gl_text(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "";
}

bool names_software(std::string_view renderer) {
  for (const char* name :
       {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software Rasterizer"}) {
    if (renderer.find(name) != renderer.npos) return true;
  }
  return false;
}

DeviceInfo query_info() {
  DeviceInfo info{gl_text(GL_VENDOR), gl_text(GL_RENDERER), gl_text(GL_VERSION)};
  info.software = names_software(info.renderer);
  return info;
}

bool environment_is_true(const char* name) {
  const char* text = std::getenv(name);
  return text && (std::strcmp(text, "1") == 0 || std::strcmp(text, "true") == 0);
}

}  // namespace

struct Context::Impl {
  DeviceInfo info;
  std::mutex mutex;
  std::condition_variable wake;
  std::deque<std::packaged_task<void()>> queue;
  bool closing = false;
  std::thread thread;

  /// The GL thread: owns the context from its first line to its last.
  void serve(std::promise<void> started) {
    std::optional<EglContext> egl;
    try {
      egl.emplace(log::enabled(log::Level::debug));
      egl->make_current();
      install_debug_output();
      info = query_info();
      log::info("OpenGL: {} ({}, {}) on {}", info.renderer, info.vendor, info.version,
                egl->source());
    } catch (...) {
      egl.reset();
      started.set_exception(std::current_exception());
      return;
    }
    started.set_value();
    work_until_closed();
  }

  void work_until_closed() {
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [this] { return closing || !queue.empty(); });
      if (queue.empty()) return;
      std::packaged_task<void()> task = std::move(queue.front());
      queue.pop_front();
      lock.unlock();
      task();
      lock.lock();
    }
  }
};

Context::Context() : impl_(std::make_unique<Impl>()) {
  std::promise<void> started;
  std::future<void> ready = started.get_future();
  impl_->thread = std::thread(&Impl::serve, impl_.get(), std::move(started));
  try {
    ready.get();
  } catch (...) {
    impl_->thread.join();
    throw;
  }
}

Context::~Context() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->closing = true;
  }
  impl_->wake.notify_one();
  impl_->thread.join();
}

void Context::run(const std::function<void()>& work) {
  if (std::this_thread::get_id() == impl_->thread.get_id()) return work();
  std::packaged_task<void()> task(work);
  std::future<void> done = task.get_future();
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->queue.push_back(std::move(task));
  }
  impl_->wake.notify_one();
  done.get();
}

const DeviceInfo& Context::info() const {
  return impl_->info;
}

bool hardware_available() {
  try {
    require_libraries();
    if (environment_is_true("LIBGL_ALWAYS_SOFTWARE")) return false;
    const std::vector<EglDevice> devices = egl_devices();
    const int chosen = chosen_egl_device(static_cast<int>(devices.size()));
    if (chosen >= 0) return !devices[chosen].software && devices[chosen].accessible;
    for (const EglDevice& device : devices) {
      if (!device.software && device.accessible) return true;
    }
  } catch (const Error& error) {
    log::debug("No OpenGL hardware: {}", error.what());
  }
  return false;
}

}  // namespace kestrel::gl
