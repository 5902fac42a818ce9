// SPDX-License-Identifier: GPL-3.0-or-later
// The finished picture: Combined and every buffer between the stages, as passes.
#pragma once

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
  /// Starts a new picture; the next first sample gets this one's memory in exchange.
  void clear() { samples_ = 0; }

  /// Takes the buffers over: the first sample's are kept, later ones are added and left as they
  /// are. All samples have one size.
  void add_sample(const FrameInputs& inputs, GBuffer& gbuffer, EffectBuffers& effects,
                  std::vector<vec4>& combined);

  int width() const { return gbuffer_.width; }
  int height() const { return gbuffer_.height; }
  int samples() const { return samples_; }

  /// Channels interleaved. Throws Error(invalid_argument) for an unknown name.
  std::vector<float> pass(std::string_view name) const;

 private:
  std::vector<float> linear_depth() const;

  int samples_ = 0;
  Camera camera_;
  GBuffer gbuffer_;             // colours: sums over the samples
  EffectBuffers effects_;       // sums
  std::vector<vec4> combined_;  // sums
};

}  // namespace kestrel
