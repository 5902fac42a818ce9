// SPDX-License-Identifier: GPL-3.0-or-later
// The table of C functions that libkestrel_oiio.so exports as `kestrel_image_plugin`. The library
// loads it at run time from its own folder, so that it does not depend on OpenImageIO itself.
#pragma once

#include <stddef.h>
#include <stdint.h>

extern "C" {

#define KESTREL_IMAGE_PLUGIN_ABI 3

/// A decoded image. Row 0 at the bottom, straight alpha; 8-bit texels where the file has 8 bits a
/// channel, else float; both as stored, without colour conversion.
struct KestrelPluginImage {
  /// Set by the host: memory for `count` values, uint8_t or float; null where there is none. The
  /// texels are the host's, also after a failure.
  void* (*allocate)(void* host, size_t count, int is_float);
  void* host;

  int width;
  int height;
  int channels;  // 4: RGBA; 3: RGB, of 8-bit files without alpha
  int is_float;  // what was allocated
  int encoded;   // 1: the floats come from integers (16-bit PNG) and may be sRGB-encoded;
                 // 0: scene-linear (EXR, HDR)
};

/// Files larger than this on a side are refused.
#define KESTREL_IMAGE_MAX_SIDE 32768

/// One layer to write; channels interleaved, row 0 at the bottom.
struct KestrelPluginLayer {
  const char* name;      // "Combined"
  const char* channels;  // one letter each
  const float* pixels;   // linear; alpha associated (premultiplied)
};

/// Text that goes with the layers.
struct KestrelPluginAttribute {
  const char* name;
  const char* value;
};

struct KestrelPluginPicture {
  int width;
  int height;
  const struct KestrelPluginLayer* layers;
  size_t layer_count;
  const struct KestrelPluginAttribute* attributes;
  size_t attribute_count;
};

struct KestrelImagePlugin {
  int abi;              // KESTREL_IMAGE_PLUGIN_ABI
  const char* version;  // "OpenImageIO 2.4.7"

  /// Both return null, or a text with the reason (valid until the next call on the thread).
  const char* (*read_file)(const char* path, struct KestrelPluginImage* image);
  const char* (*read_memory)(const void* data, size_t byte_count, struct KestrelPluginImage* image);

  /// .exr: all layers in one part, channels NAME.LETTER (Combined as plain R, G, B, A), half float
  /// except what counts, measures or names something, ZIP; the attributes; .png: the first layer,
  /// sRGB, 8 bits, straight alpha. No metadata of the machine. The file appears whole or not at
  /// all.
  const char* (*write_file)(const char* path, const struct KestrelPluginPicture* picture);
};

typedef const struct KestrelImagePlugin* (*KestrelImagePluginFunction)(void);

}  // extern "C"
