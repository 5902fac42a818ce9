// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/errors.h"

#include <exception>
#include <new>
#include <string>

namespace kestrel::api {
namespace {

struct LastError {
  KestrelError code = KESTREL_ERROR_NONE;
  std::string text;
  std::string handed_out;  // what kestrelGetError() returned
};

LastError& last_error() {
  thread_local LastError error;
  return error;
}

KestrelError remember(ErrorCode code, const char* text) noexcept {
  LastError& error = last_error();
  error.code = static_cast<KestrelError>(code);
  try {
    error.text = text;
  } catch (...) {
    error.text.clear();  // the code alone must do
  }
  return error.code;
}

}  // namespace

KestrelError remember_exception() noexcept {
  try {
    throw;
  } catch (const Error& e) {
    return remember(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return remember(ErrorCode::out_of_memory,
                    "There is not enough memory. Make the scene or the picture smaller.");
  } catch (const std::exception& e) {
    return remember(ErrorCode::unknown, e.what());
  } catch (...) {
    return remember(ErrorCode::unknown, "An exception of unknown type was caught.");
  }
}

KestrelError take_error(const char** message) noexcept {
  LastError& error = last_error();
  error.handed_out.swap(error.text);
  error.text.clear();
  if (message) *message = error.handed_out.c_str();
  return std::exchange(error.code, KESTREL_ERROR_NONE);
}

}  // namespace kestrel::api
