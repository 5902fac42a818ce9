// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/frame.h"

namespace kestrel {

void GBuffer::resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  const size_t n = static_cast<size_t>(width) * static_cast<size_t>(height);
  position.resize(n);
  normal.resize(n);
  normal_geometric.resize(n);
  emission.resize(n);
  ambient.resize(n);
  diffuse.resize(n);
  specular.resize(n);
  optical.resize(n);
  heuristic_mask.resize(n);
  depth.resize(n);
  object.resize(n);
  material.resize(n);
  lighting.resize(n);
}

}  // namespace kestrel
