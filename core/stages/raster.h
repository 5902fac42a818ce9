// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 1: fills the G-buffer by rasterising, and lights it (paper, section 3.1, listings 1 to 5).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "frame/frame.h"
#include "gl/context.h"

namespace kestrel {

class RasterStage {
 public:
  explicit RasterStage(std::shared_ptr<gl::Context> context);
  ~RasterStage();
  RasterStage(const RasterStage&) = delete;
  RasterStage& operator=(const RasterStage&) = delete;

  /// Uploads what differs from the last scene (meshes and textures are compared by identity).
  void update(const std::shared_ptr<const Scene>& scene);

  /// Fills every plane of `out` except heuristic_mask, lighting included. Visibility is exact per
  /// sample at FrameInputs::subpixel; of coinciding surfaces the first object shows. The scene is
  /// the one last given to update().
  void run(const FrameInputs& inputs, GBuffer& out);

  /// Visible pixels per unit, measured with one occlusion query a unit against the depth of the
  /// last run() (listing 6: depth test GL_EQUAL). Must equal the histogram of the object ids.
  std::vector<uint64_t> occlusion_areas(const FrameInputs& inputs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kestrel
