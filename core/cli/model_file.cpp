// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/model_file.h"

#include <fmt/ranges.h>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "cli/model_material.h"
#include "cli/ply_file.h"

namespace kestrel::cli {
namespace {

constexpr int kMaximumNodeDepth = 256;
constexpr uintmax_t kMaximumModelBytes = uintmax_t{4} << 30;
/// The importers that are safe to point at files of unknown origin and that artists need here.
constexpr std::string_view kFormats[] = {".gltf", ".glb", ".obj", ".ply", ".stl"};

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

void expect_known_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (std::find(std::begin(kFormats), std::end(kFormats), extension) == std::end(kFormats)) {
    throw std::runtime_error(fmt::format("'{}' is no model file that can be read; known are {}",
                                         path, fmt::join(kFormats, ", ")));
  }
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) > kMaximumModelBytes) {
    throw std::runtime_error(fmt::format("'{}' is larger than 4 GiB", path));
  }
}

vec3 vector_of(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

MeshDescription read_mesh(const aiMesh& source) {
  MeshDescription mesh;
  mesh.name = source.mName.C_Str();
  mesh.positions.reserve(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    mesh.positions.push_back(vector_of(source.mVertices[i]));
  }
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices != 3) continue;
    const unsigned* corners = face.mIndices;
    if (std::max({corners[0], corners[1], corners[2]}) >= source.mNumVertices) {
      throw std::runtime_error(
          fmt::format("mesh '{}' refers to a vertex that it does not have", mesh.name));
    }
    mesh.triangles.emplace_back(corners[0], corners[1], corners[2]);
    for (int i = 0; i < 3; ++i) {
      if (source.HasNormals())
        mesh.corner_normals.push_back(vector_of(source.mNormals[corners[i]]));
      if (source.HasTextureCoords(0)) {
        const aiVector3D& uv = source.mTextureCoords[0][corners[i]];
        mesh.corner_uvs.emplace_back(uv.x, uv.y);
      }
    }
  }
  return mesh;
}

/// The nodes with meshes below `node`, depth first, `parent` being the model's frame.
void read_nodes(const aiNode& node, const aiMatrix4x4& parent, const mat4& z_up_from_file,
                const std::vector<int>& mesh_indices, int depth, Model& model) {
  if (depth > kMaximumNodeDepth) throw std::runtime_error("its nodes are nested too deep");
  const aiMatrix4x4 m = parent * node.mTransformation;
  const mat4 file_from_mesh(m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3,
                            m.a4, m.b4, m.c4, m.d4);
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const int mesh = mesh_indices.at(node.mMeshes[i]);
    if (mesh == kNoIndex) continue;
    model.nodes.push_back({node.mName.C_Str(), mesh, mat4x3(z_up_from_file * file_from_mesh)});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    read_nodes(*node.mChildren[i], m, z_up_from_file, mesh_indices, depth + 1, model);
  }
}

void append(const MeshDescription& mesh, const mat4x3& m, uint32_t slot, MeshDescription& out) {
  const auto base = static_cast<uint32_t>(out.positions.size());
  const glm::mat3 linear(m);
  // Cofactors: normals stay right under non-uniform scales, and finite under flat ones.
  const glm::mat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                           glm::cross(linear[0], linear[1]));
  const bool flips = glm::determinant(linear) < 0.0f;
  for (const vec3& p : mesh.positions) out.positions.push_back(m * vec4(p, 1.0f));
  const size_t corners = mesh.triangles.size() * 3;
  const auto corner = [&](size_t c) { return flips ? c - c % 3 + (3 - c % 3) % 3 : c; };
  for (const uvec3& t : mesh.triangles) {
    out.triangles.push_back(base + (flips ? uvec3(t.x, t.z, t.y) : t));
  }
  for (size_t c = 0; c < corners; ++c) {
    const vec3 n = mesh.corner_normals.empty() ? vec3(0.0f) : mesh.corner_normals[corner(c)];
    const vec3 turned = (flips ? -1.0f : 1.0f) * (cofactor * n);
    const float length = glm::length(turned);
    out.corner_normals.push_back(length > 0.0f ? turned / length : vec3(0.0f));
    out.corner_uvs.push_back(mesh.corner_uvs.empty() ? vec2(0.0f) : mesh.corner_uvs[corner(c)]);
  }
  out.triangle_slots.resize(out.triangles.size(), slot);
}

mat4 z_up_from_file(UpAxis up) {
  return up == UpAxis::z ? mat4(1.0f) : mat4(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
}

/// One mesh and one node, with the default grey.
Model read_ply_model(const std::string& path, UpAxis up) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  Model model;
  try {
    model.meshes.push_back(read_ply(text.str()));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("'{}' cannot be read: {}", path, error.what()));
  }
  if (model.meshes[0].triangles.empty()) {
    throw std::runtime_error(fmt::format("'{}' holds no triangles", path));
  }
  MaterialDescription grey{"Default", {}};
  kestrelDefaultMaterial(&grey.values);
  model.materials.push_back(std::move(grey));
  model.mesh_materials = {0};
  model.nodes.push_back(
      {std::filesystem::path(path).stem().string(), 0, mat4x3(z_up_from_file(up))});
  return model;
}

const aiScene& import_file(Assimp::Importer& importer, const std::string& path) {
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const unsigned steps = aiProcess_Triangulate | aiProcess_SortByPType |
                         aiProcess_JoinIdenticalVertices | aiProcess_ValidateDataStructure;
  const aiScene* scene = nullptr;
  try {
    scene = importer.ReadFile(path, steps);
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("'{}' cannot be read: {}", path, error.what()));
  }
  if (!scene || !scene->mRootNode) {
    throw std::runtime_error(
        fmt::format("'{}' cannot be read: {}", path, importer.GetErrorString()));
  }
  return *scene;
}

}  // namespace

Model read_model(const std::string& path, UpAxis up) {
  expect_known_format(path);
  if (lower_extension(path) == ".ply") return read_ply_model(path, up);
  Assimp::Importer importer;
  const aiScene& scene = import_file(importer, path);
  Model model;
  std::vector<int> mesh_indices(scene.mNumMeshes, kNoIndex);
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    MeshDescription mesh = read_mesh(*scene.mMeshes[i]);
    if (mesh.triangles.empty()) continue;
    mesh_indices[i] = static_cast<int>(model.meshes.size());
    model.meshes.push_back(std::move(mesh));
    model.mesh_materials.push_back(static_cast<int>(scene.mMeshes[i]->mMaterialIndex));
  }
  read_model_materials(scene, std::filesystem::path(path).parent_path().string(), model);
  const std::string extension = lower_extension(path);
  const bool is_gltf = extension == ".gltf" || extension == ".glb";
  read_nodes(*scene.mRootNode, aiMatrix4x4(), z_up_from_file(is_gltf ? UpAxis::y : up),
             mesh_indices, 0, model);
  if (model.nodes.empty()) {
    throw std::runtime_error(fmt::format("'{}' holds no triangles", path));
  }
  return model;
}

MeshDescription joined(const std::vector<PlacedMesh>& parts) {
  MeshDescription mesh;
  bool has_normals = false, has_uvs = false, has_slots = false;
  for (const PlacedMesh& part : parts) {
    has_normals |= !part.mesh->corner_normals.empty();
    has_uvs |= !part.mesh->corner_uvs.empty();
    has_slots |= part.slot != 0;
    append(*part.mesh, part.placement, part.slot, mesh);
  }
  if (!has_normals) mesh.corner_normals.clear();
  if (!has_uvs) mesh.corner_uvs.clear();
  if (!has_slots) mesh.triangle_slots.clear();
  return mesh;
}

MeshDescription join_model(const Model& model, const std::string& part) {
  const auto is_part = [&](const ModelNode& node) {
    return part.empty() || node.name == part || model.meshes[node.mesh].name == part;
  };
  std::map<int, uint32_t> slots;  // by material
  std::set<std::string> names;
  for (const ModelNode& node : model.nodes) {
    names.insert(node.name);
    if (is_part(node)) slots[model.mesh_materials[node.mesh]] = 0;
  }
  if (slots.empty()) {
    throw std::runtime_error(
        fmt::format("no part is called '{}'; the file has: {}", part, fmt::join(names, ", ")));
  }
  uint32_t next = 0;
  for (auto& [material, slot] : slots) slot = next++;
  std::vector<PlacedMesh> parts;
  for (const ModelNode& node : model.nodes) {
    if (!is_part(node)) continue;
    parts.push_back(
        {&model.meshes[node.mesh], node.model_from_mesh, slots[model.mesh_materials[node.mesh]]});
  }
  return joined(parts);
}

}  // namespace kestrel::cli
