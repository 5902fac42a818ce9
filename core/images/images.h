// SPDX-License-Identifier: GPL-3.0-or-later
// Image files in and out, through the image plug-in.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace kestrel::images {

/// Version of the loaded plug-in, or the reason why there is none. Loads it on first use: from
/// KESTREL_IMAGE_PLUGIN, else libkestrel_oiio.so beside the library.
std::string plugin_version();
bool plugin_available();

/// Fills size and texels of `texture` (its name, srgb and sampling stay). Throws Error(file).
void read_file(const std::string& path, Texture& texture);
void read_memory(const void* data, size_t byte_count, Texture& texture);

struct Layer {
  std::string name;
  std::string channels;
  const float* pixels;
};

/// Writes .exr (all layers) or .png (the first layer, in sRGB). Throws Error(file).
void write_file(const std::string& path, int width, int height, const std::vector<Layer>& layers);

/// The one stand-in for every image that cannot be had: 1x1 magenta.
void fill_missing(Texture& texture);

}  // namespace kestrel::images
