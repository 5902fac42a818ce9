// SPDX-License-Identifier: GPL-3.0-or-later
// kestrel.h: library and device.
#include <cstring>
#include <mutex>
#include <shared_mutex>
#include <string>

#include "api/errors.h"
#include "api/handles.h"
#include "base/hash.h"
#include "base/log.h"
#include "params/params.h"
#include "shading/node_table.h"

using namespace kestrel;
using namespace kestrel::api;

namespace {

/// Shared while a callback runs, exclusive while it is replaced.
std::shared_mutex& log_mutex() {
  static auto& mutex = *new std::shared_mutex;
  return mutex;
}

thread_local bool inside_log_callback = false;

struct InsideLogCallback {
  InsideLogCallback() { inside_log_callback = true; }
  ~InsideLogCallback() { inside_log_callback = false; }
};

struct LogTarget {
  KestrelLogCallback callback = nullptr;
  void* user = nullptr;
} log_target;  // guarded by log_mutex()

/// A callback that itself logs is not called again: its message goes nowhere.
void send_to_callback(log::Level level, std::string_view text) {
  if (inside_log_callback) return;
  const std::shared_lock lock(log_mutex());
  if (!log_target.callback) return;
  const InsideLogCallback inside;
  log_target.callback(log_target.user, static_cast<KestrelLogLevel>(level),
                      std::string(text).c_str());
}

}  // namespace

const char* kestrelGetVersion(void) {
  return KESTREL_VERSION;
}

uint32_t kestrelGetAbiVersion(void) {
  return KESTREL_ABI_VERSION;
}

KestrelError kestrelGetError(const char** message) {
  return take_error(message);
}

void kestrelSetLogCallback(KestrelLogCallback callback, void* user) {
  guarded([&] {
    if (inside_log_callback) {
      fail(ErrorCode::invalid_operation,
           "A log callback cannot replace itself. Call kestrelSetLogCallback() elsewhere.");
    }
    const std::unique_lock lock(log_mutex());
    log_target = {callback, user};
    log::set_sink(callback ? log::Sink(send_to_callback) : log::Sink());
  });
}

void kestrelSetLogLevel(KestrelLogLevel level) {
  guarded([&] {
    int32_t value;  // copied as bytes: a host may pass what the enumeration does not hold
    std::memcpy(&value, &level, sizeof(value));
    if (value < KESTREL_LOG_DEBUG || value > KESTREL_LOG_ERROR) {
      fail(ErrorCode::invalid_argument, "{} is no KestrelLogLevel. Use 0 (debug) to 3 (error).",
           value);
    }
    log::set_level(static_cast<log::Level>(value));
  });
}

const char* kestrelGetParameterTable(void) {
  return guarded_or("[]", [] {
    static const auto& table = *new std::string(parameter_table_json());
    return table.c_str();
  });
}

const char* kestrelGetNodeTable(void) {
  return guarded_or("{}", [] {
    static const auto& table = *new std::string(node_table_json());
    return table.c_str();
  });
}

KestrelError kestrelHash(const void* data, size_t byte_count, uint64_t hash[2]) {
  return guarded([&] {
    require(hash, "hash");
    const auto* bytes = static_cast<const uint8_t*>(byte_count ? require(data, "data") : nullptr);
    const Hash128 result = hash_bytes({bytes, byte_count}, {hash[0], hash[1]});
    hash[0] = result.low;
    hash[1] = result.high;
  });
}

KestrelDevice kestrelNewDevice(void) {
  return guarded_or(KestrelDevice{nullptr},
                    [] { return devices().insert(std::make_shared<DeviceState>()); });
}

void kestrelRetainDevice(KestrelDevice device) {
  guarded([&] { devices().retain(device); });
}

void kestrelReleaseDevice(KestrelDevice device) {
  guarded([&] { devices().release(device); });
}

const char* kestrelGetDeviceInfo(KestrelDevice device) {
  return guarded_or(static_cast<const char*>(nullptr), [&] {
    const auto state = devices().get(device);
    const std::lock_guard lock(state->mutex);
    if (state->info.empty()) state->info = state->device->info_json();
    return state->info.c_str();
  });
}
