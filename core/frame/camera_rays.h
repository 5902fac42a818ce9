// SPDX-License-Identifier: GPL-3.0-or-later
// From pixels to rays and depths, for whoever does not rasterise.
#pragma once

#include "frame/lens.h"

namespace kestrel {

/// A ray with the part of it that the clip planes leave.
struct CameraRay {
  vec3 origin;
  vec3 direction;  // unit
  float t_near;
  float t_far;
};

/// The camera's frame in world space, once per frame. Pixels (x, y) are those of the region.
class CameraRays {
 public:
  explicit CameraRays(const FrameInputs& inputs)
      : camera_(inputs.scene.camera),
        right_(camera_.world_from_camera[0]),
        up_(camera_.world_from_camera[1]),
        backward_(camera_.world_from_camera[2]),
        position_(camera_.world_from_camera[3]),
        scale_((camera_.right - camera_.left) / static_cast<float>(inputs.width),
               (camera_.top - camera_.bottom) / static_cast<float>(inputs.height)),
        corner_(camera_.left, camera_.bottom),
        first_pixel_(inputs.region.x, inputs.region.y),
        sample_(0.5f + inputs.subpixel),
        lens_(inputs.lens) {}

  /// The ray through the frame's sample position of a pixel. The same bits whatever the region.
  CameraRay ray(int x, int y) const {
    const vec2 at = corner_ + (vec2(first_pixel_ + ivec2(x, y)) + sample_) * scale_;
    if (lens_.open) return ray_through(at, aperture(x, y));
    if (camera_.projection == Projection::orthographic) {
      const vec3 origin = position_ + at.x * right_ + at.y * up_;
      // A near plane behind the camera: rays must not begin at negative distances.
      const float behind = glm::max(-camera_.near_clip, 0.0f);
      return {origin + behind * backward_, -backward_, camera_.near_clip + behind,
              camera_.far_clip + behind};
    }
    const vec3 along = at.x * right_ + at.y * up_ - backward_;
    const float length = glm::length(along);
    return {position_, along / length, camera_.near_clip * length, camera_.far_clip * length};
  }

  /// Unit direction from a point, which a pixel shows, towards the viewer.
  vec3 to_viewer(const vec3& position_ws, int x, int y) const {
    if (lens_.open) {
      const vec3 across = across_view(aperture(x, y));
      return camera_.projection == Projection::orthographic
                 ? glm::normalize(backward_ + across / camera_.focus_distance)
                 : glm::normalize(position_ + across - position_ws);
    }
    return camera_.projection == Projection::orthographic ? backward_
                                                          : glm::normalize(position_ - position_ws);
  }

  float distance(const vec3& position_ws) const { return glm::length(position_ws - position_); }

  /// Reversed-z depth of a point: 1 at the near plane, 0 at the far one.
  float reversed_depth(const vec3& position_ws) const {
    const float d = glm::dot(position_ - position_ws, backward_);
    const float n = camera_.near_clip, f = camera_.far_clip;
    return camera_.projection == Projection::orthographic ? (f - d) / (f - n)
                                                          : n * (f - d) / (d * (f - n));
  }

 private:
  vec2 aperture(int x, int y) const {
    return aperture_point(camera_, lens_, first_pixel_.x + x, first_pixel_.y + y);
  }
  vec3 across_view(const vec2& v) const { return v.x * right_ + v.y * up_; }

  /// From a point of the aperture through the one in focus that the window's point `at` shows.
  CameraRay ray_through(const vec2& at, const vec2& aperture) const {
    const vec2 slope = aperture / camera_.focus_distance;
    if (camera_.projection == Projection::orthographic) {
      const vec3 backward = backward_ + across_view(slope);
      const float length = glm::length(backward);
      const float behind = glm::max(-camera_.near_clip, 0.0f);
      return {position_ + across_view(at + aperture) + behind * backward, -backward / length,
              (camera_.near_clip + behind) * length, (camera_.far_clip + behind) * length};
    }
    const vec3 along = across_view(at - slope) - backward_;
    const float length = glm::length(along);
    return {position_ + across_view(aperture), along / length, camera_.near_clip * length,
            camera_.far_clip * length};
  }

  const Camera& camera_;
  vec3 right_, up_, backward_, position_;
  vec2 scale_;
  vec2 corner_;        // of the window
  ivec2 first_pixel_;  // of the region
  vec2 sample_;        // from the pixel's corner, in pixels
  LensSample lens_;
};

}  // namespace kestrel
