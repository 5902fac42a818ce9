// SPDX-License-Identifier: GPL-3.0-or-later
// Materials of model files as the paper's Table 1.
#pragma once

#include <string>

#include "cli/model_file.h"

struct aiScene;

namespace kestrel::cli {

/// Appends the materials of `source` and the textures they use to `model`. Diffuse = ambient = base
/// colour, specular 0: roughness, metalness and their images are not taken over. Image files are
/// relative to `folder`.
void read_model_materials(const aiScene& source, const std::string& folder, Model& model);

}  // namespace kestrel::cli
