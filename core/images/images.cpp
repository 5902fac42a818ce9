// SPDX-License-Identifier: GPL-3.0-or-later
#include "images/images.h"

#include <dlfcn.h>

#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "images/image_plugin.h"

namespace kestrel::images {
namespace {

constexpr const char* kPluginFile = "libkestrel_oiio.so";

/// The plug-in, or the reason why there is none.
struct Plugin {
  const KestrelImagePlugin* table = nullptr;
  std::string reason;
};

/// The folder of the file that holds this code: libkestrel.so, or the program it is linked into.
std::filesystem::path own_folder() {
  Dl_info info{};
  if (!dladdr(reinterpret_cast<const void*>(&own_folder), &info) || !info.dli_fname) return {};
  std::error_code error;
  const auto path = std::filesystem::canonical(info.dli_fname, error);
  return error ? std::filesystem::path(info.dli_fname).parent_path() : path.parent_path();
}

Plugin load_plugin() {
  const char* chosen = std::getenv("KESTREL_IMAGE_PLUGIN");
  const std::string path =
      chosen && *chosen ? std::string(chosen) : (own_folder() / kPluginFile).string();
  Plugin plugin;
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* detail = dlerror();
    plugin.reason = fmt::format(
        "The image plug-in could not be loaded ({}). Install OpenImageIO, keep {} beside the "
        "library, or name it in KESTREL_IMAGE_PLUGIN.",
        detail ? detail : path, kPluginFile);
    return plugin;
  }
  const auto entry =
      reinterpret_cast<KestrelImagePluginFunction>(dlsym(library, "kestrel_image_plugin"));
  const KestrelImagePlugin* table = entry ? entry() : nullptr;
  if (!table) {
    plugin.reason = fmt::format(
        "'{}' is no image plug-in of Kestrel. Point KESTREL_IMAGE_PLUGIN at {}, or unset it.", path,
        kPluginFile);
  } else if (table->abi != KESTREL_IMAGE_PLUGIN_ABI) {
    plugin.reason = fmt::format(
        "The image plug-in '{}' speaks version {} of its interface, this library version {}. "
        "Install both from the same release.",
        path, table->abi, KESTREL_IMAGE_PLUGIN_ABI);
  } else {
    plugin.table = table;
    log::debug("Image plug-in {} ({}).", path, table->version);
    return plugin;
  }
  dlclose(library);
  return plugin;
}

const Plugin& plugin() {
  static const Plugin instance = load_plugin();
  return instance;
}

const KestrelImagePlugin& require_plugin() {
  if (!plugin().table) throw Error(ErrorCode::unsupported, plugin().reason);
  return *plugin().table;
}

/// The sRGB curve of IEC 61966-2-1, encoded to linear.
float linear_from_srgb(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// An image that the plug-in decodes into memory of ours.
class Target {
 public:
  KestrelPluginImage image{};

  Target() {
    image.allocate = allocate;
    image.host = this;
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  void move_into(Texture& texture) {
    if (image.is_float && image.encoded && texture.srgb) {
      for (size_t i = 0; i < texels_float_.size(); ++i) {
        if (i % 4 != 3) texels_float_[i] = linear_from_srgb(texels_float_[i]);
      }
    }
    texture.width = image.width;
    texture.height = image.height;
    texture.channels8 = image.channels;
    texture.texels8 = std::move(texels8_);
    texture.texels_float = std::move(texels_float_);
  }

 private:
  static void* allocate(void* host, size_t count, int is_float) noexcept {
    try {
      auto& self = *static_cast<Target*>(host);
      if (is_float) {
        self.texels_float_.resize(count);
        return self.texels_float_.data();
      }
      self.texels8_.resize(count);
      return self.texels8_.data();
    } catch (const std::exception&) {
      return nullptr;
    }
  }

  std::vector<uint8_t> texels8_;
  std::vector<float> texels_float_;
};

}  // namespace

std::string plugin_version() {
  return plugin().table ? plugin().table->version : plugin().reason;
}

bool plugin_available() {
  return plugin().table != nullptr;
}

void read_file(const std::string& path, Texture& texture) {
  const KestrelImagePlugin& table = require_plugin();
  Target target;
  if (const char* reason = table.read_file(path.c_str(), &target.image)) {
    fail(ErrorCode::file, "'{}' could not be read: {}.", path, reason);
  }
  target.move_into(texture);
}

void read_memory(const void* data, size_t byte_count, Texture& texture) {
  const KestrelImagePlugin& table = require_plugin();
  Target target;
  if (const char* reason = table.read_memory(data, byte_count, &target.image)) {
    fail(ErrorCode::file, "The image '{}' could not be read from memory: {}.", texture.name,
         reason);
  }
  target.move_into(texture);
}

void write_file(const std::string& path, int width, int height, const std::vector<Layer>& layers,
                const std::vector<Attribute>& attributes) {
  const KestrelImagePlugin& table = require_plugin();
  std::vector<KestrelPluginLayer> rows;
  rows.reserve(layers.size());
  for (const Layer& layer : layers) {
    rows.push_back({layer.name.c_str(), layer.channels.c_str(), layer.pixels});
  }
  std::vector<KestrelPluginAttribute> texts;
  for (const auto& [name, value] : attributes) texts.push_back({name.c_str(), value.c_str()});
  const KestrelPluginPicture picture{width,       height,       rows.data(),
                                     rows.size(), texts.data(), texts.size()};
  if (const char* reason = table.write_file(path.c_str(), &picture)) {
    fail(ErrorCode::file, "'{}' could not be written: {}.", path, reason);
  }
}

void fill_missing(Texture& texture) {
  texture.width = 1;
  texture.height = 1;
  texture.channels8 = 4;
  texture.texels8 = {255, 0, 255, 255};
  texture.texels_float.clear();
}

}  // namespace kestrel::images
