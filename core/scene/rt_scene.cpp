// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/rt_scene.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "shading/surface.h"

namespace kestrel {
namespace {

/// What a filter function sees: the scene, through the geometry's user pointer.
const RtScene& rt_scene_of(const RTCFilterFunctionNArguments* args) {
  return *static_cast<const RtScene*>(args->geometryUserPtr);
}

SurfaceHit hit_of(const RTCFilterFunctionNArguments* args, unsigned i) {
  const unsigned object = args->context->instID[0];
  return {static_cast<int>(object), RTCHitN_primID(args->hit, args->N, i),
          vec2(RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i))};
}

/// Primary, reflection and refraction rays go through where a mask says there is no surface.
void skip_masked(const RTCFilterFunctionNArguments* args) {
  const Scene& scene = rt_scene_of(args).scene();
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const SurfaceHit hit = hit_of(args, i);
    const Object& object = scene.objects[hit.object];
    const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
    if (material.alpha_mode == AlphaMode::mask &&
        evaluate_alpha(scene, object, hit) < material.alpha_cutoff) {
      args->valid[i] = 0;
    }
  }
}

/// Listing 8b: a shadow ray loses light at every surface and ends when none is left.
void attenuate_shadow(const RTCFilterFunctionNArguments* args) {
  const Scene& scene = rt_scene_of(args).scene();
  embree::ShadowState* states = reinterpret_cast<embree::ShadowQuery*>(args->context)->states;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    embree::ShadowState& state = states[RTCRayN_id(args->ray, args->N, i)];
    const SurfaceHit hit = hit_of(args, i);
    if (state.enter(static_cast<uint32_t>(hit.object), RTCRayN_tfar(args->ray, args->N, i))) {
      state.transmitted *= shadow_transmission(scene, hit);
    }
    if (max_component(state.transmitted) > 0.0f) args->valid[i] = 0;
  }
}

bool object_needs_filter(const Scene& scene, const Object& object) {
  for (const int material : object.materials) {
    if (scene.materials[material].needs_any_hit()) return true;
  }
  return false;
}

void report_error(void*, RTCError code, const char* text) {
  log::warning("Embree error {}: {}", static_cast<int>(code), text ? text : "");
}

}  // namespace

bool embree::ShadowState::enter(uint32_t object, float distance) {
  constexpr float kSame = 2e-6f;  // relative; a few roundings of the intersection
  const uint32_t known = std::min<uint32_t>(crossings, kRemembered);
  for (uint32_t i = 0; i < known; ++i) {
    if (objects[i] == object && std::abs(distances[i] - distance) <= kSame * distance) return false;
  }
  distances[crossings % kRemembered] = distance;
  objects[crossings % kRemembered] = object;
  ++crossings;
  return true;
}

embree::DeviceHandle embree::new_device() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (!device) {
    fail(ErrorCode::unknown, "Embree could not start (error {}). It needs a processor with SSE2.",
         static_cast<int>(rtcGetDeviceError(nullptr)));
  }
  rtcSetDeviceErrorFunction(device, report_error, nullptr);
  return DeviceHandle(device);
}

void RtScene::update(const std::shared_ptr<const Scene>& scene) {
  if (scene == scene_) return;
  scene_ = scene;
  build_meshes();
  build_top();
}

void RtScene::build_meshes() {
  std::unordered_map<const Mesh*, bool> wanted;  // mesh, whether it needs filter functions
  for (const Object& object : scene_->objects) {
    const Mesh* mesh = scene_->meshes[object.mesh].get();
    wanted[mesh] = wanted[mesh] || object_needs_filter(*scene_, object);
  }
  std::erase_if(meshes_, [&](const auto& entry) { return !wanted.contains(entry.first); });

  std::vector<MeshEntry*> dirty;
  for (const auto& mesh : scene_->meshes) {
    const auto found = wanted.find(mesh.get());
    if (found == wanted.end()) continue;
    MeshEntry& entry = meshes_[mesh.get()];
    if (entry.scene && entry.filtered == found->second) continue;
    entry.mesh = mesh;
    entry.filtered = found->second;
    dirty.push_back(&entry);
  }
  tbb::parallel_for(size_t{0}, dirty.size(), [&](size_t i) {
    MeshEntry& entry = *dirty[i];
    const Mesh& mesh = *entry.mesh;
    if (!entry.scene) {
      RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 mesh.positions.data(), 0, sizeof(vec3), mesh.positions.size());
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                 mesh.triangles.data(), 0, sizeof(uvec3), mesh.triangles.size());
      rtcSetGeometryUserData(geometry, this);
      entry.scene.reset(rtcNewScene(device_));
      rtcSetSceneFlags(entry.scene.get(), RTC_SCENE_FLAG_ROBUST);
      rtcAttachGeometryByID(entry.scene.get(), geometry, 0);
      rtcReleaseGeometry(geometry);
      entry.geometry = geometry;
    }
    rtcSetGeometryIntersectFilterFunction(entry.geometry, entry.filtered ? skip_masked : nullptr);
    rtcSetGeometryOccludedFilterFunction(entry.geometry,
                                         entry.filtered ? attenuate_shadow : nullptr);
    rtcCommitGeometry(entry.geometry);
    rtcCommitScene(entry.scene.get());
  });
}

void RtScene::build_top() {
  top_.reset(rtcNewScene(device_));
  rtcSetSceneFlags(top_.get(), RTC_SCENE_FLAG_ROBUST);
  normal_from_object_.clear();
  for (size_t i = 0; i < scene_->objects.size(); ++i) {
    const Object& object = scene_->objects[i];
    normal_from_object_.push_back(glm::transpose(glm::inverse(mat3(object.world_from_object))));
    const MeshEntry& entry = meshes_.at(scene_->meshes[object.mesh].get());
    RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, entry.scene.get());
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            &object.world_from_object);
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(top_.get(), instance, static_cast<unsigned>(i));
    rtcReleaseGeometry(instance);
  }
  rtcCommitScene(top_.get());
  if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
    fail(error == RTC_ERROR_OUT_OF_MEMORY ? ErrorCode::out_of_memory : ErrorCode::unknown,
         "Embree could not build the scene (error {}). Try a scene with fewer triangles.",
         static_cast<int>(error));
  }
}

}  // namespace kestrel
