// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes: primitives, model files and inline geometry.
#include <algorithm>

#include "cli/parse.h"
#include "cli/primitives.h"
#include "cli/scene_data.h"
#include "cli/simplify.h"

namespace kestrel::cli {
namespace {

constexpr int kMaximumSlices = 4096;
constexpr size_t kMaximumNumbers = 300'000'000;  // in one array

MeshDescription parse_primitive(const JsonNode& node, const JsonNode& primitive) {
  const int kind = primitive.choice({"plane", "cube", "sphere"});
  if (kind != 2) {
    node.expect_keys({"name", "primitive"});
    return kind == 0 ? make_plane() : make_cube();
  }
  node.expect_keys({"name", "primitive", "slices", "stacks", "smooth"});
  const auto slices = node.find("slices");
  const auto stacks = node.find("stacks");
  const auto smooth = node.find("smooth");
  return make_sphere(slices ? slices->integer(3, kMaximumSlices) : 32,
                     stacks ? stacks->integer(2, kMaximumSlices) : 16,
                     !smooth || smooth->boolean());
}

MeshDescription parse_file(const JsonNode& node, const JsonNode& file, ModelCache& models) {
  node.expect_keys({"name", "file", "part", "up", "normals", "triangles"});
  const auto part = node.find("part");
  const auto target = node.find("triangles");
  const auto normals = node.find("normals");
  const int kind = normals ? normals->choice({"file", "flat", "smooth"}) : 0;
  const int triangles = target ? target->integer(4, 1 << 30) : 0;
  const Model& model = models.read(file, parse_up(node)).model;
  MeshDescription mesh;
  try {
    mesh = join_model(model, part ? part->text() : "");
  } catch (const std::runtime_error& error) {
    (part ? *part : file).fail("{}", error.what());
  }
  if (kind == 1) mesh.corner_normals.clear();
  if (kind == 2) smooth_normals(mesh);
  if (target) simplify(mesh, static_cast<size_t>(triangles));
  return mesh;
}

std::vector<uint32_t> parse_indices(const JsonNode& node, uint32_t end) {
  std::vector<uint32_t> out;
  const std::vector<float> check = node.numbers(0, kMaximumNumbers, 0, end - 1.0);
  out.reserve(check.size());
  for (size_t i = 0; i < check.size(); ++i) {
    const nlohmann::json& item = node.value()[i];
    if (!item.is_number_integer()) {
      JsonNode(node.file(), item, fmt::format("{}/{}", node.pointer(), i))
          .integer(0, static_cast<int>(end) - 1);
    }
    out.push_back(item.get<uint32_t>());
  }
  return out;
}

/// A flat array of `per_item` numbers for each of `count` items.
std::vector<float> parse_attribute(const JsonNode& node, size_t count, size_t per_item) {
  if (!node.value().is_array() || node.value().size() != count * per_item) {
    node.fail("expected an array of {} numbers: {} for each of the {} triangle corners",
              count * per_item, per_item, count);
  }
  return node.numbers(count * per_item, count * per_item, -kMaximumLength, kMaximumLength);
}

MeshDescription parse_inline(const JsonNode& node) {
  node.expect_keys({"name", "positions", "triangles", "normals", "uvs", "slots"});
  MeshDescription mesh;
  const JsonNode positions = node.require("positions");
  const std::vector<float> p =
      positions.numbers(0, kMaximumNumbers, -kMaximumLength, kMaximumLength);
  if (p.size() < 9 || p.size() % 3 != 0) {
    positions.fail("expected 3 numbers for each of at least 3 vertices, found {}", p.size());
  }
  for (size_t i = 0; i < p.size(); i += 3) mesh.positions.emplace_back(p[i], p[i + 1], p[i + 2]);
  const JsonNode triangles = node.require("triangles");
  const auto t = parse_indices(triangles, static_cast<uint32_t>(mesh.positions.size()));
  if (t.empty() || t.size() % 3 != 0) {
    triangles.fail("expected 3 vertex indices for each of at least 1 triangle, found {}", t.size());
  }
  for (size_t i = 0; i < t.size(); i += 3) mesh.triangles.emplace_back(t[i], t[i + 1], t[i + 2]);
  if (const auto normals = node.find("normals")) {
    const auto n = parse_attribute(*normals, t.size(), 3);
    for (size_t i = 0; i < n.size(); i += 3) {
      mesh.corner_normals.emplace_back(n[i], n[i + 1], n[i + 2]);
    }
  }
  if (const auto uvs = node.find("uvs")) {
    const auto uv = parse_attribute(*uvs, t.size(), 2);
    for (size_t i = 0; i < uv.size(); i += 2) mesh.corner_uvs.emplace_back(uv[i], uv[i + 1]);
  }
  if (const auto slots = node.find("slots")) {
    mesh.triangle_slots = parse_indices(*slots, 65536);
    if (mesh.triangle_slots.size() != mesh.triangles.size()) {
      slots->fail("expected {} slots, one for each triangle, found {}", mesh.triangles.size(),
                  mesh.triangle_slots.size());
    }
  }
  return mesh;
}

}  // namespace

ModelCache::Entry& ModelCache::read(const JsonNode& path, UpAxis up) {
  const std::string file = resolve_file(path);
  std::unique_ptr<Entry>& entry = entries_[{file, up}];
  if (!entry) {
    try {
      entry = std::make_unique<Entry>(Entry{read_model(file, up)});
    } catch (const std::runtime_error& error) {
      path.fail("{}", error.what());
    }
  }
  return *entry;
}

MeshDescription parse_mesh(const JsonNode& node, Names& names, int index, ModelCache& models) {
  const std::string name = names.add(node, index);
  const auto primitive = node.find("primitive");
  const auto file = node.find("file");
  if (primitive.has_value() + file.has_value() + node.has("positions") != 1) {
    node.fail("expected one of 'primitive', 'file' and 'positions'");
  }
  MeshDescription mesh = primitive ? parse_primitive(node, *primitive)
                         : file    ? parse_file(node, *file, models)
                                   : parse_inline(node);
  mesh.name = name;
  return mesh;
}

}  // namespace kestrel::cli
