// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/film.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "frame/region_loops.h"

namespace kestrel {
namespace {

/// Where samples come from.
struct Sources {
  const Camera& camera;
  const GBuffer& gbuffer;
  const EffectBuffers& effects;
  const Plane<vec4>& combined;
};

/// Distance along the view, metres; 1e10 where there is nothing, as Cycles and EEVEE write it.
float linear_depth(const Sources& from, size_t i) {
  if (from.gbuffer.object[i] == 0) return 1e10f;
  const float n = from.camera.near_clip, f = from.camera.far_clip;
  const float reversed = from.gbuffer.depth[i];
  return from.camera.projection == Projection::orthographic ? f - reversed * (f - n)
                                                            : n * f / (reversed * (f - n) + n);
}

/// How a pass gets its values; `averaged` over the samples, or those of the first.
struct PassRow {
  PassInfo info;
  bool averaged;
  void (*get)(const Sources& from, size_t i, float* out);
};

template <auto Member>
void from_gbuffer(const Sources& from, size_t i, float* out) {
  const auto& value = (from.gbuffer.*Member)[i];
  std::memcpy(out, &value, sizeof(value));
}
template <auto Member>
void from_ids(const Sources& from, size_t i, float* out) {
  *out = static_cast<float>((from.gbuffer.*Member)[i]);
}
template <auto Member>
void from_effects(const Sources& from, size_t i, float* out) {
  std::memcpy(out, &(from.effects.*Member)[i], sizeof(vec3));
}

const std::vector<PassRow>& pass_rows() {
  using G = GBuffer;
  using E = EffectBuffers;
  static const std::vector<PassRow> rows = {
      {{"Combined", "RGBA"},
       true,
       [](const Sources& from, size_t i, float* out) {
         std::memcpy(out, &from.combined[i], sizeof(vec4));
       }},
      {{"Depth", "Z"},
       false,
       [](const Sources& from, size_t i, float* out) { *out = linear_depth(from, i); }},
      {{"ReversedDepth", "Z"}, false, from_gbuffer<&G::depth>},
      {{"Position", "XYZ"}, false, from_gbuffer<&G::position>},
      {{"Normal", "XYZ"}, false, from_gbuffer<&G::normal>},
      {{"Emission", "RGB"}, true, from_gbuffer<&G::emission>},
      {{"Ambient", "RGB"}, true, from_gbuffer<&G::ambient>},
      {{"Diffuse", "RGBA"}, true, from_gbuffer<&G::diffuse>},
      {{"Specular", "RGBA"}, true, from_gbuffer<&G::specular>},
      {{"Optical", "RGB"}, true, from_gbuffer<&G::optical>},
      {{"HeuristicMask", "X"}, false, from_gbuffer<&G::heuristic_mask>},
      {{"ObjectId", "X"}, false, from_ids<&G::object>},
      {{"MaterialId", "X"}, false, from_ids<&G::material>},
      {{"Lighting", "RGB"}, true, from_gbuffer<&G::lighting>},
      {{"Shadow", "RGB"}, true, from_effects<&E::shadow>},
      {{"Reflection", "RGB"}, true, from_effects<&E::reflection>},
      {{"Refraction", "RGB"}, true, from_effects<&E::refraction>},
      {{"Vector", "XYZW"}, false, from_gbuffer<&G::motion>},
  };
  return rows;
}

[[noreturn]] void unknown_pass(std::string_view name) {
  std::string known;
  for (const PassInfo& p : pass_table()) known += std::string(known.empty() ? "" : ", ") + p.name;
  fail(ErrorCode::invalid_argument, "There is no pass '{}'. Passes: {}.", name, known);
}

size_t find_row(std::string_view name) {
  for (size_t i = 0; i < pass_rows().size(); ++i) {
    if (pass_rows()[i].info.name == name) return i;
  }
  unknown_pass(name);
}

}  // namespace

const std::vector<PassInfo>& pass_table() {
  static const std::vector<PassInfo> table = [] {
    std::vector<PassInfo> infos;
    for (const PassRow& row : pass_rows()) infos.push_back(row.info);
    return infos;
  }();
  return table;
}

Film::Film(int width, int height, const std::vector<std::string>& wanted)
    : width_(width), height_(height), tiles_(std::make_unique<Tile[]>(tile_count(whole()))) {
  for (const std::string& name : wanted) {
    const size_t row = find_row(name);
    const size_t channels = std::strlen(pass_rows()[row].info.channels);
    passes_.push_back({row, channels, {}});
    passes_.back().sums.resize(static_cast<size_t>(width) * static_cast<size_t>(height) * channels);
  }
}

Film::Tile& Film::tile_at(int x, int y) const {
  const int columns = (width_ + kTileSize - 1) / kTileSize;
  return tiles_[y / kTileSize * columns + x / kTileSize];
}

void Film::add(const FrameInputs& inputs, int sample, const GBuffer& gbuffer,
               const EffectBuffers& effects, const Plane<vec4>& combined) {
  for_tiles(inputs.region, [&](const Region& tile) {
    add_tile(inputs, tile, sample, gbuffer, effects, combined);
  });
}

void Film::add_tile(const FrameInputs& inputs, const Region& tile, int sample,
                    const GBuffer& gbuffer, const EffectBuffers& effects,
                    const Plane<vec4>& combined) {
  const Sources from{inputs.scene.camera, gbuffer, effects, combined};
  const Region& region = inputs.region;
  Tile& state = tile_at(tile.x, tile.y);
  const tbb::spin_mutex::scoped_lock lock(state.mutex);
  for (int y = tile.y; y < tile.y + tile.height; ++y) {
    const size_t first =
        static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(tile.x);
    const size_t first_in_region =
        static_cast<size_t>(y - region.y) * static_cast<size_t>(region.width) +
        static_cast<size_t>(tile.x - region.x);
    for (Channel& pass : passes_) {
      const PassRow& source = pass_rows()[pass.pass];
      if (sample > 0 && !source.averaged) continue;
      float* out = &pass.sums[first * pass.channels];
      for (size_t x = 0; x < static_cast<size_t>(tile.width); ++x, out += pass.channels) {
        float value[4];
        source.get(from, first_in_region + x, value);
        for (size_t c = 0; c < pass.channels; ++c) out[c] = sample ? out[c] + value[c] : value[c];
      }
    }
  }
  state.samples = sample + 1;
}

void Film::copy_so_far(std::string_view name, float* out) const {
  const Channel& pass = find(name);
  const bool averaged = pass_rows()[pass.pass].averaged;
  for (int y0 = 0; y0 < height_; y0 += kTileSize) {
    for (int x0 = 0; x0 < width_; x0 += kTileSize) {
      Tile& tile = tile_at(x0, y0);
      const tbb::spin_mutex::scoped_lock lock(tile.mutex);
      if (tile.samples == 0) continue;
      const float scale = averaged ? 1.0f / static_cast<float>(tile.samples) : 1.0f;
      const size_t count = static_cast<size_t>(std::min(kTileSize, width_ - x0)) * pass.channels;
      for (int y = y0; y < std::min(y0 + kTileSize, height_); ++y) {
        const size_t first =
            (static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x0)) *
            pass.channels;
        for (size_t i = first; i < first + count; ++i) out[i] = pass.sums[i] * scale;
      }
    }
  }
}

const Film::Channel& Film::find(std::string_view name) const {
  const size_t row = find_row(name);
  for (const Channel& pass : passes_) {
    if (pass.pass == row) return pass;
  }
  fail(ErrorCode::invalid_argument,
       "The pass '{}' was not rendered. Ask for it before rendering (kestrelSetPasses).", name);
}

bool Film::has(std::string_view name) const {
  const size_t row = find_row(name);
  return std::any_of(passes_.begin(), passes_.end(),
                     [row](const Channel& pass) { return pass.pass == row; });
}

size_t Film::float_count(std::string_view name) const {
  return find(name).sums.size();
}

void Film::finish(int samples) {
  const int tiles = tile_count(whole());
  for (int i = 0; i < tiles; ++i) tiles_[i].samples = 1;
  if (samples < 2) return;
  const float scale = 1.0f / static_cast<float>(samples);
  for (Channel& pass : passes_) {
    if (!pass_rows()[pass.pass].averaged) continue;
    for (float& value : pass.sums) value *= scale;
  }
}

std::vector<float> Film::pass(std::string_view name) const {
  const float* first = data(name);
  return std::vector<float>(first, first + float_count(name));
}

}  // namespace kestrel
