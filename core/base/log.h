// SPDX-License-Identifier: GPL-3.0-or-later
// One log for the process: to a callback where the host set one, else to standard error.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace kestrel::log {

enum class Level : int { debug = 0, info = 1, warning = 2, error = 3 };

using Sink = std::function<void(Level, std::string_view)>;

/// Replaces where messages go; an empty sink restores standard error. Thread-safe.
void set_sink(Sink sink);

/// Messages below this are dropped. Starts from KESTREL_LOG=debug|info|warning|error (else
/// warning).
void set_level(Level level);
bool enabled(Level level);

void write(Level level, std::string_view text);

/// Writes only the first time this `key` is seen in the process.
void write_once(Level level, std::string_view key, std::string_view text);

template <typename... Args>
void debug(fmt::format_string<Args...> format, Args&&... args) {
  if (enabled(Level::debug)) write(Level::debug, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void info(fmt::format_string<Args...> format, Args&&... args) {
  if (enabled(Level::info)) write(Level::info, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void warning(fmt::format_string<Args...> format, Args&&... args) {
  write(Level::warning, fmt::format(format, std::forward<Args>(args)...));
}
/// A warning about a fallback: said once for each distinct text.
template <typename... Args>
void warning_once(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  write_once(Level::warning, text, text);
}

}  // namespace kestrel::log
