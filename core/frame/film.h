// SPDX-License-Identifier: GPL-3.0-or-later
// The finished picture: Combined and every buffer between the stages, as passes.
#pragma once

#include <tbb/spin_mutex.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frame/passes.h"

namespace kestrel {

/// Accumulates samples of the passes that are wanted; the others need no memory. Colours are
/// averaged over the samples; depth, position, ids and the mask are those of the first sample,
/// which lies in the pixel's centre.
class Film {
 public:
  Film() = default;
  /// A Cryptomatte pass brings those before it along. Throws Error(invalid_argument) for a name
  /// that is not in the table.
  Film(int width, int height, const std::vector<std::string>& wanted, const Scene& scene);

  /// Adds the region of `inputs` of sample `sample`; sample 0 comes first. Different regions may
  /// be added at the same time.
  void add(const FrameInputs& inputs, int sample, const GBuffer& gbuffer,
           const EffectBuffers& effects, const Plane<vec4>& combined);

  /// Turns the sums of so many samples into averages. Nothing is added any more.
  void finish(int samples);

  /// Copies a pass as far as it is, averaged over the samples of each pixel so far; where there is
  /// none yet, `out` (float_count() floats) stays as it is. Also while others add: tile after tile,
  /// each of which waits for that alone. Cryptomatte's pairs are not sorted yet. Throws as data().
  void copy_so_far(std::string_view name, float* out) const;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Whether some pass needs GBuffer::behind.
  bool wants_layers() const;
  /// Whether a pass is kept. Throws Error(invalid_argument) where it is unknown.
  bool has(std::string_view name) const;
  /// Number of floats of a pass. Throws Error(invalid_argument) where it is unknown or not wanted.
  size_t float_count(std::string_view name) const;
  /// A pass, channels interleaved: float_count() floats, as long as the film lives.
  const float* data(std::string_view name) const { return find(name).sums.data(); }
  std::vector<float> pass(std::string_view name) const;

  /// Name and value of every attribute that Cryptomatte wants in a file with its passes.
  std::vector<std::pair<std::string, std::string>> matte_attributes() const;

  /// Which names the passes of a kind of Cryptomatte tell apart, as JSON; null where none is kept.
  const std::string* manifest(MatteKind kind) const;

 private:
  struct Channel {
    size_t pass;  // index in pass_rows()
    size_t channels;
    Plane<float> sums;
  };
  /// What is added to a tile at a time.
  struct Tile {
    tbb::spin_mutex mutex;
    int samples = 0;
  };
  /// One kind of Cryptomatte.
  struct Mattes {
    MatteIds ids;
    MatteSlots slots;
  };

  void add_channel(size_t row);
  void add_mattes(const Scene& scene);
  const Channel& find(std::string_view name) const;
  Region whole() const { return {0, 0, width_, height_}; }
  Tile& tile_at(int x, int y) const;
  void add_tile(const PassSource& from, const Region& tile, int sample);

  int width_ = 0;
  int height_ = 0;
  std::vector<Channel> passes_;
  std::unique_ptr<Tile[]> tiles_;              // as for_tiles() divides the picture
  std::optional<Mattes> mattes_[kMatteKinds];  // by kind; they point into passes_
};

}  // namespace kestrel
