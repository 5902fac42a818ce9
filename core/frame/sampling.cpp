// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kestrel {
namespace {

/// Four-term Blackman-Harris window over 0…1.
double blackman_harris(double x) {
  const double t = 2.0 * M_PI * x;
  return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2.0 * t) -
         0.01168 * std::cos(3.0 * t);
}

/// Position in 0…1 below which the share `u` of the window's area lies.
float inverse_blackman_harris(float u) {
  constexpr int kSteps = 1024;
  static const std::array<double, kSteps + 1> cumulative = [] {
    std::array<double, kSteps + 1> c{};
    for (int i = 0; i < kSteps; ++i) c[i + 1] = c[i] + blackman_harris((i + 0.5) / kSteps);
    for (double& v : c) v /= c[kSteps];
    return c;
  }();
  const auto above = std::upper_bound(cumulative.begin(), cumulative.end() - 1, double{u});
  const int i = static_cast<int>(above - cumulative.begin()) - 1;
  const double within = (u - cumulative[i]) / (cumulative[i + 1] - cumulative[i]);
  return static_cast<float>((i + within) / kSteps);
}

/// Element `index` of the additive sequence that begins at 0.5, 0 … 1.
float additive(int index, double step) {
  const double x = 0.5 + index * step;
  return glm::min(static_cast<float>(x - std::floor(x)), 0x1.fffffep-1f);
}

}  // namespace

vec2 lens_position(int index) {
  // The three-dimensional generalisation of the golden ratio: no step of another sequence here.
  constexpr double kRatio = 1.22074408460575947536;
  return {additive(index, 1.0 / kRatio), additive(index, 1.0 / (kRatio * kRatio))};
}

float shutter_time(int index) {
  return additive(index, 0.61803398874989484820);
}

vec2 subpixel_offset(const Settings& settings, int index) {
  constexpr double kPlastic = 1.32471795724474602596;
  double x = 0.5 + index / kPlastic, y = 0.5 + index / (kPlastic * kPlastic);
  x -= std::floor(x);
  y -= std::floor(y);
  vec2 at{static_cast<float>(x), static_cast<float>(y)};
  if (settings.pixel_filter == PixelFilter::blackman_harris) {
    at = {inverse_blackman_harris(at.x), inverse_blackman_harris(at.y)};
  }
  return (at - 0.5f) * settings.filter_width;
}

}  // namespace kestrel
