// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/motion_vectors.h"

#include <optional>

#include "frame/camera_rays.h"
#include "frame/region_loops.h"
#include "scene/motion.h"
#include "tracers/embree/embree_api.h"

namespace kestrel {
namespace {

/// Where a camera sees a point, in pixels of the picture; nowhere behind it.
std::optional<vec2> place_in_picture(const Camera& camera, const FrameInputs& inputs,
                                     const vec3& position_ws) {
  const vec3 p =
      (position_ws - camera.world_from_camera[3]) * mat3(camera.world_from_camera);  // rigid
  const bool perspective = camera.projection == Projection::perspective;
  if (perspective && !(p.z < 0.0f)) return std::nullopt;
  const vec2 at = perspective ? vec2(p) / -p.z : vec2(p);
  const vec2 corner(camera.left, camera.bottom);
  const vec2 extent(camera.right - camera.left, camera.top - camera.bottom);
  return (at - corner) / extent * vec2(inputs.width, inputs.height);
}

/// What a pixel's ray meets of an object.
std::optional<SurfaceHit> hit_of(const RtScene& rt, const CameraRay& ray, int object) {
  embree::RayHitPacket packet;
  const embree::ValidLanes valid(1);
  for (int lane = 0; lane < embree::kPacket; ++lane) {
    embree::set_ray(packet, lane, ray.origin, ray.direction, ray.t_near, ray.t_far, kCameraRays);
  }
  embree::Query query;
  embree::intersect(rt.handle(), query, valid.mask, packet);
  if (packet.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const SurfaceHit hit = rt.resolve(packet.hit.instID[0][0], packet.hit.geomID[0],
                                    packet.hit.primID[0], {packet.hit.u[0], packet.hit.v[0]});
  return hit.object == object ? std::optional(hit) : std::nullopt;
}

vec3 point_of(const MeshShape& shape, const uvec3& triangle, const vec2& barycentric) {
  const float u = barycentric.x, v = barycentric.y;
  return (1.0f - u - v) * shape.positions[triangle.x] + u * shape.positions[triangle.y] +
         v * shape.positions[triangle.z];
}

}  // namespace

vec4 MotionVectors::at(const FrameInputs& inputs, const GBuffer& gbuffer, int x, int y) const {
  const Scene& scene = inputs.scene;
  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(gbuffer.width) + x;
  const int index = static_cast<int>(gbuffer.object[i]) - 1;
  if (index < 0) return vec4(0.0f);
  const Object& object = scene.objects[index];
  const Mesh& mesh = *scene.meshes[object.mesh];
  const vec3& now_ws = gbuffer.position[i];
  const vec3 now_os = glm::inverse(mat4(object.world_from_object)) * vec4(now_ws, 1.0f);
  vec3 then_os[2] = {now_os, now_os};  // in the first and the last state
  if (mesh.motion) {
    const auto hit = hit_of(rt_, CameraRays(inputs).ray(x, y), index);
    if (!hit) return vec4(0.0f);
    const uvec3& triangle = mesh.triangles[hit->triangle];
    then_os[0] = point_of(mesh.motion->front(), triangle, hit->barycentric);
    then_os[1] = point_of(mesh.motion->back(), triangle, hit->barycentric);
  }
  std::optional<vec2> then[2];
  for (int state = 0; state < 2; ++state) {
    const float time = static_cast<float>(state);
    const mat4x3 world_from_object =
        object.motion ? in_between(*object.motion, time) : object.world_from_object;
    const Camera camera =
        scene.camera_motion.empty() ? scene.camera : in_between(scene.camera_motion, time);
    then[state] = place_in_picture(camera, inputs, world_from_object * vec4(then_os[state], 1.0f));
  }
  const auto now = place_in_picture(scene.camera, inputs, now_ws);
  if (!now || !then[0] || !then[1]) return vec4(0.0f);
  return vec4(*then[0] - *now, *now - *then[1]);
}

void MotionVectors::run(const FrameInputs& inputs, GBuffer& gbuffer) {
  gbuffer.motion.resize(inputs.region.pixels());
  const Scene& scene = inputs.scene;
  const bool still = scene.settings.motion_blur || !anything_moves(scene);
  const size_t width = static_cast<size_t>(gbuffer.width);
  for_rows(inputs.region, [&](int y) {
    for (size_t x = 0; x < width; ++x) {
      gbuffer.motion[y * width + x] =
          still ? vec4(0.0f) : at(inputs, gbuffer, static_cast<int>(x), y);
    }
  });
}

}  // namespace kestrel
