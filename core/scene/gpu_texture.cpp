// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/gpu_texture.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "base/log.h"
#include "gl/debug.h"

namespace kestrel {
namespace {

// IEC 61966-2-1, both ways, values 0 … 1.
float linear_from_srgb(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}
float srgb_from_linear(float c) {
  return c <= 0.0031308f ? c * 12.92f : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

vec4 load_texel(const Texture& t, size_t index) {
  if (!t.texels_float.empty()) {
    const float* p = &t.texels_float[4 * index];
    return {p[0], p[1], p[2], p[3]};
  }
  const uint8_t* p = &t.texels8[static_cast<size_t>(t.channels8) * index];
  vec4 c = vec4(p[0], p[1], p[2], t.channels8 == 4 ? p[3] : 255) / 255.0f;
  if (t.srgb) {
    for (int k = 0; k < 3; ++k) c[k] = linear_from_srgb(c[k]);
  }
  return c;
}

void store_texel(Texture& t, size_t index, vec4 c) {
  if (!t.texels_float.empty()) {
    std::copy_n(&c.x, 4, &t.texels_float[4 * index]);
    return;
  }
  if (t.srgb) {
    for (int k = 0; k < 3; ++k) c[k] = srgb_from_linear(c[k]);
  }
  for (int k = 0; k < 4; ++k) {
    t.texels8[4 * index + static_cast<size_t>(k)] =
        static_cast<uint8_t>(std::lround(255.0f * glm::clamp(c[k], 0.0f, 1.0f)));
  }
}

/// Texels of the old side that the new side's texel `i` covers: [first, last).
std::pair<int, int> covered(int i, int new_size, int old_size) {
  const auto at = [&](int k) { return static_cast<int>(int64_t(k) * old_size / new_size); };
  return {at(i), std::max(at(i + 1), at(i) + 1)};
}

bool is_empty(const Texture& t) {
  return t.width <= 0 || t.height <= 0;
}

bool half_holds(float value) {
  return glm::unpackHalf1x16(glm::packHalf1x16(value)) == value;
}

}  // namespace

Texture fit_texture(const Texture& texture, int limit) {
  if (texture.width <= limit && texture.height <= limit) return texture;
  const double scale = static_cast<double>(limit) / std::max(texture.width, texture.height);
  Texture out;
  out.name = texture.name;
  out.srgb = texture.srgb;
  out.nearest = texture.nearest;
  out.extension = texture.extension;
  out.width = std::clamp(static_cast<int>(texture.width * scale), 1, limit);
  out.height = std::clamp(static_cast<int>(texture.height * scale), 1, limit);
  const size_t count = static_cast<size_t>(out.width) * static_cast<size_t>(out.height);
  (texture.texels_float.empty() ? out.texels8.resize(4 * count)
                                : out.texels_float.resize(4 * count));
  for (int y = 0; y < out.height; ++y) {
    const auto [y0, y1] = covered(y, out.height, texture.height);
    for (int x = 0; x < out.width; ++x) {
      const auto [x0, x1] = covered(x, out.width, texture.width);
      vec4 sum(0.0f);
      for (int j = y0; j < y1; ++j) {
        for (int i = x0; i < x1; ++i) {
          sum += load_texel(texture, static_cast<size_t>(j) * texture.width + i);
        }
      }
      const float texels = static_cast<float>((x1 - x0) * (y1 - y0));
      store_texel(out, static_cast<size_t>(y) * out.width + x, sum / texels);
    }
  }
  return out;
}

GLenum texture_format(const Texture& texture) {
  if (texture.texels_float.empty()) return texture.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8;
  const std::vector<float>& texels = texture.texels_float;
  return std::all_of(texels.begin(), texels.end(), half_holds) ? GL_RGBA16F : GL_RGBA32F;
}

gl::Texture2D upload_texture(const Texture& texture) {
  if (is_empty(texture)) {
    gl::Texture2D white(texture.name, GL_RGBA8, 1, 1);
    const uint8_t texel[4] = {255, 255, 255, 255};
    white.upload(GL_RGBA, GL_UNSIGNED_BYTE, texel);
    return white;
  }
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (texture.width > limit || texture.height > limit) {
    const Texture smaller = fit_texture(texture, limit);
    log::warning_once(
        "The image '{}' ({}x{}) is larger than this OpenGL device takes; it is used at {}x{}.",
        texture.name, texture.width, texture.height, smaller.width, smaller.height);
    return upload_texture(smaller);
  }
  gl::Texture2D out(texture.name, texture_format(texture), texture.width, texture.height);
  if (texture.texels_float.empty()) {
    out.upload(texture.channels8 == 4 ? GL_RGBA : GL_RGB, GL_UNSIGNED_BYTE, texture.texels8.data());
  } else {
    out.upload(GL_RGBA, GL_FLOAT, texture.texels_float.data());
  }
  gl::check_errors("uploading the image '" + texture.name + "'");
  return out;
}

TextureSamplers::TextureSamplers() {
  constexpr GLenum wraps[3] = {GL_REPEAT, GL_CLAMP_TO_EDGE, GL_CLAMP_TO_BORDER};
  for (const size_t nearest : {0, 1}) {
    const GLenum filter = nearest ? GL_NEAREST : GL_LINEAR;
    for (size_t extension = 0; extension < 3; ++extension) {
      by_extension_[extension][nearest] =
          gl::Sampler("texture", wraps[extension], wraps[extension], filter);
    }
    equirectangular_[nearest] =
        gl::Sampler("equirectangular world", GL_REPEAT, GL_CLAMP_TO_EDGE, filter);
  }
}

GLuint TextureSamplers::for_material(const Texture& texture) const {
  return by_extension_[static_cast<size_t>(texture.extension)][texture.nearest].name();
}

GLuint TextureSamplers::for_equirectangular(const Texture& texture) const {
  return equirectangular_[texture.nearest].name();
}

GLuint TextureSamplers::for_cube_face(const Texture& texture) const {
  return by_extension_[static_cast<size_t>(Extension::clamp)][texture.nearest].name();
}

}  // namespace kestrel
