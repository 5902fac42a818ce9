// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes: primitives, model files and inline geometry.
#include <algorithm>
#include <cstring>

#include "cli/parse.h"
#include "cli/primitives.h"
#include "cli/scene_data.h"
#include "cli/simplify.h"

namespace kestrel::cli {
namespace {

constexpr int kMaximumSlices = 4096;
constexpr size_t kMaximumAttributes = 1000;  // of one mesh

MeshDescription parse_primitive(const JsonNode& node, const JsonNode& primitive) {
  const int kind = primitive.choice({"plane", "cube", "sphere"});
  if (kind != 2) {
    node.expect_keys({"name", "label", "primitive"});
    return kind == 0 ? make_plane() : make_cube();
  }
  node.expect_keys({"name", "label", "primitive", "slices", "stacks", "smooth"});
  const auto slices = node.find("slices");
  const auto stacks = node.find("stacks");
  const auto smooth = node.find("smooth");
  return make_sphere(slices ? slices->integer(3, kMaximumSlices) : 32,
                     stacks ? stacks->integer(2, kMaximumSlices) : 16,
                     !smooth || smooth->boolean());
}

MeshDescription parse_file(const JsonNode& node, const JsonNode& file, ModelCache& models) {
  node.expect_keys({"name", "label", "file", "part", "up", "normals", "triangles"});
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

template <typename Vector>
std::vector<Vector> as_vectors(const std::vector<float>& values) {
  std::vector<Vector> out(values.size() / static_cast<size_t>(Vector::length()));
  if (!out.empty()) std::memcpy(&out[0][0], values.data(), out.size() * sizeof(Vector));
  return out;
}

/// `per_item` numbers for each of `count` items; empty where the key is missing.
std::vector<float> parse_values(const JsonNode& node, const std::string& key,
                                const SceneBuffer& buffer, size_t count, size_t per_item,
                                const char* items = "triangle corners") {
  const auto values = node.find(key);
  if (!values) return {};
  const bool fits = values->value().is_object() ||
                    (values->value().is_array() && values->value().size() == count * per_item);
  const std::vector<float> out =
      fits ? buffer.floats(*values, -kMaximumLength, kMaximumLength) : std::vector<float>();
  if (!fits || out.size() != count * per_item) {
    values->fail("expected an array of {} numbers: {} for each of the {} {}", count * per_item,
                 per_item, count, items);
  }
  return out;
}

std::vector<AttributeDescription> parse_attributes(const JsonNode& node, const SceneBuffer& buffer,
                                                   size_t corners) {
  std::vector<AttributeDescription> out;
  const auto attributes = node.find("attributes");
  if (!attributes) return out;
  for (const JsonNode& item : attributes->items(kMaximumAttributes)) {
    item.expect_keys({"id", "uvs", "colors"});
    if (item.has("uvs") == item.has("colors")) item.fail("expected either 'uvs' or 'colors'");
    AttributeDescription attribute{item.require("id").whole(), item.has("uvs") ? 2 : 3, {}};
    attribute.values = parse_values(item, item.has("uvs") ? "uvs" : "colors", buffer, corners,
                                    static_cast<size_t>(attribute.channels));
    out.push_back(std::move(attribute));
  }
  return out;
}

std::vector<ShapeDescription> parse_shapes(const JsonNode& node, const SceneBuffer& buffer,
                                           const MeshDescription& mesh) {
  std::vector<ShapeDescription> out;
  const auto motion = node.find("motion");
  if (!motion) return out;
  const size_t corners = 3 * mesh.triangles.size();
  for (const JsonNode& item : motion->items(kMaximumSteps)) {
    item.expect_keys({"positions", "normals"});
    item.require("positions");
    out.push_back({as_vectors<vec3>(parse_values(item, "positions", buffer, mesh.positions.size(),
                                                 3, "vertices")),
                   as_vectors<vec3>(parse_values(item, "normals", buffer, corners, 3))});
    if (out.back().corner_normals.empty() != out.front().corner_normals.empty()) {
      item.fail("expected 'normals' in all shapes or in none");
    }
  }
  if (out.size() < 2) motion->fail("expected at least 2 shapes");
  return out;
}

MeshDescription parse_inline(const JsonNode& node, const SceneBuffer& buffer) {
  node.expect_keys({"name", "label", "positions", "triangles", "normals", "uvs", "tangents",
                    "slots", "uv_map", "attributes", "motion"});
  MeshDescription mesh;
  const JsonNode positions = node.require("positions");
  const std::vector<float> p = buffer.floats(positions, -kMaximumLength, kMaximumLength);
  if (p.size() < 9 || p.size() % 3 != 0) {
    positions.fail("expected 3 numbers for each of at least 3 vertices, found {}", p.size());
  }
  mesh.positions = as_vectors<vec3>(p);
  const JsonNode triangles = node.require("triangles");
  const auto t = buffer.indices(triangles, static_cast<uint32_t>(mesh.positions.size()));
  if (t.empty() || t.size() % 3 != 0) {
    triangles.fail("expected 3 vertex indices for each of at least 1 triangle, found {}", t.size());
  }
  for (size_t i = 0; i < t.size(); i += 3) mesh.triangles.emplace_back(t[i], t[i + 1], t[i + 2]);
  mesh.corner_normals = as_vectors<vec3>(parse_values(node, "normals", buffer, t.size(), 3));
  mesh.corner_uvs = as_vectors<vec2>(parse_values(node, "uvs", buffer, t.size(), 2));
  mesh.corner_tangents = as_vectors<vec4>(parse_values(node, "tangents", buffer, t.size(), 4));
  if (const auto slots = node.find("slots")) {
    mesh.triangle_slots = buffer.indices(*slots, 65536);
    if (mesh.triangle_slots.size() != mesh.triangles.size()) {
      slots->fail("expected {} slots, one for each triangle, found {}", mesh.triangles.size(),
                  mesh.triangle_slots.size());
    }
  }
  if (const auto id = node.find("uv_map")) mesh.uv_map = id->whole();
  mesh.attributes = parse_attributes(node, buffer, t.size());
  mesh.motion = parse_shapes(node, buffer, mesh);
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

MeshDescription parse_mesh(const JsonNode& node, Names& names, int index, ModelCache& models,
                           const SceneBuffer& buffer) {
  const std::string name = names.add(node, index);
  const auto primitive = node.find("primitive");
  const auto file = node.find("file");
  if (primitive.has_value() + file.has_value() + node.has("positions") != 1) {
    node.fail("expected one of 'primitive', 'file' and 'positions'");
  }
  MeshDescription mesh = primitive ? parse_primitive(node, *primitive)
                         : file    ? parse_file(node, *file, models)
                                   : parse_inline(node, buffer);
  mesh.name = parse_label(node, name);
  return mesh;
}

}  // namespace kestrel::cli
