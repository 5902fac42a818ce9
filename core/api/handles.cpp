// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/handles.h"

#include <atomic>

namespace kestrel::api {
namespace {

/// One sequence for all kinds, so that a scene's handle is never a renderer's.
uintptr_t new_token() {
  static std::atomic<uintptr_t> last{0x1000};
  return last += 16;
}

}  // namespace

template <typename Handle, typename State>
uintptr_t HandleTable<Handle, State>::next_token() {
  return new_token();
}

template class HandleTable<KestrelDevice, DeviceState>;
template class HandleTable<KestrelScene, SceneState>;
template class HandleTable<KestrelRenderer, RendererState>;

// Never destroyed: at the end of a process OpenGL's and TBB's threads may be gone already, and a
// host that forgot a handle must not crash there.
HandleTable<KestrelDevice, DeviceState>& devices() {
  static auto& table = *new HandleTable<KestrelDevice, DeviceState>("Device");
  return table;
}
HandleTable<KestrelScene, SceneState>& scenes() {
  static auto& table = *new HandleTable<KestrelScene, SceneState>("Scene");
  return table;
}
HandleTable<KestrelRenderer, RendererState>& renderers() {
  static auto& table = *new HandleTable<KestrelRenderer, RendererState>("Renderer");
  return table;
}

}  // namespace kestrel::api
