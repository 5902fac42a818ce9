// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "frame/frame.h"

namespace kestrel {

/// Wall times of one frame, milliseconds, all samples together.
struct StageTimes {
  double update = 0.0;  // acceleration structures and uploads, before stage 1
  double raster = 0.0;
  double heuristic = 0.0;
  double trace = 0.0;
  double blend = 0.0;

  StageTimes& operator+=(const StageTimes& o);
  double sum() const { return update + raster + heuristic + trace + blend; }
};

/// Every time, scaled.
StageTimes operator*(const StageTimes& times, double factor);

/// What one frame did and cost.
struct FrameStats {
  double frame_ms = 0.0;
  StageTimes stages;
  std::string primary;  // "raster" or "rays"
  int samples = 0;
  RayCounts rays;
  double trace_calls_ms = 0.0;  // thread time inside Embree during stage 3
  Selection selection;
  std::vector<uint64_t> occlusion_areas;  // by unit, with Settings::validate_areas; else empty
};

/// One entry of "frames" in the stats file.
std::string to_json(const FrameStats& stats, const Scene& scene);

}  // namespace kestrel
