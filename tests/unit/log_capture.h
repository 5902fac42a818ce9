// SPDX-License-Identifier: GPL-3.0-or-later
// Collects log messages while it lives.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "base/log.h"

namespace kestrel::test {

class LogCapture {
 public:
  LogCapture() {
    log::set_level(log::Level::warning);
    log::set_sink([this](log::Level, std::string_view text) {
      const std::lock_guard lock(mutex_);
      messages_.emplace_back(text);
    });
  }
  ~LogCapture() { log::set_sink({}); }

  std::vector<std::string> messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  /// How many messages hold `text`.
  int count(std::string_view text) const {
    int found = 0;
    for (const std::string& message : messages()) found += message.find(text) != message.npos;
    return found;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

}  // namespace kestrel::test
