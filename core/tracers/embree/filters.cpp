// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracers/embree/filters.h"

#include "scene/rt_scene.h"
#include "tracers/embree/shadow_query.h"

namespace kestrel::embree {
namespace {

const RtScene& rt_scene_of(const RTCFilterFunctionNArguments* args) {
  return *static_cast<const RtScene*>(args->geometryUserPtr);
}

SurfaceHit hit_of(const RTCFilterFunctionNArguments* args, unsigned i) {
  const unsigned n = args->N;
  return rt_scene_of(args).resolve(args->context->instID[0], RTCHitN_geomID(args->hit, n, i),
                                   RTCHitN_primID(args->hit, n, i),
                                   vec2(RTCHitN_u(args->hit, n, i), RTCHitN_v(args->hit, n, i)));
}

Look look_of(const RTCFilterFunctionNArguments* args, unsigned i) {
  const unsigned n = args->N;
  const vec3 direction(RTCRayN_dir_x(args->ray, n, i), RTCRayN_dir_y(args->ray, n, i),
                       RTCRayN_dir_z(args->ray, n, i));
  return {direction, RTCRayN_tfar(args->ray, n, i),
          static_cast<uint8_t>(RTCRayN_mask(args->ray, n, i)), 0};
}

}  // namespace

void skip_masked(const RTCFilterFunctionNArguments* args) {
  const Scene& scene = rt_scene_of(args).scene();
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const SurfaceHit hit = hit_of(args, i);
    const Object& object = scene.objects[hit.object];
    const Material& material = scene.materials[material_of(scene, object, hit.triangle)];
    if (material.alpha_mode == AlphaMode::mask &&
        evaluate_alpha(scene, hit, rt_scene_of(args).normal_from_object()[hit.object],
                       look_of(args, i)) < material.alpha_cutoff) {
      args->valid[i] = 0;
    }
  }
}

void attenuate_shadow(const RTCFilterFunctionNArguments* args) {
  const Scene& scene = rt_scene_of(args).scene();
  ShadowState* states = reinterpret_cast<ShadowQuery*>(args->context)->states;
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    ShadowState& state = states[RTCRayN_id(args->ray, args->N, i)];
    const SurfaceHit hit = hit_of(args, i);
    if (state.enter(hit.object, RTCRayN_tfar(args->ray, args->N, i))) {
      state.transmitted *= shadow_transmission(
          scene, hit, rt_scene_of(args).normal_from_object()[hit.object], look_of(args, i));
    }
    if (max_component(state.transmitted) > 0.0f) args->valid[i] = 0;
  }
}

}  // namespace kestrel::embree
