// SPDX-License-Identifier: GPL-3.0-or-later
// Exceptions become error codes here; none crosses the C interface.
#pragma once

#include <utility>

#include "base/error.h"
#include "kestrel/kestrel.h"

namespace kestrel::api {

/// Within a catch block: remembers the exception as this thread's last error.
KestrelError remember_exception() noexcept;

/// This thread's last error, which is then forgotten. The text lives until the next call.
KestrelError take_error(const char** message) noexcept;

/// Runs `work`; KESTREL_ERROR_NONE, or the code of what it threw.
template <typename Work>
KestrelError guarded(Work&& work) noexcept {
  try {
    std::forward<Work>(work)();
    return KESTREL_ERROR_NONE;
  } catch (...) {
    return remember_exception();
  }
}

/// The result of `work`, or `failure` where it threw.
template <typename Result, typename Work>
Result guarded_or(Result failure, Work&& work) noexcept {
  try {
    return std::forward<Work>(work)();
  } catch (...) {
    remember_exception();
    return failure;
  }
}

/// Throws Error(invalid_argument) naming the argument that is NULL.
template <typename T>
T* require(T* pointer, const char* argument) {
  if (!pointer) {
    fail(ErrorCode::invalid_argument, "The argument '{}' is NULL. Pass a valid pointer.", argument);
  }
  return pointer;
}

}  // namespace kestrel::api
