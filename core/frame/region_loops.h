// SPDX-License-Identifier: GPL-3.0-or-later
// Loops over a region, in parallel where it is large. A region of one tile is worked on by one
// thread: tiles of a picture are on different threads already.
#pragma once

#include <tbb/parallel_for.h>

#include "frame/frame.h"

namespace kestrel {

/// Width and height of a tile, pixels. Everything that the stages hold of one fits the second level
/// cache of a processor core.
inline constexpr int kTileSize = 32;

/// Whether a region is one tile at most.
inline bool is_tile(const Region& region) {
  return region.width <= kTileSize && region.height <= kTileSize;
}

namespace region_loops {

template <typename Work>
void run(const Region& region, int count, const Work& work) {
  if (is_tile(region)) {
    for (int i = 0; i < count; ++i) work(i);
  } else {
    tbb::parallel_for(0, count, work);
  }
}

}  // namespace region_loops

/// Calls `work(y)` for every row.
template <typename Work>
void for_rows(const Region& region, const Work& work) {
  region_loops::run(region, region.height, work);
}

/// Number of tiles of a region; those at its right and upper edges may be smaller.
inline int tile_count(const Region& region) {
  const auto along = [](int size) { return (size + kTileSize - 1) / kTileSize; };
  return along(region.width) * along(region.height);
}

/// Calls `work(tile)` for every tile of a region, as regions in the same picture.
template <typename Work>
void for_tiles(const Region& region, const Work& work) {
  const int columns = (region.width + kTileSize - 1) / kTileSize;
  region_loops::run(region, tile_count(region), [&](int i) {
    const int x = i % columns * kTileSize, y = i / columns * kTileSize;
    work(Region{region.x + x, region.y + y, glm::min(kTileSize, region.width - x),
                glm::min(kTileSize, region.height - y)});
  });
}

}  // namespace kestrel
