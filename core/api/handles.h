// SPDX-License-Identifier: GPL-3.0-or-later
// What stands behind the opaque handles. A handle is a number that is never used again, not an
// address: whatever a host passes is looked up, so a stale or mixed-up handle is an error.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "base/error.h"
#include "kestrel/kestrel.h"
#include "renderer.h"
#include "scene/scene_builder.h"

namespace kestrel::api {

struct DeviceState {
  std::shared_ptr<Device> device = std::make_shared<Device>();
  std::mutex mutex;
  std::string info;  // made on first request
};

struct SceneState {
  explicit SceneState(std::shared_ptr<DeviceState> d) : device(std::move(d)) {}

  const std::shared_ptr<DeviceState> device;
  std::mutex mutex;  // guards the builder
  SceneBuilder builder;
  std::atomic<bool> committing = false;
  std::atomic<bool> commit_cancelled = false;
  std::mutex published_mutex;  // apart, so that a frame need not wait for a long commit
  std::shared_ptr<const Scene> published;
};

struct RendererState {
  explicit RendererState(std::shared_ptr<SceneState> s)
      : scene(std::move(s)), renderer(scene->device->device) {}

  const std::shared_ptr<SceneState> scene;
  Renderer renderer;
  std::mutex mutex;        // guards what follows
  bool rendering = false;  // `renderer` belongs to the thread that renders
  int readers = 0;         // of the last frame; short, so a frame waits for them
  std::condition_variable readers_left;
  bool cancelled = false;
};

/// The live handles of one kind, each with the number of the host's references.
template <typename Handle, typename State>
class HandleTable {
 public:
  explicit HandleTable(const char* kind) : kind_(kind) {}

  Handle insert(std::shared_ptr<State> state) {
    const std::lock_guard lock(mutex_);
    const uintptr_t token = next_token();
    entries_.emplace(token, Entry{std::move(state), 1});
    return reinterpret_cast<Handle>(token);
  }

  /// Keeps the object alive for the caller. Throws Error(invalid_argument).
  std::shared_ptr<State> get(Handle handle) {
    const std::lock_guard lock(mutex_);
    return find(handle)->second.state;
  }

  void retain(Handle handle) {
    const std::lock_guard lock(mutex_);
    ++find(handle)->second.references;
  }

  void release(Handle handle) {
    if (!handle) return;
    std::shared_ptr<State> last;  // destroyed after the lock is gone
    const std::lock_guard lock(mutex_);
    const auto entry = find(handle);
    if (--entry->second.references > 0) return;
    last = std::move(entry->second.state);
    entries_.erase(entry);
  }

 private:
  struct Entry {
    std::shared_ptr<State> state;
    size_t references;
  };
  using Entries = std::unordered_map<uintptr_t, Entry>;

  static uintptr_t next_token();

  typename Entries::iterator find(Handle handle) {
    if (!handle) {
      fail(ErrorCode::invalid_argument, "The {} is NULL. Make one with kestrelNew{}().", kind_,
           kind_);
    }
    const auto entry = entries_.find(reinterpret_cast<uintptr_t>(handle));
    if (entry == entries_.end()) {
      fail(ErrorCode::invalid_argument,
           "This is no live handle of a {}. It was released, or is of another kind.", kind_);
    }
    return entry;
  }

  const char* kind_;
  std::mutex mutex_;
  Entries entries_;
};

HandleTable<KestrelDevice, DeviceState>& devices();
HandleTable<KestrelScene, SceneState>& scenes();
HandleTable<KestrelRenderer, RendererState>& renderers();

}  // namespace kestrel::api
