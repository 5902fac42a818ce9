// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/film.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "frame/region_loops.h"

namespace kestrel {
namespace {

/// A row of a tile.
struct Row {
  size_t in_picture;  // index of its first pixel
  size_t in_region;   // the same in the stages' planes
  size_t width;       // pixels
};

/// Adds samples to the mattes.
void add_matte_row(const PassSource& from, const MatteIds& ids, const MatteSlots& slots,
                   const Row& row) {
  const GBuffer& gbuffer = from.gbuffer;
  for (size_t x = 0; x < row.width; ++x) {
    const size_t i = row.in_region + x, pixel = row.in_picture + x;
    if (gbuffer.object[i] == 0) continue;
    const float covered = coverage(from.inputs.scene, gbuffer, i);
    slots.add(pixel, ids.of(gbuffer.object[i], gbuffer.material[i]), covered);
    if (covered >= 1.0f) continue;
    for (const SurfaceLayer& layer : layers_behind(gbuffer, i)) {
      slots.add(pixel, ids.of(layer.object, layer.material), layer.coverage);
    }
  }
}

/// Adds samples to another pass.
void add_row(const PassSource& from, const PassRow& pass, size_t channels, int sample,
             const Row& row, float* out) {
  for (size_t x = 0; x < row.width; ++x, out += channels) {
    float value[4];
    pass.get(from, row.in_region + x, value);
    for (size_t c = 0; c < channels; ++c) out[c] = sample ? out[c] + value[c] : value[c];
  }
}

}  // namespace

Film::Film(int width, int height, const std::vector<std::string>& wanted, const Scene& scene)
    : width_(width), height_(height), tiles_(std::make_unique<Tile[]>(tile_count(whole()))) {
  for (const std::string& name : wanted) {
    const size_t row = find_pass_row(name);
    for (size_t depth = pass_rows()[row].depth; depth > 0; --depth) add_channel(row - depth);
    add_channel(row);
  }
  add_mattes(scene);
}

void Film::add_channel(size_t row) {
  const auto is_row = [row](const Channel& pass) { return pass.pass == row; };
  if (std::any_of(passes_.begin(), passes_.end(), is_row)) return;
  const size_t channels = std::strlen(pass_rows()[row].info.channels);
  passes_.push_back({row, channels, {}});
  passes_.back().sums.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_) * channels);
}

void Film::add_mattes(const Scene& scene) {
  std::vector<float*> planes[kMatteKinds];  // by kind, by depth
  for (size_t row = 0; row < pass_rows().size(); ++row) {
    const PassRow& source = pass_rows()[row];
    if (source.gathering != Gathering::matte) continue;
    for (Channel& pass : passes_) {
      if (pass.pass == row) planes[static_cast<int>(source.matte)].push_back(pass.sums.data());
    }
  }
  for (int kind = 0; kind < kMatteKinds; ++kind) {
    if (planes[kind].empty()) continue;
    mattes_[kind].emplace(MatteIds(scene, static_cast<MatteKind>(kind)), MatteSlots(planes[kind]));
  }
}

Film::Tile& Film::tile_at(int x, int y) const {
  const int columns = (width_ + kTileSize - 1) / kTileSize;
  return tiles_[y / kTileSize * columns + x / kTileSize];
}

void Film::add(const FrameInputs& inputs, int sample, const GBuffer& gbuffer,
               const EffectBuffers& effects, const Plane<vec4>& combined) {
  const CameraRays camera(inputs);
  const PassSource from{inputs, camera, gbuffer, effects, combined};
  for_tiles(inputs.region, [&](const Region& tile) { add_tile(from, tile, sample); });
}

void Film::add_tile(const PassSource& from, const Region& tile, int sample) {
  const Region& region = from.inputs.region;
  Tile& state = tile_at(tile.x, tile.y);
  const tbb::spin_mutex::scoped_lock lock(state.mutex);
  for (int y = tile.y; y < tile.y + tile.height; ++y) {
    const Row row{
        static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(tile.x),
        static_cast<size_t>(y - region.y) * static_cast<size_t>(region.width) +
            static_cast<size_t>(tile.x - region.x),
        static_cast<size_t>(tile.width)};
    for (Channel& pass : passes_) {
      const PassRow& source = pass_rows()[pass.pass];
      float* out = &pass.sums[row.in_picture * pass.channels];
      if (source.gathering == Gathering::matte) {
        if (sample == 0) std::fill_n(out, row.width * pass.channels, 0.0f);
      } else if (sample == 0 || source.gathering == Gathering::averaged) {
        add_row(from, source, pass.channels, sample, row, out);
      }
    }
    for (const auto& matte : mattes_) {
      if (matte) add_matte_row(from, matte->ids, matte->slots, row);
    }
  }
  state.samples = sample + 1;
}

void Film::copy_so_far(std::string_view name, float* out) const {
  const Channel& pass = find(name);
  const Gathering gathering = pass_rows()[pass.pass].gathering;
  for (int y0 = 0; y0 < height_; y0 += kTileSize) {
    for (int x0 = 0; x0 < width_; x0 += kTileSize) {
      Tile& tile = tile_at(x0, y0);
      const tbb::spin_mutex::scoped_lock lock(tile.mutex);
      if (tile.samples == 0) continue;
      const float mean = 1.0f / static_cast<float>(tile.samples);
      // Of Cryptomatte's pairs the second numbers are sums.
      const float even = gathering == Gathering::averaged ? mean : 1.0f;
      const float odd = gathering == Gathering::first ? 1.0f : mean;
      const size_t count = static_cast<size_t>(std::min(kTileSize, width_ - x0)) * pass.channels;
      for (int y = y0; y < std::min(y0 + kTileSize, height_); ++y) {
        const size_t first =
            (static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x0)) *
            pass.channels;
        for (size_t i = 0; i < count; ++i) {
          out[first + i] = pass.sums[first + i] * (i % 2 ? odd : even);
        }
      }
    }
  }
}

const Film::Channel& Film::find(std::string_view name) const {
  const size_t row = find_pass_row(name);
  for (const Channel& pass : passes_) {
    if (pass.pass == row) return pass;
  }
  fail(ErrorCode::invalid_argument,
       "The pass '{}' was not rendered. Ask for it before rendering (kestrelSetPasses).", name);
}

bool Film::wants_layers() const {
  return has("Mist") || std::any_of(std::begin(mattes_), std::end(mattes_),
                                    [](const auto& matte) { return matte.has_value(); });
}

bool Film::has(std::string_view name) const {
  const size_t row = find_pass_row(name);
  return std::any_of(passes_.begin(), passes_.end(),
                     [row](const Channel& pass) { return pass.pass == row; });
}

size_t Film::float_count(std::string_view name) const {
  return find(name).sums.size();
}

void Film::finish(int samples) {
  const int tiles = tile_count(whole());
  for (int i = 0; i < tiles; ++i) tiles_[i].samples = 1;
  const float scale = 1.0f / static_cast<float>(samples);
  for (const auto& matte : mattes_) {
    if (!matte) continue;
    for_rows({0, 0, width_, height_}, [&](int y) {
      const size_t width = static_cast<size_t>(width_), first = static_cast<size_t>(y) * width;
      for (size_t i = first; i < first + width; ++i) matte->slots.finish(i, scale);
    });
  }
  if (samples < 2) return;
  for (Channel& pass : passes_) {
    if (pass_rows()[pass.pass].gathering != Gathering::averaged) continue;
    for (float& value : pass.sums) value *= scale;
  }
}

std::vector<float> Film::pass(std::string_view name) const {
  const float* first = data(name);
  return std::vector<float>(first, first + float_count(name));
}

std::vector<std::pair<std::string, std::string>> Film::matte_attributes() const {
  std::vector<std::pair<std::string, std::string>> attributes;
  for (int kind = 0; kind < kMatteKinds; ++kind) {
    if (!mattes_[kind]) continue;
    const std::string layer = matte_layer(static_cast<MatteKind>(kind));
    const std::string key =
        "cryptomatte/" + fmt::format("{:08x}", murmur_hash3(layer)).substr(0, 7) + "/";
    attributes.emplace_back(key + "name", layer);
    attributes.emplace_back(key + "hash", "MurmurHash3_32");
    attributes.emplace_back(key + "conversion", "uint32_to_float32");
    attributes.emplace_back(key + "manifest", mattes_[kind]->ids.manifest());
  }
  return attributes;
}

const std::string* Film::manifest(MatteKind kind) const {
  const auto& matte = mattes_[static_cast<int>(kind)];
  return matte ? &matte->ids.manifest() : nullptr;
}

}  // namespace kestrel
