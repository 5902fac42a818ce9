// SPDX-License-Identifier: GPL-3.0-or-later
// The finished picture: Combined and every buffer between the stages, as passes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "frame/frame.h"

namespace kestrel {

/// A pass: its name and one letter for each channel.
struct PassInfo {
  const char* name;
  const char* channels;
};

/// Every pass, in the order in which hosts list them.
const std::vector<PassInfo>& pass_table();

/// Accumulates samples of the passes that are wanted; the others need no memory. Colours are
/// averaged over the samples; geometry, ids and the mask are those of the first sample, which lies
/// in the pixel's centre.
class Film {
 public:
  Film() = default;
  /// Throws Error(invalid_argument) for a name that is not in the table.
  Film(int width, int height, const std::vector<std::string>& wanted);

  /// Adds the region of `inputs` of sample `sample`; sample 0 comes first. Different regions may
  /// be added at the same time.
  void add(const FrameInputs& inputs, int sample, const GBuffer& gbuffer,
           const EffectBuffers& effects, const Plane<vec4>& combined);

  /// Turns the sums of so many samples into averages.
  void finish(int samples);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Whether a pass was wanted. Throws Error(invalid_argument) where it is unknown.
  bool has(std::string_view name) const;
  /// Number of floats of a pass. Throws Error(invalid_argument) where it is unknown or not wanted.
  size_t float_count(std::string_view name) const;
  /// A pass, channels interleaved: float_count() floats, as long as the film lives.
  const float* data(std::string_view name) const { return find(name).sums.data(); }
  std::vector<float> pass(std::string_view name) const;

 private:
  struct Channel {
    size_t pass;  // index in pass_table()
    size_t channels;
    Plane<float> sums;
  };
  const Channel& find(std::string_view name) const;

  int width_ = 0;
  int height_ = 0;
  std::vector<Channel> passes_;
};

}  // namespace kestrel
