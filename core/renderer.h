// SPDX-License-Identifier: GPL-3.0-or-later
// A frame, from the scene to the film: read render_frame() first.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "frame/film.h"
#include "frame/frame.h"
#include "gl/context.h"
#include "tracers/embree/embree_api.h"

namespace kestrel {

/// What renderers share: OpenGL (started when first used) and Embree's device.
class Device {
 public:
  Device();
  ~Device();

  /// The GL context; throws Error(unsupported) where there is none (remembered).
  std::shared_ptr<gl::Context> gl();
  RTCDevice embree() const;
  /// As kestrelGetDeviceInfo(). Starts OpenGL.
  std::string info_json();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Told now and then how far a frame is, 0…1, from any thread; false cancels.
using Progress = std::function<bool(float fraction, std::string_view status)>;

class Renderer {
 public:
  explicit Renderer(std::shared_ptr<Device> device);
  ~Renderer();

  /// Renders one frame. Throws Error(cancelled) when `progress` returned false or cancel() was
  /// called; the last whole frame then stays readable, and copy_so_far() has the rest.
  void render_frame(std::shared_ptr<const Scene> scene, int width, int height,
                    const Progress& progress);

  /// What the next frames render of their pictures, in pixels; of no width: all, as at first. Films
  /// then have its size.
  void set_region(const Region& region);

  /// Passes that the next frames keep, by name; at first all. Throws Error(invalid_argument).
  void set_passes(const std::vector<std::string>& names);

  /// From any thread; only affects a frame under way.
  void cancel();

  /// A pass of the frame under way as far as it is, or of the last one that ended or was cancelled:
  /// Film::copy_so_far(). From any thread. Throws Error(invalid_argument) where `float_count` is
  /// not the pass's, Error(invalid_operation) before the first frame.
  void copy_so_far(std::string_view pass, float* out, size_t float_count) const;

  /// The last whole frame.
  const Film& film() const;
  /// One entry of "frames" of the stats, as JSON; empty before the first frame.
  const std::string& stats_json() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kestrel
