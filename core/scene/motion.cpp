// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/motion.h"

#include <algorithm>

#include "scene/mesh_validation.h"

namespace kestrel {
namespace {

vec3 unit(const vec3& v, const vec3& fallback) {
  const float squared = glm::dot(v, v);
  return squared > 1e-30f ? v * glm::inversesqrt(squared) : fallback;
}

std::shared_ptr<const Mesh> mesh_at(const Mesh& mesh, float time) {
  const Step step = step_at(mesh.motion->size(), time);
  const MeshShape &a = (*mesh.motion)[step.index], &b = (*mesh.motion)[step.index + 1];
  auto out = std::make_shared<Mesh>(mesh);
  pad_positions(*out);
  out->bounds = {};
  for (size_t i = 0; i < out->positions.size(); ++i) {
    out->positions[i] = glm::mix(a.positions[i], b.positions[i], step.share);
    out->bounds.extend(out->positions[i]);
  }
  for (size_t i = 0; i < out->corner_normals.size(); ++i) {
    const vec3 normal = glm::mix(a.corner_normals[i], b.corner_normals[i], step.share);
    out->corner_normals[i] = unit(normal, a.corner_normals[i]);
  }
  return out;
}

}  // namespace

std::shared_ptr<const ObjectMotion> motion_from(const std::vector<mat4x3>& matrices) {
  const auto same = [&](const mat4x3& m) { return m == matrices.front(); };
  if (std::all_of(matrices.begin(), matrices.end(), same)) return nullptr;
  return std::make_shared<const ObjectMotion>(poses_from(matrices));
}

bool anything_moves(const Scene& scene) {
  return !scene.camera_motion.empty() ||
         std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return object.motion != nullptr; }) ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const auto& mesh) { return mesh->motion != nullptr; });
}

Camera in_between(const std::vector<Camera>& states, float time) {
  const Step step = step_at(states.size(), time);
  const Camera &a = states[step.index], &b = states[step.index + 1];
  Camera out = a;
  out.world_from_camera =
      in_between(poses_from({a.world_from_camera, b.world_from_camera}), step.share);
  for (float Camera::*field :
       {&Camera::left, &Camera::right, &Camera::bottom, &Camera::top, &Camera::near_clip,
        &Camera::far_clip, &Camera::focus_distance, &Camera::aperture_radius,
        &Camera::aperture_rotation, &Camera::aperture_ratio}) {
    out.*field = glm::mix(a.*field, b.*field, step.share);
  }
  return out;
}

std::shared_ptr<const Scene> scene_at(const Scene& scene, float time) {
  auto out = std::make_shared<Scene>(scene);
  if (!scene.camera_motion.empty()) out->camera = in_between(scene.camera_motion, time);
  for (Object& object : out->objects) {
    if (object.motion) object.world_from_object = in_between(*object.motion, time);
  }
  for (std::shared_ptr<const Mesh>& mesh : out->meshes) {
    if (mesh->motion) mesh = mesh_at(*mesh, time);
  }
  return out;
}

}  // namespace kestrel
