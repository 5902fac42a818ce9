// SPDX-License-Identifier: GPL-3.0-or-later
// The rasteriser's render targets: the paper's Table 2, and the P-buffer of the lighting pass.
#pragma once

#include <cstddef>
#include <vector>

#include "frame/frame.h"
#include "gl/objects.h"

namespace kestrel {

/// The targets of one picture size. GL thread only.
class RasterTargets {
 public:
  RasterTargets() = default;
  /// Throws Error(unsupported) where the size is beyond the driver's.
  explicit RasterTargets(const FrameInputs& inputs);

  /// Whether a frame of these inputs can be drawn.
  bool fits(const FrameInputs& inputs) const {
    return has_size(inputs.width, inputs.height) && keep_uv_ == inputs.keep_uv;
  }
  bool has_size(int width, int height) const { return width_ == width && height_ == height; }

  /// All targets empty, nothing but the G-buffer bound for drawing.
  void begin_gbuffer() const;
  /// The P-buffer bound for drawing, the G-buffer's targets on units 0 … 6 as
  /// shaders/raster/lighting.frag reads them.
  void begin_lighting() const;
  /// Only depth (to compare) and an empty stencil bound; the ids on unit 6.
  void begin_occlusion() const;

  /// Copies every target into the planes of `out`, which has this size.
  void read(GBuffer& out);

 private:
  int width_ = 0;
  int height_ = 0;
  bool keep_uv_ = false;
  gl::Texture2D position_, normals_, emission_, ambient_, diffuse_, specular_, optical_, id_;
  gl::Texture2D depth_, lighting_;
  gl::Framebuffer gbuffer_, pbuffer_, occlusion_;
  std::vector<std::byte> staging_;  // for planes that are unpacked on the way
};

}  // namespace kestrel
