// SPDX-License-Identifier: GPL-3.0-or-later
// Inside the image plug-in: what its reader and its writer share.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <string>

#include "images/image_plugin.h"

namespace kestrel::oiio {

/// The first line of an OpenImageIO message, without its full stop; `fallback` where it is empty.
std::string tidy(const std::string& message, const char* fallback);

/// Both throw std::runtime_error with the reason.
void read_file(const char* path, KestrelPluginImage& image);
void read_memory(const void* data, size_t byte_count, KestrelPluginImage& image);

/// Throws std::runtime_error with the reason; then the file is as it was before.
void write_file(const char* path, const KestrelPluginPicture& picture);

}  // namespace kestrel::oiio
