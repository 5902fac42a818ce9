// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/texture.h"

#include <array>
#include <cmath>

#include "scene/world.h"

namespace kestrel {
namespace {

constexpr float kFromByte = 1.0f / 255.0f;

/// IEC 61966-2-1, by 8-bit code.
const std::array<float, 256>& srgb_to_linear() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (int i = 0; i < 256; ++i) {
      const double c = i / 255.0;
      t[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table;
}

/// Texel row or column that an index means, kNone outside a clipped texture.
int wrap(int i, int n, Extension extension) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(n)) return i;
  if (extension == Extension::repeat) {
    i %= n;
    return i < 0 ? i + n : i;
  }
  if (extension == Extension::clamp) return i < 0 ? 0 : n - 1;
  return kNone;
}

/// By 8-bit code: the sRGB curve or none.
const float* decoding(const Texture& t) {
  static const std::array<float, 256> straight = [] {
    std::array<float, 256> table{};
    for (int i = 0; i < 256; ++i) table[i] = static_cast<float>(i) * kFromByte;
    return table;
  }();
  static const std::array<float, 256>& linear = srgb_to_linear();
  return t.srgb ? linear.data() : straight.data();
}

vec4 linear8(const Texture& t, const uint8_t* p) {
  const float* value = decoding(t);
  return {value[p[0]], value[p[1]], value[p[2]], t.channels8 == 4 ? p[3] * kFromByte : 1.0f};
}

vec4 texel(const Texture& t, int x, int y) {
  if (x < 0 || y < 0) return vec4(0.0f);
  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(t.width) + x;
  if (t.texels_float.empty()) return linear8(t, &t.texels8[static_cast<size_t>(t.channels8) * i]);
  const float* p = &t.texels_float[4 * i];
  return {p[0], p[1], p[2], p[3]};
}

int floor_to_int(float x) {
  const int i = static_cast<int>(x);
  return i - (static_cast<float>(i) > x);
}

/// Texel coordinate of a texture coordinate, kept where an int can hold it.
float texel_coordinate(float u, int size, Extension extension) {
  if (extension == Extension::repeat) {
    constexpr float kWhole = 1 << 23;  // from here on every float32 is a whole number
    u = std::abs(u) < kWhole ? u - static_cast<float>(floor_to_int(u)) : 0.0f;
  }
  return glm::clamp(u * static_cast<float>(size), -1e6f, 1e6f);
}

/// The four texels around a point and how they are weighed.
struct Footprint {
  int x0, x1, y0, y1;  // kNone outside a clipped texture
  float right, high;   // shares of x1 and y1

  Footprint(const Texture& t, const vec2& uv, Extension across_u, Extension across_v) {
    const float x = texel_coordinate(uv.x, t.width, across_u) - 0.5f;
    const float y = texel_coordinate(uv.y, t.height, across_v) - 0.5f;
    const int left = floor_to_int(x), low = floor_to_int(y);
    right = x - static_cast<float>(left);
    high = y - static_cast<float>(low);
    x0 = wrap(left, t.width, across_u), x1 = wrap(left + 1, t.width, across_u);
    y0 = wrap(low, t.height, across_v), y1 = wrap(low + 1, t.height, across_v);
  }
  bool inside() const { return (x0 | x1 | y0 | y1) >= 0; }
  float mix(float low_left, float low_right, float high_left, float high_right) const {
    const float below = low_left * (1.0f - right) + low_right * right;
    const float above = high_left * (1.0f - right) + high_right * right;
    return below * (1.0f - high) + above * high;
  }
};

/// Most lookups: four 8-bit texels.
vec4 bilinear8(const Texture& t, const Footprint& at) {
  const float* value = decoding(t);
  const size_t channels = static_cast<size_t>(t.channels8), width = static_cast<size_t>(t.width);
  const uint8_t* low = t.texels8.data() + channels * width * static_cast<size_t>(at.y0);
  const uint8_t* high = t.texels8.data() + channels * width * static_cast<size_t>(at.y1);
  const size_t left = channels * static_cast<size_t>(at.x0);
  const size_t right = channels * static_cast<size_t>(at.x1);
  const auto channel = [&](size_t c) {
    return at.mix(value[low[left + c]], value[low[right + c]], value[high[left + c]],
                  value[high[right + c]]);
  };
  const float alpha = channels < 4
                          ? 1.0f
                          : at.mix(low[left + 3] * kFromByte, low[right + 3] * kFromByte,
                                   high[left + 3] * kFromByte, high[right + 3] * kFromByte);
  return {channel(0), channel(1), channel(2), alpha};
}

/// The lookup, with its own rule outside 0…1 for each axis.
vec4 sample(const Texture& t, const vec2& uv, Extension across_u, Extension across_v) {
  if (t.width <= 0 || t.height <= 0) return vec4(1.0f);
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return texel(t, 0, 0);
  if (t.nearest) {
    const float x = texel_coordinate(uv.x, t.width, across_u);
    const float y = texel_coordinate(uv.y, t.height, across_v);
    return texel(t, wrap(floor_to_int(x), t.width, across_u),
                 wrap(floor_to_int(y), t.height, across_v));
  }
  const Footprint at(t, uv, across_u, across_v);
  if (t.texels_float.empty() && at.inside()) return bilinear8(t, at);
  return glm::mix(glm::mix(texel(t, at.x0, at.y0), texel(t, at.x1, at.y0), at.right),
                  glm::mix(texel(t, at.x0, at.y1), texel(t, at.x1, at.y1), at.right), at.high);
}

}  // namespace

vec4 sample_texture(const Texture& t, const vec2& uv) {
  return sample(t, uv, t.extension, t.extension);
}

void prefetch_texels(const Texture& t, const vec2& uv) {
  if (t.width <= 0 || t.height <= 0 || !std::isfinite(uv.x) || !std::isfinite(uv.y)) return;
  const Footprint at(t, uv, t.extension, t.extension);
  for (const int row : {at.y0, at.y1}) {
    if (at.x0 < 0 || row < 0) continue;
    const size_t i = static_cast<size_t>(row) * static_cast<size_t>(t.width) + at.x0;
    if (t.texels_float.empty()) {
      __builtin_prefetch(&t.texels8[static_cast<size_t>(t.channels8) * i]);
    } else {
      __builtin_prefetch(&t.texels_float[4 * i]);
    }
  }
}

vec3 sample_world(const Scene& scene, const vec3& direction_ws) {
  const World& world = scene.world;
  if (world.kind == WorldKind::color) return world.color;
  const vec3 d = world.map_from_world * direction_ws;
  const CubeUv at = world.kind == WorldKind::cube ? cube_uv(d) : CubeUv{0, equirectangular_uv(d)};
  const int texture = world.textures[at.face];
  if (texture == kNone) return world.color;
  // A panorama closes round the horizon and ends at the poles; a cube's faces end at their edges.
  const Extension across_u = world.kind == WorldKind::cube ? Extension::clamp : Extension::repeat;
  return world.color * vec3(sample(*scene.textures[texture], at.uv, across_u, Extension::clamp));
}

}  // namespace kestrel
