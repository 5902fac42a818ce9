// SPDX-License-Identifier: GPL-3.0-or-later
// Image files out: encoded in memory, then written beside the target and renamed over it, so that
// a full disk or a killed process leaves no half file.
#include <OpenImageIO/filesystem.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "images/oiio_plugin.h"

namespace kestrel::oiio {
namespace {

using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr float kLargestHalf = 65504.0f;
constexpr int kRowsAtOnce = 64;  // a multiple of the 16 rows of a ZIP block in EXR

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Positions, depths and whatever counts or names something need all of a float's digits; colours
/// and directions do not.
bool needs_float(const KestrelPluginLayer& layer) {
  const std::string_view name = layer.name;
  const auto ends_with = [name](std::string_view end) {
    return name.size() >= end.size() && name.substr(name.size() - end.size()) == end;
  };
  return name == "UV" || name.find("Depth") != name.npos || name.find("Position") != name.npos ||
         name.substr(0, 6) == "Crypto" || ends_with("Id") || ends_with("Index");
}

std::string channel_name(const KestrelPluginLayer& layer, char letter) {
  if (std::string_view(layer.name) == "Combined") return std::string(1, letter);
  return std::string(layer.name) + "." + letter;
}

/// A writer into `memory`, of the format that the ending of `name` says.
std::unique_ptr<ImageOutput> open_writer(const char* name, const ImageSpec& spec,
                                         OIIO::Filesystem::IOVecOutput& memory) {
  auto output = ImageOutput::create(name);
  if (!output) throw std::runtime_error(tidy(OIIO::geterror(), "the format is not known"));
  if (!output->set_ioproxy(&memory) || !output->open(name, spec)) {
    throw std::runtime_error(tidy(output->geterror(), "the encoder did not start"));
  }
  return output;
}

void encode_rows(ImageOutput& output, const ImageSpec& spec, int first, int count, TypeDesc type,
                 const void* rows) {
  if (!output.write_scanlines(first, std::min(first + count, spec.height), 0, type, rows)) {
    throw std::runtime_error(tidy(output.geterror(), "the encoder failed"));
  }
}

void finish(ImageOutput& output) {
  if (!output.close()) throw std::runtime_error(tidy(output.geterror(), "the encoder failed"));
}

std::vector<unsigned char> encode_exr(const KestrelPluginPicture& picture) {
  const int width = picture.width, height = picture.height;
  const KestrelPluginLayer* layers = picture.layers;
  const size_t layer_count = picture.layer_count;
  ImageSpec spec(width, height, 0, TypeDesc::HALF);
  for (size_t i = 0; i < layer_count; ++i) {
    const TypeDesc type = needs_float(layers[i]) ? TypeDesc::FLOAT : TypeDesc::HALF;
    for (const char* letter = layers[i].channels; *letter; ++letter) {
      spec.channelnames.push_back(channel_name(layers[i], *letter));
      spec.channelformats.push_back(type);
      ++spec.nchannels;
    }
  }
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // else the writer puts the time there
  for (size_t i = 0; i < picture.attribute_count; ++i) {
    spec.attribute(picture.attributes[i].name, picture.attributes[i].value);
  }
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = open_writer("image.exr", spec, memory);
  const size_t stride = static_cast<size_t>(spec.nchannels);
  const size_t row_pixels = static_cast<size_t>(width);
  std::vector<float> rows(kRowsAtOnce * row_pixels * stride);
  for (int y = 0; y < height; y += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, height - y);
    size_t channel = 0;
    for (size_t i = 0; i < layer_count; ++i) {
      const size_t own = std::strlen(layers[i].channels);
      const bool half = !needs_float(layers[i]);
      for (int row = 0; row < count; ++row) {
        const float* from =
            layers[i].pixels + static_cast<size_t>(height - 1 - (y + row)) * row_pixels * own;
        float* to = rows.data() + static_cast<size_t>(row) * row_pixels * stride + channel;
        for (size_t x = 0; x < row_pixels; ++x, from += own, to += stride) {
          for (size_t c = 0; c < own; ++c) {
            to[c] = half ? std::clamp(from[c], -kLargestHalf, kLargestHalf) : from[c];
          }
        }
      }
      channel += own;
    }
    encode_rows(*output, spec, y, count, TypeDesc::FLOAT, rows.data());
  }
  finish(*output);
  return bytes;
}

/// Linear to 8-bit sRGB (IEC 61966-2-1); what is not a number becomes 0.
uint8_t srgb8(float v) {
  const float c = std::clamp(std::isnan(v) ? 0.0f : v, 0.0f, 1.0f);
  const float e = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
  return static_cast<uint8_t>(std::lround(255.0f * e));
}

/// One pixel of a layer of 1 (grey), 3 or 4 channels.
void encode_pixel(const float* from, size_t channels, uint8_t* to) {
  const bool has_alpha = channels == 4;
  const float alpha = has_alpha ? std::clamp(std::isnan(from[3]) ? 0.0f : from[3], 0.0f, 1.0f) : 1;
  for (size_t c = 0; c < std::min<size_t>(channels, 3); ++c) {
    to[c] = srgb8(alpha > 0.0f ? from[c] / alpha : from[c]);
  }
  if (has_alpha) to[3] = static_cast<uint8_t>(std::lround(255.0f * alpha));
}

std::vector<unsigned char> encode_png(int width, int height, const KestrelPluginLayer& layer) {
  const size_t channels = std::strlen(layer.channels);
  if (channels != 1 && channels != 3 && channels != 4) {
    throw std::runtime_error("PNG takes layers of 1, 3 or 4 channels; use .exr");
  }
  ImageSpec spec(width, height, static_cast<int>(channels), TypeDesc::UINT8);
  if (channels == 4) spec.alpha_channel = 3;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("oiio:ColorSpace", "sRGB");
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = open_writer("image.png", spec, memory);
  const size_t row_pixels = static_cast<size_t>(width);
  std::vector<uint8_t> rows(kRowsAtOnce * row_pixels * channels);
  for (int y = 0; y < height; y += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, height - y);
    for (int row = 0; row < count; ++row) {
      const float* from =
          layer.pixels + static_cast<size_t>(height - 1 - (y + row)) * row_pixels * channels;
      uint8_t* to = rows.data() + static_cast<size_t>(row) * row_pixels * channels;
      for (size_t x = 0; x < row_pixels; ++x, from += channels, to += channels) {
        encode_pixel(from, channels, to);
      }
    }
    encode_rows(*output, spec, y, count, TypeDesc::UINT8, rows.data());
  }
  finish(*output);
  return bytes;
}

[[noreturn]] void throw_errno(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

void write_all(int file, const std::vector<unsigned char>& bytes) {
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw_errno("writing failed");
    done += static_cast<size_t>(n);
  }
}

/// Where the bytes end up: links are followed, so that the link stays one.
std::string resolved(const std::string& path) {
  std::error_code error;
  const auto target = std::filesystem::canonical(path, error);
  return error ? path : target.string();
}

void save(const std::string& path, const std::vector<unsigned char>& bytes) {
  const std::string target = resolved(path);
  struct stat status {};
  const bool special = stat(target.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
  static std::atomic<unsigned> counter{0};
  const std::string beside =
      special ? target
              : target + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".part";
  const int flags = O_WRONLY | O_CLOEXEC | (special ? 0 : O_CREAT | O_EXCL);
  const int file = open(beside.c_str(), flags, 0666);
  if (file < 0) throw_errno("the file could not be opened");
  try {
    write_all(file, bytes);
    if (!special && fsync(file) != 0 && errno != EINVAL) throw_errno("writing failed");
  } catch (...) {
    ::close(file);
    if (!special) unlink(beside.c_str());
    throw;
  }
  if (::close(file) != 0 || (!special && rename(beside.c_str(), target.c_str()) != 0)) {
    const int error = errno;
    if (!special) unlink(beside.c_str());
    errno = error;
    throw_errno("writing failed");
  }
}

}  // namespace

void write_file(const char* path, const KestrelPluginPicture& picture) {
  if (picture.layer_count == 0) throw std::runtime_error("there is no layer to write");
  const std::string extension = lower_extension(path);
  if (extension == ".exr") {
    save(path, encode_exr(picture));
  } else if (extension == ".png") {
    save(path, encode_png(picture.width, picture.height, picture.layers[0]));
  } else {
    throw std::runtime_error("its ending '" + extension + "' is not known; use .exr or .png");
  }
}

}  // namespace kestrel::oiio
