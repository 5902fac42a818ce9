// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/film.h"

#include <tbb/parallel_for.h>

#include <string>

#include "base/error.h"

namespace kestrel {
namespace {

template <typename T>
void add(std::vector<T>& sum, const std::vector<T>& more) {
  constexpr size_t kChunk = 1 << 16;
  tbb::parallel_for(size_t{0}, (sum.size() + kChunk - 1) / kChunk, [&](size_t chunk) {
    const size_t end = std::min(sum.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i) sum[i] += more[i];
  });
}

/// The same for scalars and vectors.
template <typename T>
std::vector<float> flatten(const std::vector<T>& plane, float scale) {
  constexpr size_t kChannels = sizeof(T) / 4;
  std::vector<float> out(plane.size() * kChannels);
  for (size_t i = 0; i < plane.size(); ++i) {
    if constexpr (kChannels == 1) {
      out[i] = static_cast<float>(plane[i]) * scale;
    } else {
      for (size_t c = 0; c < kChannels; ++c) {
        out[kChannels * i + c] = plane[i][static_cast<int>(c)] * scale;
      }
    }
  }
  return out;
}

}  // namespace

const std::vector<PassInfo>& pass_table() {
  static const std::vector<PassInfo> table = {
      {"ReversedDepth", "Z"}, {"Combined", "RGBA"}, {"Depth", "Z"},         {"Position", "XYZ"},
      {"Normal", "XYZ"},      {"Emission", "RGB"},  {"Ambient", "RGB"},     {"Diffuse", "RGBA"},
      {"Specular", "RGBA"},   {"Optical", "RGB"},   {"HeuristicMask", "X"}, {"ObjectId", "X"},
      {"MaterialId", "X"},    {"Lighting", "RGB"},  {"Shadow", "RGB"},      {"Reflection", "RGB"},
      {"Refraction", "RGB"},
  };
  return table;
}

void Film::add_sample(const FrameInputs& inputs, GBuffer& gbuffer, EffectBuffers& effects,
                      std::vector<vec4>& combined) {
  if (samples_++ == 0) {
    camera_ = inputs.scene.camera;
    std::swap(gbuffer_, gbuffer);
    std::swap(effects_, effects);
    std::swap(combined_, combined);
    return;
  }
  add(combined_, combined);
  add(gbuffer_.emission, gbuffer.emission);
  add(gbuffer_.ambient, gbuffer.ambient);
  add(gbuffer_.diffuse, gbuffer.diffuse);
  add(gbuffer_.specular, gbuffer.specular);
  add(gbuffer_.optical, gbuffer.optical);
  add(gbuffer_.lighting, gbuffer.lighting);
  add(effects_.shadow, effects.shadow);
  add(effects_.reflection, effects.reflection);
  add(effects_.refraction, effects.refraction);
}

std::vector<float> Film::linear_depth() const {
  constexpr float kNothing = 1e10f;  // as Cycles and EEVEE write it
  const float n = camera_.near_clip, f = camera_.far_clip;
  std::vector<float> out(gbuffer_.depth.size(), kNothing);
  for (size_t i = 0; i < out.size(); ++i) {
    if (gbuffer_.object[i] == 0) continue;
    const float reversed = gbuffer_.depth[i];
    out[i] = camera_.projection == Projection::orthographic ? f - reversed * (f - n)
                                                            : n * f / (reversed * (f - n) + n);
  }
  return out;
}

std::vector<float> Film::pass(std::string_view name) const {
  const float average = samples_ > 0 ? 1.0f / static_cast<float>(samples_) : 0.0f;
  const GBuffer& g = gbuffer_;
  if (name == "Combined") return flatten(combined_, average);
  if (name == "Depth") return linear_depth();
  if (name == "ReversedDepth") return flatten(g.depth, 1.0f);
  if (name == "Position") return flatten(g.position, 1.0f);
  if (name == "Normal") return flatten(g.normal, 1.0f);
  if (name == "Emission") return flatten(g.emission, average);
  if (name == "Ambient") return flatten(g.ambient, average);
  if (name == "Diffuse") return flatten(g.diffuse, average);
  if (name == "Specular") return flatten(g.specular, average);
  if (name == "Optical") return flatten(g.optical, average);
  if (name == "HeuristicMask") return flatten(g.heuristic_mask, 1.0f);
  if (name == "ObjectId") return flatten(g.object, 1.0f);
  if (name == "MaterialId") return flatten(g.material, 1.0f);
  if (name == "Lighting") return flatten(g.lighting, average);
  if (name == "Shadow") return flatten(effects_.shadow, average);
  if (name == "Reflection") return flatten(effects_.reflection, average);
  if (name == "Refraction") return flatten(effects_.refraction, average);
  std::string known;
  for (const PassInfo& p : pass_table()) known += std::string(known.empty() ? "" : ", ") + p.name;
  fail(ErrorCode::invalid_argument, "There is no pass '{}'. Passes: {}.", name, known);
}

}  // namespace kestrel
