// SPDX-License-Identifier: GPL-3.0-or-later
// Image files in and out, through the image plug-in.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace kestrel::images {

/// Version of the loaded plug-in, or the reason why there is none. It is loaded once, on first use:
/// from the path in KESTREL_IMAGE_PLUGIN, else libkestrel_oiio.so beside the library.
std::string plugin_version();
bool plugin_available();

/// Fills size and texels of `texture` (its name, srgb and sampling stay). 16-bit files become
/// linear floats: decoded from sRGB where `texture.srgb`. Throws Error(file), or Error(unsupported)
/// without the plug-in. Thread-safe.
void read_file(const std::string& path, Texture& texture);
void read_memory(const void* data, size_t byte_count, Texture& texture);

struct Layer {
  std::string name;
  std::string channels;
  const float* pixels;
};

/// Name and value.
using Attribute = std::pair<std::string, std::string>;

/// Writes .exr (all layers and attributes) or .png (the first layer, in sRGB), whole or not at all.
/// Throws Error(file), or Error(unsupported) without the plug-in.
void write_file(const std::string& path, int width, int height, const std::vector<Layer>& layers,
                const std::vector<Attribute>& attributes = {});

/// The one stand-in for every image that cannot be had: 1x1 magenta, opaque.
void fill_missing(Texture& texture);

}  // namespace kestrel::images
