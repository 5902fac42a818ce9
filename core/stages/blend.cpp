// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/blend.h"

#include "frame/region_loops.h"

namespace kestrel {
namespace {

/// Whether the picture has a hole at a pixel that shows nothing.
bool is_hole(const Scene& scene, const GBuffer& gbuffer, size_t i) {
  return scene.settings.film_transparent || (scene.has_holdouts && gbuffer.holdout[i]);
}

}  // namespace

vec3 blend_pixel(const vec3& lighting, const vec3& shadow, const vec3& reflection,
                 const vec3& refraction, float reflectivity, float transparency) {
  const vec3 surface = glm::max(lighting - (1.0f - shadow), vec3(0.0f));
  const BlendWeights w = blend_weights(reflectivity, transparency);
  return w.surface * surface + w.reflection * reflection + w.refraction * refraction;
}

void BlendStage::run(const FrameInputs& inputs, const GBuffer& gbuffer, const Selection& selection,
                     const EffectBuffers& effects, Plane<vec4>& combined) {
  combined.resize(inputs.region.pixels());
  const size_t width = static_cast<size_t>(inputs.region.width);
  for_rows(inputs.region, [&](int y) {
    for (size_t i = y * width; i < (y + 1) * width; ++i) {
      const uint32_t object = gbuffer.object[i];
      const uint8_t traced =
          object == 0 ? 0 : selection.units[inputs.scene.objects[object - 1].unit].effects;
      const float reflectivity = traced & kReflections ? gbuffer.optical[i].x : 0.0f;
      const float transparency = traced & kRefractions ? 1.0f - gbuffer.optical[i].z : 0.0f;
      combined[i] = vec4(blend_pixel(gbuffer.lighting[i], effects.shadow[i], effects.reflection[i],
                                     effects.refraction[i], reflectivity, transparency),
                         1.0f);
      if (!inputs.scene.has_alpha()) continue;
      if (object == 0) {
        if (is_hole(inputs.scene, gbuffer, i)) combined[i] = vec4(0.0f);
      } else {
        combined[i].w -= blend_weights(reflectivity, transparency).refraction * effects.clear[i];
      }
    }
  });
}

}  // namespace kestrel
