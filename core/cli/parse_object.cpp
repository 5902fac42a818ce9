// SPDX-License-Identifier: GPL-3.0-or-later
// Objects: placed meshes, their instances, and whole models.
#include <algorithm>
#include <climits>
#include <iterator>
#include <map>

#include "cli/parse.h"
#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

constexpr size_t kMaximumSlots = 65536;
constexpr size_t kMaximumJoinedTriangles = 50'000'000;

/// Whether `text` fits `pattern`, in which * stands for any run of characters.
bool matches(std::string_view pattern, std::string_view text) {
  size_t p = 0, t = 0, star = std::string_view::npos, restart = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      restart = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++restart;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

mat4x3 combined(const mat4x3& outer, const mat4x3& inner) {
  return mat4x3(mat4(outer) * mat4(inner));
}

/// [x, y, z], [x, y, z, degrees about Z], [x, y, z, degrees, scale] or a matrix of 12.
mat4x3 parse_instance(const JsonNode& node) {
  const std::vector<float> v = node.numbers(3, 12, -kMaximumLength, kMaximumLength);
  if (v.size() == 12) return parse_matrix(node);
  if (v.size() > 5) node.fail("expected 3, 4, 5 or 12 numbers, found {}", v.size());
  const mat3 r = rotation_from_degrees({0.0f, 0.0f, v.size() > 3 ? v[3] : 0.0f}) *
                 (v.size() > 4 ? v[4] : 1.0f);
  return mat4x3(r[0], r[1], r[2], vec3(v[0], v[1], v[2]));
}

/// Where the element stands: once, or at each of its instances.
std::vector<mat4x3> parse_placements(const JsonNode& node) {
  const mat4x3 placement = parse_transform(node);
  const auto instances = node.find("instances");
  if (!instances) return {placement};
  std::vector<mat4x3> placements;
  for (const JsonNode& item : instances->items(kMaximumItems)) {
    placements.push_back(combined(parse_instance(item), placement));
  }
  if (placements.empty()) instances->fail("expected at least one instance");
  return placements;
}

/// What compositing tells objects by.
void parse_identity(const JsonNode& node, ObjectDescription& object) {
  if (const auto n = node.find("asset")) object.asset = n->text();
  if (const auto n = node.find("pass_index")) object.pass_index = n->integer(INT_MIN, INT_MAX);
}

std::vector<std::string> object_keys(const std::vector<std::string>& own) {
  std::vector<std::string> keys = {"name",    "unit",  "instances", "hidden_from",
                                   "holdout", "asset", "pass_index"};
  for (const auto& more : {own, transform_keys(), setting_names("object")}) {
    keys.insert(keys.end(), more.begin(), more.end());
  }
  return keys;
}

/// What the camera and rays see of the element's objects.
void parse_visibility(const JsonNode& node, ObjectDescription& object) {
  if (const auto kinds = node.find("hidden_from")) {
    for (const JsonNode& kind : kinds->items(16)) {
      object.hidden_from |= 1u << kind.choice(kRayWords);
    }
  }
  if (const auto holdout = node.find("holdout")) object.holdout = holdout->boolean();
}

void expect_room(const JsonNode& node, size_t more, const SceneDescription& scene) {
  if (scene.objects.size() + more > kMaximumItems) {
    node.fail("the scene would have more than {} objects", kMaximumItems);
  }
}

// ---- imported models ---------------------------------------------------------------------------

/// "units": which nodes are selected together, by their material's or their own name.
struct UnitRule {
  std::string unit;
  std::vector<std::string> patterns;  // empty: whatever is left
};

/// "replace": materials of the scene instead of the model's.
struct Replacement {
  std::string pattern;
  int material;
};

std::vector<UnitRule> parse_unit_rules(const JsonNode& node) {
  std::vector<UnitRule> rules;
  const auto units = node.find("units");
  if (!units) return rules;
  for (const JsonNode& item : units->items(10'000)) {
    item.expect_keys({"unit", "match"});
    UnitRule rule{item.require("unit").text(), {}};
    if (const auto match = item.find("match")) {
      for (const JsonNode& pattern : match->items(10'000)) rule.patterns.push_back(pattern.text());
    }
    rules.push_back(std::move(rule));
  }
  return rules;
}

std::vector<Replacement> parse_replacements(const JsonNode& node, const Model& model,
                                            const Names& materials) {
  std::vector<Replacement> out;
  const auto replace = node.find("replace");
  if (!replace) return out;
  std::vector<std::string> known;
  for (const MaterialDescription& m : model.materials) known.push_back(m.name);
  for (const JsonNode& item : replace->items(10'000)) {
    item.expect_keys({"material", "with"});
    const JsonNode pattern = item.require("material");
    Replacement r{pattern.text(), materials.find(item.require("with"))};
    if (std::none_of(known.begin(), known.end(),
                     [&](const std::string& name) { return matches(r.pattern, name); })) {
      pattern.fail("the model has no material '{}'{}", r.pattern, did_you_mean(r.pattern, known));
    }
    out.push_back(std::move(r));
  }
  return out;
}

/// The index of `texture` in the scene: that of an equal one where several models use one image.
int add_texture(const TextureDescription& texture, SceneDescription& scene) {
  const auto* file = std::get_if<TextureFile>(&texture.source);
  const auto is_same = [&](const TextureDescription& other) {
    const auto* other_file = std::get_if<TextureFile>(&other.source);
    return file && other_file && file->path == other_file->path && texture.srgb == other.srgb &&
           texture.nearest == other.nearest && texture.extension == other.extension;
  };
  const auto it = std::find_if(scene.textures.begin(), scene.textures.end(), is_same);
  if (it != scene.textures.end()) return static_cast<int>(it - scene.textures.begin());
  scene.textures.push_back(texture);
  return static_cast<int>(scene.textures.size()) - 1;
}

/// Makes the model's meshes, textures and materials the scene's, once.
void add_model(ModelCache::Entry& entry, SceneDescription& scene) {
  if (entry.imported) return;
  entry.imported = true;
  entry.first_mesh = static_cast<int>(scene.meshes.size());
  entry.first_material = static_cast<int>(scene.materials.size());
  const Model& model = entry.model;
  scene.meshes.insert(scene.meshes.end(), model.meshes.begin(), model.meshes.end());
  std::vector<uint64_t> ids;  // in the scene, by the model's index
  for (const TextureDescription& texture : model.textures) {
    ids.push_back(static_cast<uint64_t>(add_texture(texture, scene)) + 1);
  }
  for (MaterialDescription material : model.materials) {
    KestrelMaterial& m = material.values;
    for (uint64_t* id : {&m.emission_texture, &m.ambient_texture, &m.diffuse_texture,
                         &m.specular_texture, &m.normal_texture, &m.optical_texture}) {
      if (*id) *id = ids.at(*id - 1);
    }
    scene.materials.push_back(std::move(material));
  }
}

std::string unit_of(const ModelNode& node, const std::string& material,
                    const std::vector<UnitRule>& rules, const std::string& fallback) {
  for (const UnitRule& rule : rules) {
    const bool fits = rule.patterns.empty() ||
                      std::any_of(rule.patterns.begin(), rule.patterns.end(), [&](const auto& p) {
                        return matches(p, material) || matches(p, node.name);
                      });
    if (fits) return rule.unit;
  }
  return fallback;
}

int material_of(int model_material, const ModelCache::Entry& entry,
                const std::vector<Replacement>& replacements) {
  const std::string& name = entry.model.materials.at(model_material).name;
  for (const Replacement& r : replacements) {
    if (matches(r.pattern, name)) return r.material;
  }
  return entry.first_material + model_material;
}

/// The objects of each unit as one object with one mesh, a slot for each of its materials.
std::vector<ObjectDescription> joined_by_unit(const std::vector<ObjectDescription>& objects,
                                              const JsonNode& node, SceneDescription& scene) {
  std::vector<std::string> units;  // in order of appearance
  std::map<std::string, std::vector<const ObjectDescription*>> members;
  size_t triangles = 0;
  for (const ObjectDescription& object : objects) {
    if (members[object.unit].empty()) units.push_back(object.unit);
    members[object.unit].push_back(&object);
    triangles += scene.meshes[object.mesh].triangles.size();
  }
  if (triangles > kMaximumJoinedTriangles) {
    node.fail("joined it would have {} triangles; without 'join' its instances share memory",
              triangles);
  }
  std::vector<ObjectDescription> out;
  for (const std::string& unit : units) {
    ObjectDescription object = *members[unit].front();
    object.name = object.unit;
    object.materials.clear();
    object.world_from_object = mat4x3(1.0f);
    std::vector<PlacedMesh> parts;
    for (const ObjectDescription* member : members[unit]) {
      const int material = member->materials[0];
      const auto it = std::find(object.materials.begin(), object.materials.end(), material);
      const auto slot = static_cast<uint32_t>(it - object.materials.begin());
      if (it == object.materials.end()) object.materials.push_back(material);
      parts.push_back({&scene.meshes[member->mesh], member->world_from_object, slot});
    }
    MeshDescription mesh = joined(parts);
    mesh.name = unit;
    object.mesh = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
    out.push_back(std::move(object));
  }
  return out;
}

void parse_import(const JsonNode& node, const JsonNode& file, ParseContext& context) {
  node.expect_keys(object_keys({"import", "up", "units", "replace", "join"}));
  const std::vector<mat4x3> placements = parse_placements(node);
  const std::vector<UnitRule> rules = parse_unit_rules(node);
  const auto settings = parse_settings(node, "object");
  const auto name = node.find(node.has("unit") ? "unit" : "name");
  const std::string unit = name ? name->text() : "";
  const auto join = node.find("join");
  ObjectDescription identity;
  parse_identity(node, identity);
  ModelCache::Entry& entry = context.models.read(file, parse_up(node));
  const Model& model = entry.model;
  const auto replacements = parse_replacements(node, model, context.materials);
  expect_room(node, placements.size() * model.nodes.size(), context.scene);
  add_model(entry, context.scene);
  std::vector<ObjectDescription> objects;
  for (const mat4x3& placement : placements) {
    for (const ModelNode& part : model.nodes) {
      const int material = model.mesh_materials[part.mesh];
      ObjectDescription object = identity;
      object.name = part.name.empty() ? unit : part.name;
      object.unit =
          unit_of(part, model.materials.at(material).name, rules, unit.empty() ? part.name : unit);
      object.mesh = entry.first_mesh + part.mesh;
      object.materials = {material_of(material, entry, replacements)};
      object.world_from_object = combined(placement, part.model_from_mesh);
      object.settings = settings;
      parse_visibility(node, object);
      objects.push_back(std::move(object));
    }
  }
  if (join && join->boolean()) objects = joined_by_unit(objects, node, context.scene);
  std::move(objects.begin(), objects.end(), std::back_inserter(context.scene.objects));
}

// ---- placed meshes -----------------------------------------------------------------------------

/// Matrices at even steps of time.
std::vector<mat4x3> parse_motion(const JsonNode& node) {
  std::vector<mat4x3> matrices;
  const auto motion = node.find("motion");
  if (!motion) return matrices;
  if (node.has("instances")) node.fail("has both 'motion' and 'instances'; use one of them");
  for (const JsonNode& item : motion->items(kMaximumSteps)) matrices.push_back(parse_matrix(item));
  if (matrices.size() < 2) motion->fail("expected at least 2 matrices");
  return matrices;
}

std::vector<int> parse_slots(const JsonNode& node, const Names& materials) {
  const auto one = node.find("material");
  const auto many = node.find("materials");
  if (one && many) node.fail("has both 'material' and 'materials'; use one of them");
  if (one) return {materials.find(*one)};
  std::vector<int> slots;
  if (!many) return slots;
  for (const JsonNode& item : many->items(kMaximumSlots)) {
    slots.push_back(item.value().is_null() ? kNoIndex : materials.find(item));
  }
  return slots;
}

}  // namespace

void parse_object(const JsonNode& node, size_t index, ParseContext& context) {
  if (!node.value().is_object()) node.expect_keys({});
  const auto file = node.find("import");
  if (file) {
    parse_import(node, *file, context);
    return;
  }
  node.expect_keys(object_keys({"mesh", "material", "materials", "motion"}));
  ObjectDescription object;
  object.mesh = context.meshes.find(node.require("mesh"));
  const auto name = node.find("name");
  const auto unit = node.find("unit");
  object.name = name ? name->text() : fmt::format("Object {}", index);
  if (unit) object.unit = unit->text();
  parse_identity(node, object);
  object.materials = parse_slots(node, context.materials);
  object.settings = parse_settings(node, "object");
  parse_visibility(node, object);
  object.motion = parse_motion(node);
  const std::vector<mat4x3> placements = parse_placements(node);
  expect_room(node, placements.size(), context.scene);
  for (const mat4x3& placement : placements) {
    object.world_from_object = placement;
    context.scene.objects.push_back(object);
  }
}

}  // namespace kestrel::cli
