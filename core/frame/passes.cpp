// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/passes.h"

#include <cmath>
#include <cstring>
#include <deque>
#include <string>

#include "base/error.h"
#include "stages/blend.h"

namespace kestrel {
namespace {

constexpr int kUsualMattePasses = 3;

bool shows_nothing(const PassSource& from, size_t i) {
  return from.gbuffer.object[i] == 0;
}

template <typename T>
void store(const T& value, float* out) {
  std::memcpy(out, &value, sizeof(value));
}

template <auto Member>
void from_gbuffer(const PassSource& from, size_t i, float* out) {
  store((from.gbuffer.*Member)[i], out);
}
template <auto Member>
void from_ids(const PassSource& from, size_t i, float* out) {
  *out = static_cast<float>((from.gbuffer.*Member)[i]);
}
template <auto Member>
void from_effects(const PassSource& from, size_t i, float* out) {
  store((from.effects.*Member)[i], out);
}

void combined(const PassSource& from, size_t i, float* out) {
  store(from.combined[i], out);
}

/// Distance along the view, metres; 1e10 where there is nothing, as Cycles and EEVEE write it.
void linear_depth(const PassSource& from, size_t i, float* out) {
  const Camera& camera = from.inputs.scene.camera;
  const float n = camera.near_clip, f = camera.far_clip;
  const float reversed = from.gbuffer.depth[i];
  if (shows_nothing(from, i)) {
    *out = 1e10f;
  } else if (camera.projection == Projection::orthographic) {
    *out = f - reversed * (f - n);
  } else {
    *out = n * f / (reversed * (f - n) + n);
  }
}

/// How far a point is into the mist, 0 … 1. As in Cycles it goes by the distance from the camera,
/// in orthographic views by that along the view.
float mist_at(const PassSource& from, const vec3& position) {
  const Mist& mist = from.inputs.scene.world.mist;
  if (mist.depth <= 0.0f) return 0.0f;
  const Camera& camera = from.inputs.scene.camera;
  const vec3& backward = camera.world_from_camera[2];
  const float distance = camera.projection == Projection::orthographic
                             ? std::abs(glm::dot(camera.world_from_camera[3] - position, backward))
                             : from.camera.distance(position);
  const float share = glm::clamp((distance - mist.start) / mist.depth, 0.0f, 1.0f);
  return mist.falloff == 1.0f ? share : std::pow(share, mist.falloff);
}

/// 1 where there is nothing.
void mist(const PassSource& from, size_t i, float* out) {
  *out = 1.0f;
  if (shows_nothing(from, i)) return;
  const float covered = coverage(from.inputs.scene, from.gbuffer, i);
  *out -= covered * (1.0f - mist_at(from, from.gbuffer.position[i]));
  if (covered >= 1.0f) return;
  for (const SurfaceLayer& layer : layers_behind(from.gbuffer, i)) {
    *out -= layer.coverage * (1.0f - mist_at(from, layer.position));
  }
}

/// On the viewer's side of the surface, as other engines have it.
vec3 facing_normal(const PassSource& from, size_t i) {
  const auto width = static_cast<size_t>(from.gbuffer.width);
  const vec3 to_viewer = from.camera.to_viewer(
      from.gbuffer.position[i], static_cast<int>(i % width), static_cast<int>(i / width));
  const bool behind = glm::dot(from.gbuffer.normal_geometric[i], to_viewer) < 0.0f;
  return behind ? -from.gbuffer.normal[i] : from.gbuffer.normal[i];
}

void normal(const PassSource& from, size_t i, float* out) {
  store(shows_nothing(from, i) ? vec3(0.0f) : facing_normal(from, i), out);
}

/// In the camera's space, Z along the view, as Cycles has it.
void denoising_normal(const PassSource& from, size_t i, float* out) {
  vec3 n(0.0f);
  if (!shows_nothing(from, i)) {
    n = glm::transpose(mat3(from.inputs.scene.camera.world_from_camera)) * facing_normal(from, i);
    n.z = -n.z;
  }
  store(n, out);
}

/// What the surface gives back of even light, 0 … 1: its own colour, and the tints of what it
/// mirrors and lets through, as the blend stage weighs them. Of the world its colour, as in Cycles.
void denoising_albedo(const PassSource& from, size_t i, float* out) {
  vec3 albedo = from.gbuffer.lighting[i];  // the world
  if (!shows_nothing(from, i)) {
    const Material& material = from.inputs.scene.materials[from.gbuffer.material[i]];
    const vec3& optical = from.gbuffer.optical[i];
    const BlendWeights w = blend_weights(optical.x, 1.0f - optical.z);
    albedo =
        w.surface * glm::max(vec3(from.gbuffer.diffuse[i]), from.gbuffer.ambient[i]) +
        w.reflection * (from.gbuffer.reflection_color.empty() ? material.reflection_color
                                                              : from.gbuffer.reflection_color[i]) +
        w.refraction * (from.gbuffer.transmission_color.empty()
                            ? material.transmission_color
                            : from.gbuffer.transmission_color[i]);
  }
  store(glm::clamp(albedo, 0.0f, 1.0f), out);
}

/// U, V and 1; 0 where the mesh has no UV map.
void uv(const PassSource& from, size_t i, float* out) {
  const Scene& scene = from.inputs.scene;
  const uint32_t object = from.gbuffer.object[i];
  const bool mapped =
      object != 0 && !scene.meshes[scene.objects[object - 1].mesh]->corner_uvs.empty();
  store(mapped ? vec3(from.gbuffer.uv[i].x, from.gbuffer.uv[i].y, 1.0f) : vec3(0.0f), out);
}

void object_index(const PassSource& from, size_t i, float* out) {
  const uint32_t object = from.gbuffer.object[i];
  const Scene& scene = from.inputs.scene;
  *out = object == 0 ? 0.0f : static_cast<float>(scene.objects[object - 1].pass_index);
}

void material_index(const PassSource& from, size_t i, float* out) {
  const Scene& scene = from.inputs.scene;
  *out = shows_nothing(from, i)
             ? 0.0f
             : static_cast<float>(scene.materials[from.gbuffer.material[i]].pass_index);
}

/// CryptoObject00 and so on.
void add_matte_rows(std::vector<PassRow>& rows, MatteKind kind) {
  static std::deque<std::string> names;  // rows point to them
  for (int depth = 0; depth < kMattePasses; ++depth) {
    names.push_back(fmt::format("{}{:02}", matte_layer(kind), depth));
    // Lower case, as Cycles has them: writers compress what is called RGBA as colours, with losses.
    rows.push_back({{names.back().c_str(), "rgba"}, Gathering::matte, nullptr, kind, depth});
  }
}

std::vector<PassRow> make_rows() {
  using G = GBuffer;
  using E = EffectBuffers;
  std::vector<PassRow> rows = {
      {{"Combined", "RGBA"}, Gathering::averaged, combined},
      {{"Depth", "Z"}, Gathering::first, linear_depth},
      {{"ReversedDepth", "Z"}, Gathering::first, from_gbuffer<&G::depth>},
      {{"Mist", "Z"}, Gathering::averaged, mist},
      {{"Position", "XYZ"}, Gathering::first, from_gbuffer<&G::position>},
      {{"Normal", "XYZ"}, Gathering::averaged, normal},
      {{"UV", "UVA"}, Gathering::averaged, uv},
      {{"Emission", "RGB"}, Gathering::averaged, from_gbuffer<&G::emission>},
      {{"Ambient", "RGB"}, Gathering::averaged, from_gbuffer<&G::ambient>},
      {{"Diffuse", "RGBA"}, Gathering::averaged, from_gbuffer<&G::diffuse>},
      {{"Specular", "RGBA"}, Gathering::averaged, from_gbuffer<&G::specular>},
      {{"Optical", "RGB"}, Gathering::averaged, from_gbuffer<&G::optical>},
      {{"HeuristicMask", "X"}, Gathering::first, from_gbuffer<&G::heuristic_mask>},
      {{"ObjectId", "X"}, Gathering::first, from_ids<&G::object>},
      {{"MaterialId", "X"}, Gathering::first, from_ids<&G::material>},
      {{"ObjectIndex", "X"}, Gathering::first, object_index},
      {{"MaterialIndex", "X"}, Gathering::first, material_index},
      {{"Lighting", "RGB"}, Gathering::averaged, from_gbuffer<&G::lighting>},
      {{"Shadow", "RGB"}, Gathering::averaged, from_effects<&E::shadow>},
      {{"Reflection", "RGB"}, Gathering::averaged, from_effects<&E::reflection>},
      {{"Refraction", "RGB"}, Gathering::averaged, from_effects<&E::refraction>},
      {{"Vector", "XYZW"}, Gathering::first, from_gbuffer<&G::motion>},
      {{"DenoisingNormal", "XYZ"}, Gathering::averaged, denoising_normal},
      {{"DenoisingAlbedo", "RGB"}, Gathering::averaged, denoising_albedo},
  };
  for (const MatteKind kind : {MatteKind::object, MatteKind::material, MatteKind::asset}) {
    add_matte_rows(rows, kind);
  }
  return rows;
}

}  // namespace

const std::vector<PassRow>& pass_rows() {
  static const std::vector<PassRow> rows = make_rows();
  return rows;
}

const std::vector<PassInfo>& pass_table() {
  static const std::vector<PassInfo> table = [] {
    std::vector<PassInfo> infos;
    for (const PassRow& row : pass_rows()) infos.push_back(row.info);
    return infos;
  }();
  return table;
}

size_t find_pass_row(std::string_view name) {
  std::string known;
  for (size_t i = 0; i < pass_rows().size(); ++i) {
    const PassRow& row = pass_rows()[i];
    if (row.info.name == name) return i;
    known += std::string(known.empty() ? "" : ", ") + row.info.name;
  }
  fail(ErrorCode::invalid_argument, "There is no pass '{}'. Passes: {}.", name, known);
}

bool in_all(const PassInfo& pass) {
  return pass_rows()[find_pass_row(pass.name)].depth < kUsualMattePasses;
}

}  // namespace kestrel
