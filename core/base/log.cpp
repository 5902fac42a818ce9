// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>

namespace kestrel::log {
namespace {

Level level_from_environment() {
  const char* text = std::getenv("KESTREL_LOG");
  const std::string_view name = text ? text : "";
  if (name == "debug") return Level::debug;
  if (name == "info") return Level::info;
  if (name == "error") return Level::error;
  return Level::warning;
}

struct State {
  std::mutex mutex;
  Sink sink;
  std::set<std::string, std::less<>> seen;
  std::atomic<Level> level{level_from_environment()};
};

State& state() {
  static State instance;
  return instance;
}

}  // namespace

void set_sink(Sink sink) {
  const std::lock_guard lock(state().mutex);
  state().sink = std::move(sink);
}

void set_level(Level level) {
  state().level = level;
}

bool enabled(Level level) {
  return level >= state().level.load(std::memory_order_relaxed);
}

void write(Level level, std::string_view text) {
  if (!enabled(level)) return;
  Sink sink;
  {
    const std::lock_guard lock(state().mutex);
    sink = state().sink;
  }
  if (sink) {
    sink(level, text);
    return;
  }
  static constexpr const char* kNames[] = {"debug", "info", "warning", "error"};
  fmt::print(stderr, "kestrel {}: {}\n", kNames[static_cast<int>(level)], text);
}

void write_once(Level level, std::string_view key, std::string_view text) {
  {
    const std::lock_guard lock(state().mutex);
    if (!state().seen.emplace(key).second) return;
  }
  write(level, text);
}

}  // namespace kestrel::log
