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

/// Accumulates samples. Colours are averaged over the samples; geometry, ids and the mask are
/// those of the first sample, which lies in the pixel's centre.
class Film {
 public:
  Film() = default;
  Film(int width, int height);

  void add_sample(const GBuffer& gbuffer, const EffectBuffers& effects,
                  const std::vector<vec4>& combined);

  int width() const { return width_; }
  int height() const { return height_; }
  int samples() const { return samples_; }

  /// Channels interleaved. Throws Error(invalid_argument) for an unknown name.
  std::vector<float> pass(std::string_view name) const;

 private:
  struct Average {  // sums of a colour over samples
    int channels = 0;
    std::vector<float> sum;
  };
  int width_ = 0;
  int height_ = 0;
  int samples_ = 0;
  GBuffer first_;
  std::vector<Average> averages_;
};

}  // namespace kestrel
