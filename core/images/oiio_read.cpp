// SPDX-License-Identifier: GPL-3.0-or-later
// Image files in: any format of OpenImageIO to RGB or RGBA with straight alpha, row 0 at the
// bottom.
#include <OpenImageIO/filesystem.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <vector>

#include "images/oiio_plugin.h"

namespace kestrel::oiio {
namespace {

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Which channels of the file become red, green, blue and alpha; -1: none.
struct Channels {
  int rgba[4] = {-1, -1, -1, -1};

  int first() const {
    int lowest = -1;
    for (const int c : rgba) {
      if (c >= 0 && (lowest < 0 || c < lowest)) lowest = c;
    }
    return lowest;
  }
  int last() const { return *std::max_element(rgba, rgba + 4); }
};

/// Channels named R, G, B and A of the first layer that has an R ("ViewLayer.Combined.R"); else
/// the first ones, a single one being grey.
Channels find_channels(const ImageSpec& spec) {
  const auto find = [&](std::string_view name) {
    const auto& names = spec.channelnames;
    const auto it = std::find(names.begin(), names.end(), name);
    return it == names.end() ? -1 : static_cast<int>(it - names.begin());
  };
  Channels out;
  for (const std::string& name : spec.channelnames) {
    const size_t dot = name.rfind('.');
    const std::string letter = dot == std::string::npos ? name : name.substr(dot + 1);
    if (letter != "R") continue;
    const std::string layer = name.substr(0, name.size() - 1);
    const char* const letters[] = {"R", "G", "B", "A"};
    for (int i = 0; i < 4; ++i) out.rgba[i] = find(layer + letters[i]);
    if (out.rgba[1] < 0 && out.rgba[2] < 0) out.rgba[1] = out.rgba[2] = out.rgba[0];
    return out;
  }
  std::vector<int> colors;
  for (int c = 0; c < spec.nchannels && colors.size() < 3; ++c) {
    if (c != spec.alpha_channel) colors.push_back(c);
  }
  if (colors.size() == 1) colors.assign(3, colors[0]);
  std::copy(colors.begin(), colors.end(), out.rgba);
  out.rgba[3] = spec.alpha_channel;
  return out;
}

void check_size(const ImageSpec& spec) {
  constexpr int kMax = KESTREL_IMAGE_MAX_SIDE;
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) {
    throw std::runtime_error("the image is empty");
  }
  if (spec.width > kMax || spec.height > kMax) {
    throw std::runtime_error("the image is " + std::to_string(spec.width) + " x " +
                             std::to_string(spec.height) + " pixels; at most " +
                             std::to_string(kMax) + " on a side are supported, so scale it down");
  }
  if (spec.deep || spec.depth > 1) {
    throw std::runtime_error("deep and volume images are no textures; save it as a flat image");
  }
}

template <typename T>
T* allocate(KestrelPluginImage& image, size_t count) {
  image.is_float = std::is_same_v<T, float>;
  void* memory = image.allocate(image.host, count, image.is_float);
  if (!memory) throw std::bad_alloc();
  return static_cast<T*>(memory);
}

float encoded_from_linear(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}
float linear_from_encoded(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// How colour and alpha are bound in what OpenImageIO hands over.
enum class Alpha {
  straight,
  associated,         // multiplied as stored
  associated_linear,  // 8-bit sRGB, multiplied in linear light
};

/// Only these readers hand over colours multiplied by alpha although asked not to: EXR and TIFF
/// where the file is, WebP always (until OpenImageIO 2.5).
Alpha alpha_of(const ImageInput& input) {
  if (input.spec().get_int_attribute("oiio:UnassociatedAlpha", 0)) return Alpha::straight;
  const std::string_view format = input.format_name();
  if (format == "openexr" || format == "tiff") return Alpha::associated;
  return format == "webp" ? Alpha::associated_linear : Alpha::straight;
}

void make_straight(float* rgba, size_t pixels) {
  for (size_t i = 0; i < pixels; ++i, rgba += 4) {
    if (rgba[3] == 0.0f || rgba[3] == 1.0f) continue;
    for (int c = 0; c < 3; ++c) rgba[c] /= rgba[3];
  }
}

void make_straight(uint8_t* rgba, size_t pixels, Alpha alpha) {
  for (size_t i = 0; i < pixels; ++i, rgba += 4) {
    if (rgba[3] == 0 || rgba[3] == 255) continue;
    const float a = static_cast<float>(rgba[3]) / 255.0f;
    for (int c = 0; c < 3; ++c) {
      const float v = static_cast<float>(rgba[c]) / 255.0f;
      const float straight = alpha == Alpha::associated_linear
                                 ? encoded_from_linear(linear_from_encoded(v) / a)
                                 : v / a;
      rgba[c] = static_cast<uint8_t>(std::lround(255.0f * std::min(straight, 1.0f)));
    }
  }
}

void require(bool ok, ImageInput& input) {
  if (!ok) throw std::runtime_error(tidy(input.geterror(), "the file is damaged"));
}

/// Whether the first `count` of the chosen channels lie side by side in the file.
bool in_order(const Channels& channels, int count) {
  for (int c = 1; c < count; ++c) {
    if (channels.rgba[c] != channels.rgba[0] + c) return false;
  }
  return channels.rgba[0] >= 0;
}

/// Reads `count` channels that are in order, the last row of the file first.
template <typename T>
void read_in_order(ImageInput& input, int first, int count, TypeDesc type, T* texels) {
  const ImageSpec spec = input.spec();
  const auto stride = static_cast<OIIO::stride_t>(sizeof(T)) * count;
  const OIIO::stride_t row = stride * spec.width;
  T* top = texels + static_cast<size_t>(spec.height - 1) * static_cast<size_t>(spec.width * count);
  require(spec.tile_width ? input.read_image(0, 0, first, first + count, type, top, stride, -row)
                          : input.read_scanlines(0, 0, spec.y, spec.y + spec.height, spec.z, first,
                                                 first + count, type, top, stride, -row),
          input);
}

/// Reads the chosen channels into `count` of each texel, the last row of the file first.
template <typename T>
void read_pixels(ImageInput& input, const Channels& channels, int count, TypeDesc type, T opaque,
                 T* texels) {
  if (in_order(channels, count)) {
    read_in_order(input, channels.rgba[0], count, type, texels);
    return;
  }
  const ImageSpec spec = input.spec();
  const int begin = channels.first();
  const int read = channels.last() + 1 - begin;
  const size_t width = static_cast<size_t>(spec.width);
  const size_t rows_at_once = std::max<size_t>(1, std::min<size_t>(256, spec.height));
  // Tiled files are read whole; others in bands, so that little memory is needed beside the texels.
  const size_t band = spec.tile_width ? static_cast<size_t>(spec.height) : rows_at_once;
  std::vector<T> rows(band * width * static_cast<size_t>(read));
  for (size_t y = 0; y < static_cast<size_t>(spec.height); y += band) {
    const size_t height = std::min(band, static_cast<size_t>(spec.height) - y);
    require(spec.tile_width ? input.read_image(0, 0, begin, begin + read, type, rows.data())
                            : input.read_scanlines(0, 0, spec.y + static_cast<int>(y),
                                                   spec.y + static_cast<int>(y + height), spec.z,
                                                   begin, begin + read, type, rows.data()),
            input);
    for (size_t row = 0; row < height; ++row) {
      const T* from = rows.data() + row * width * static_cast<size_t>(read);
      T* to = texels + static_cast<size_t>(count) * width *
                           (static_cast<size_t>(spec.height) - 1 - (y + row));
      for (size_t x = 0; x < width; ++x, from += read, to += count) {
        for (int c = 0; c < count; ++c) {
          const int channel = channels.rgba[c];
          to[c] = channel >= 0 ? from[channel - begin] : (c == 3 ? opaque : T(0));
        }
      }
    }
  }
}

void decode(ImageInput& input, KestrelPluginImage& image) {
  const ImageSpec spec = input.spec();
  check_size(spec);
  const Channels channels = find_channels(spec);
  const size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
  const Alpha alpha = channels.rgba[3] >= 0 ? alpha_of(input) : Alpha::straight;
  image.channels = 4;
  if (spec.format.basetype == TypeDesc::UINT8) {
    image.channels = channels.rgba[3] >= 0 ? 4 : 3;
    auto* texels = allocate<uint8_t>(image, static_cast<size_t>(image.channels) * pixels);
    read_pixels<uint8_t>(input, channels, image.channels, TypeDesc::UINT8, 255, texels);
    if (alpha != Alpha::straight) make_straight(texels, pixels, alpha);
  } else {
    auto* texels = allocate<float>(image, 4 * pixels);
    read_pixels<float>(input, channels, 4, TypeDesc::FLOAT, 1.0f, texels);
    if (alpha != Alpha::straight) make_straight(texels, pixels);
  }
  image.width = spec.width;
  image.height = spec.height;
  image.encoded = spec.format.is_floating_point() ? 0 : 1;
}

/// Decodes, and closes the file.
void decode_and_close(std::unique_ptr<ImageInput> input, KestrelPluginImage& image) {
  if (!input) throw std::runtime_error(tidy(OIIO::geterror(), "the format is not known"));
  try {
    decode(*input, image);
  } catch (...) {
    input->geterror();  // taken, so that OpenImageIO does not print it
    throw;
  }
  input->close();
}

ImageSpec straight_alpha_wanted() {
  ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  return config;
}

/// A name with the extension that the first bytes stand for, to choose the reader by.
const char* name_from_magic(const uint8_t* data, size_t byte_count) {
  struct Magic {
    std::string_view bytes;
    size_t offset;
    const char* name;
  };
  using namespace std::string_view_literals;
  static constexpr Magic kMagics[] = {{"\x89PNG"sv, 0, "image.png"},
                                      {"\xff\xd8\xff"sv, 0, "image.jpg"},
                                      {"v/1\x01"sv, 0, "image.exr"},
                                      {"II*\0"sv, 0, "image.tif"},
                                      {"MM\0*"sv, 0, "image.tif"},
                                      {"#?"sv, 0, "image.hdr"},
                                      {"BM"sv, 0, "image.bmp"},
                                      {"GIF8"sv, 0, "image.gif"},
                                      {"WEBP"sv, 8, "image.webp"},
                                      {"DDS "sv, 0, "image.dds"},
                                      {"8BPS"sv, 0, "image.psd"},
                                      {"\0\0\0\x0cjP"sv, 0, "image.jp2"},
                                      {"\xff\x4f\xff\x51"sv, 0, "image.jp2"}};
  const std::string_view text(reinterpret_cast<const char*>(data), byte_count);
  for (const Magic& m : kMagics) {
    if (text.size() >= m.offset && text.substr(m.offset).substr(0, m.bytes.size()) == m.bytes) {
      return m.name;
    }
  }
  return "image.tga";  // the one common format without a magic number
}

/// For readers that only take files.
void read_through_file(const uint8_t* data, size_t byte_count, const char* name,
                       KestrelPluginImage& image) {
  const std::string extension = std::filesystem::path(name).extension();
  std::string path = (std::filesystem::temp_directory_path() / "kestrel-XXXXXX").string();
  path += extension;
  const int file = mkstemps(path.data(), static_cast<int>(extension.size()));
  if (file < 0) throw std::runtime_error("no temporary file could be made: " + path);
  struct Remove {
    const std::string& path;
    int file;
    ~Remove() {
      close(file);
      unlink(path.c_str());
    }
  } remove{path, file};
  for (size_t done = 0; done < byte_count;) {
    const ssize_t n = write(file, data + done, byte_count - done);
    if (n <= 0) throw std::runtime_error("the temporary file could not be written: " + path);
    done += static_cast<size_t>(n);
  }
  const ImageSpec config = straight_alpha_wanted();
  decode_and_close(ImageInput::open(path, &config), image);
}

}  // namespace

void read_file(const char* path, KestrelPluginImage& image) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw std::runtime_error("there is no such file");
  if (std::filesystem::is_directory(status)) throw std::runtime_error("it is a folder");
  const ImageSpec config = straight_alpha_wanted();
  decode_and_close(ImageInput::open(path, &config), image);
}

void read_memory(const void* data, size_t byte_count, KestrelPluginImage& image) {
  if (!data || byte_count == 0) throw std::runtime_error("it has no bytes");
  const auto* bytes = static_cast<const uint8_t*>(data);
  const char* name = name_from_magic(bytes, byte_count);
  OIIO::Filesystem::IOMemReader memory(data, byte_count);
  OIIO::Filesystem::IOProxy* proxy = &memory;
  auto input = ImageInput::create(name, false, nullptr, proxy);
  if (!input) throw std::runtime_error(tidy(OIIO::geterror(), "the format is not known"));
  if (!input->supports("ioproxy")) {
    read_through_file(bytes, byte_count, name, image);
    return;
  }
  ImageSpec config = straight_alpha_wanted();
  config.attribute("oiio:ioproxy", TypeDesc::PTR, &proxy);  // where there is a config, it decides
  ImageSpec spec;
  if (!input->open(name, spec, config)) {
    throw std::runtime_error(tidy(input->geterror(), "the file is damaged"));
  }
  decode_and_close(std::move(input), image);
}

}  // namespace kestrel::oiio
