// SPDX-License-Identifier: GPL-3.0-or-later
// A model file (glTF, OBJ, PLY, STL) as meshes, Table 1 materials and placed nodes.
#pragma once

#include <string>
#include <vector>

#include "cli/scene_description.h"

namespace kestrel::cli {

/// Which way is up in the file. glTF is always Y up; the others say nothing.
enum class UpAxis { y, z };

struct ModelNode {
  std::string name;
  int mesh = kNoIndex;
  mat4x3 model_from_mesh{1.0f};  // Z up
};

struct Model {
  std::vector<MeshDescription> meshes;  // one material each
  std::vector<int> mesh_materials;      // parallel to meshes
  std::vector<MaterialDescription> materials;
  std::vector<TextureDescription> textures;
  std::vector<ModelNode> nodes;
};

/// `up` for files that do not say it themselves. Triangulated; points and lines are left out.
/// Throws std::runtime_error with the reason where the file cannot be read or holds no triangles.
Model read_model(const std::string& path, UpAxis up);

/// A mesh where it stands, and the slot that its triangles get.
struct PlacedMesh {
  const MeshDescription* mesh;
  mat4x3 placement;
  uint32_t slot;
};

/// One mesh of them all. Mirroring placements keep the faces' sides.
MeshDescription joined(const std::vector<PlacedMesh>& parts);

/// All nodes (those whose node or mesh is called `part`, where it is not empty) as one mesh, in the
/// model's frame; a slot for each of the file's materials that is used, in the file's order.
/// Throws std::runtime_error that lists the parts where there is none of that name.
MeshDescription join_model(const Model& model, const std::string& part);

}  // namespace kestrel::cli
