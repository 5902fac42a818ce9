// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace kestrel {

/// Why a call failed; the values are those of `KestrelError` in kestrel.h.
enum class ErrorCode : int {
  none = 0,
  unknown = 1,
  invalid_argument = 2,
  invalid_operation = 3,
  out_of_memory = 4,
  unsupported = 5,
  cancelled = 6,
  file = 7,
};

/// A failure that the user can do something about; the text names the cause and a remedy.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

template <typename... Args>
[[noreturn]] void fail(ErrorCode code, fmt::format_string<Args...> format, Args&&... args) {
  throw Error(code, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace kestrel
