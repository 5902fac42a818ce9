// SPDX-License-Identifier: GPL-3.0-or-later
// libkestrel_oiio.so: the table of functions, and the border that no exception crosses.
#include "images/oiio_plugin.h"

#include <exception>
#include <new>

namespace kestrel::oiio {

std::string tidy(const std::string& message, const char* fallback) {
  std::string text = message.substr(0, message.find('\n'));
  while (!text.empty() && (text.back() == '.' || text.back() == ' ' || text.back() == '\r')) {
    text.pop_back();
  }
  return text.empty() ? fallback : text;
}

namespace {

/// Runs `work`; null, or the text of what it threw.
template <typename Work>
const char* reason_of(Work&& work) noexcept {
  thread_local std::string reason;
  try {
    work();
    return nullptr;
  } catch (const std::bad_alloc&) {
    return "not enough memory";
  } catch (const std::exception& e) {
    try {
      reason = e.what();
      return reason.c_str();
    } catch (...) {
      return "not enough memory";
    }
  } catch (...) {
    return "unknown failure in OpenImageIO";
  }
}

const char* read_file_c(const char* path, KestrelPluginImage* image) {
  return reason_of([&] { read_file(path, *image); });
}

const char* read_memory_c(const void* data, size_t byte_count, KestrelPluginImage* image) {
  return reason_of([&] { read_memory(data, byte_count, *image); });
}

const char* write_file_c(const char* path, const KestrelPluginPicture* picture) {
  return reason_of([&] { write_file(path, *picture); });
}

}  // namespace
}  // namespace kestrel::oiio

extern "C" __attribute__((visibility("default"))) const KestrelImagePlugin* kestrel_image_plugin() {
  static const KestrelImagePlugin table = {
      KESTREL_IMAGE_PLUGIN_ABI,     "OpenImageIO " OIIO_VERSION_STRING, kestrel::oiio::read_file_c,
      kestrel::oiio::read_memory_c, kestrel::oiio::write_file_c,
  };
  return &table;
}
