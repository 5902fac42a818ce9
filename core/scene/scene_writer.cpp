// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene_writer.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/whole_file.h"
#include "scene/array_file.h"
#include "scene/scene_file_words.h"

namespace kestrel {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaximumSide = 65536;  // pixels of a picture

// ---- values ------------------------------------------------------------------------------------

/// The shortest number that reads as this float.
double number(float value) {
  const std::string text = fmt::format("{}", value);
  double shortest = value;
  std::from_chars(text.data(), text.data() + text.size(), shortest);
  return static_cast<float>(shortest) == value ? shortest : double{value};
}

template <typename Vector>
Json numbers(const Vector& values) {
  Json out = Json::array();
  for (int i = 0; i < values.length(); ++i) out.push_back(number(values[i]));
  return out;
}

/// Column by column.
template <typename Matrix>
Json matrix_numbers(const Matrix& matrix) {
  Json out = Json::array();
  for (int column = 0; column < matrix.length(); ++column) {
    for (int row = 0; row < matrix[column].length(); ++row) {
      out.push_back(number(matrix[column][row]));
    }
  }
  return out;
}

/// Reads as exactly these radians.
double degrees(float radians) {
  return std::min(glm::degrees(static_cast<double>(radians)), 180.0);
}

/// A name without what scene files do not take.
std::string plain(std::string text) {
  constexpr size_t kRoom = 16;  // for what tells equal names apart
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20) c = '?';
  }
  if (text.size() <= kMaximumSceneText - kRoom) return text;
  size_t length = kMaximumSceneText - kRoom;
  while ((text[length] & 0xC0) == 0x80) --length;  // not within a character
  return text.substr(0, length);
}

Json setting_value(const Parameter& row, const std::string& text) {
  const auto real = [](std::string_view word) {
    double value = 0.0;
    std::from_chars(word.data(), word.data() + word.size(), value);
    return value;
  };
  switch (row.type) {
    case ParameterType::boolean:
      return text == "true";
    case ParameterType::integer:
      return static_cast<int64_t>(real(text));
    case ParameterType::real:
      return real(text);
    case ParameterType::color: {
      Json out = Json::array();
      for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find(' ', begin), text.size());
        out.push_back(real(std::string_view(text).substr(begin, end - begin)));
        begin = end + 1;
      }
      return out;
    }
    case ParameterType::enumeration:
      break;
  }
  return text;
}

// ---- names -------------------------------------------------------------------------------------

/// Names of one array's elements, by which others refer to them: the element's own, but told apart
/// where several have the same.
class UniqueNames {
 public:
  /// An element that starts with its name, and its label where that is another.
  Json element(const std::string& name) {
    const std::string label = plain(name);
    std::string unique = label;
    int& number = numbers_.emplace(label, 1).first->second;
    while (!taken_.insert(unique).second) unique = fmt::format("{} #{}", label, ++number);
    Json out = {{"name", unique}};
    if (unique != label) out["label"] = label;
    return out;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> numbers_;  // by label, the last one tried
};

/// Elements of an array in the order in which they are first referred to.
template <typename Key>
class Elements {
 public:
  /// The name of the element of this key; `make(names)` makes it at first.
  template <typename Make>
  const std::string& name_of(const Key& key, Make&& make) {
    const auto known = names_.find(key);
    if (known != names_.end()) return known->second;
    const Json item = make(unique_);
    items_.push_back(item.dump());
    return names_[key] = item.at("name").template get<std::string>();
  }
  const std::vector<std::string>& items() const { return items_; }

 private:
  UniqueNames unique_;
  std::map<Key, std::string> names_;
  std::vector<std::string> items_;  // as text
};

// ---- elements ----------------------------------------------------------------------------------

/// The path by which the reader finds a texture's file, or "" where that does not work.
std::string readable_path(const Texture& texture) {
  if (texture.path.empty()) return "";
  std::error_code error;
  const auto path = std::filesystem::absolute(texture.path, error).lexically_normal().string();
  const bool is_plain = !error && plain(path) == path && path.find("${") == std::string::npos;
  try {
    if (is_plain) static_cast<void>(Json(path).dump());
  } catch (const Json::exception&) {  // no UTF-8
    return "";
  }
  return is_plain ? path : "";
}

Json camera_element(const Camera& camera) {
  Json out = {{"type", kProjectionWords[static_cast<size_t>(camera.projection)]},
              {"window", numbers(vec4(camera.left, camera.right, camera.bottom, camera.top))},
              {"matrix", matrix_numbers(camera.world_from_camera)},
              {"near", number(camera.near_clip)},
              {"far", number(camera.far_clip)}};
  if (camera.aperture_radius > 0.0f) {
    out["aperture_radius"] = number(camera.aperture_radius);
    out["focus_distance"] = number(camera.focus_distance);
    out["aperture_blades"] = camera.aperture_blades;
    out["aperture_rotation"] = glm::degrees(static_cast<double>(camera.aperture_rotation));
    out["aperture_ratio"] = number(camera.aperture_ratio);
  }
  return out;
}

Json light_element(const Light& light) {
  Json out = {{"name", plain(light.name)},
              {"type", kLightWords[static_cast<size_t>(light.type)]},
              {"color", numbers(light.color)},
              {"position", numbers(light.position)}};
  if (light.type != LightType::point) out["direction"] = numbers(light.direction);
  if (light.type != LightType::directional) out["attenuation"] = numbers(light.attenuation);
  if (light.type == LightType::spot) {
    out["spot_angle"] = degrees(light.spot_angle);
    out["blend"] = number(light.blend);
    out["exponent"] = number(light.exponent);
  }
  out["specular_factor"] = number(light.specular_factor);
  out["casts_shadow"] = light.casts_shadow;
  return out;
}

Json settings_element(const Settings& settings) {
  Json out = Json::object();
  for (const Parameter& row : parameter_table()) {
    if (row.scope != ParameterScope::scene) continue;
    out[std::string(row.name)] = setting_value(row, get_parameter(settings, row.name));
  }
  return out;
}

/// Those that are not as at first.
void add_settings(const ObjectSettings& settings, Json& out) {
  for (const Parameter& row : parameter_table()) {
    if (row.scope != ParameterScope::object) continue;
    const std::string value = get_parameter(settings, row.name);
    if (value == get_parameter(ObjectSettings(), row.name)) continue;
    out[std::string(row.name)] = setting_value(row, value);
  }
}

Json mesh_motion(const MeshMotion& motion, ArrayFile& arrays) {
  Json out = Json::array();
  for (const MeshShape& shape : motion) {
    Json step = {{"positions", arrays.add(shape.positions)}};
    if (!shape.corner_normals.empty()) step["normals"] = arrays.add(shape.corner_normals);
    out.push_back(std::move(step));
  }
  return out;
}

Json mesh_element(const Mesh& mesh, UniqueNames& names, ArrayFile& arrays) {
  Json out = names.element(mesh.name);
  out["positions"] = arrays.add(mesh.positions);
  out["triangles"] = arrays.add(mesh.triangles);
  if (!mesh.corner_normals.empty()) out["normals"] = arrays.add(mesh.corner_normals);
  if (!mesh.corner_uvs.empty()) out["uvs"] = arrays.add(mesh.corner_uvs);
  if (mesh.tangents_given) out["tangents"] = arrays.add(mesh.corner_tangents);
  if (!mesh.triangle_materials.empty()) {
    out["slots"] = arrays.add(mesh.triangle_materials);
  }
  if (mesh.uv_map) out["uv_map"] = mesh.uv_map;
  Json attributes = Json::array();
  for (const UvMap& map : mesh.more_uv_maps) {
    attributes.push_back({{"id", map.id}, {"uvs", arrays.add(map.corner_uvs)}});
  }
  for (const ColorAttribute& colors : mesh.color_attributes) {
    attributes.push_back({{"id", colors.id}, {"colors", arrays.add(colors.corner_colors)}});
  }
  if (!attributes.empty()) out["attributes"] = std::move(attributes);
  if (mesh.motion) out["motion"] = mesh_motion(*mesh.motion, arrays);
  return out;
}

Json texel_element(const Texture& texture, ArrayFile& arrays) {
  Json out = {{"width", texture.width}, {"height", texture.height}};
  if (!texture.texels_float.empty()) {
    out["floats"] = arrays.add(texture.texels_float);
  } else if (texture.channels8 == 4) {
    out["bytes"] = arrays.add(texture.texels8);
  } else {
    std::vector<uint8_t> rgba;
    rgba.reserve(texture.texels8.size() / 3 * 4);
    for (size_t i = 0; i < texture.texels8.size(); i += 3) {
      rgba.insert(rgba.end(), &texture.texels8[i], &texture.texels8[i] + 3);
      rgba.push_back(255);
    }
    out["bytes"] = arrays.add(rgba);
  }
  return out;
}

// ---- the scene ---------------------------------------------------------------------------------

class SceneWriter {
 public:
  SceneWriter(const Scene& scene, ArrayFile& arrays) : scene_(scene), arrays_(arrays) {
    std::vector<const Object*> objects;
    for (const Object& object : scene.objects) objects.push_back(&object);
    std::sort(objects.begin(), objects.end(),
              [](const Object* a, const Object* b) { return a->id < b->id; });
    for (const Object* object : objects) objects_.push_back(object_element(*object).dump());
    world_ = world_element(scene.world);
  }

  /// The file's text, an element a line.
  std::string text(int width, int height) const {
    std::string out = fmt::format("{{\"kestrel_scene\": {}", kSceneFileVersion);
    if (width) add_value(out, "size", Json::array({width, height}));
    add_value(out, "camera", camera_element(scene_.camera));
    if (!scene_.camera_motion.empty()) {
      std::vector<std::string> states;
      for (const Camera& camera : scene_.camera_motion) {
        states.push_back(camera_element(camera).dump());
      }
      add_array(out, "camera_motion", states);
    }
    add_value(out, "settings", settings_element(scene_.settings));
    add_value(out, "world", world_);
    std::vector<std::string> lights;
    for (const Light& light : scene_.lights) lights.push_back(light_element(light).dump());
    add_array(out, "lights", lights);
    add_array(out, "textures", textures_.items());
    add_array(out, "materials", materials_.items());
    add_array(out, "meshes", meshes_.items());
    add_array(out, "objects", objects_);
    add_value(out, "buffer", arrays_.close());
    return out + "}\n";
  }

 private:
  /// What a texture is, however many indices it has.
  using TextureKey = std::tuple<std::string, bool, bool, Extension, int>;

  static void add_value(std::string& out, const char* key, const Json& value) {
    out += fmt::format(",\n\"{}\": {}", key, value.dump());
  }
  static void add_array(std::string& out, const char* key, const std::vector<std::string>& items) {
    out += fmt::format(",\n\"{}\": [", key);
    const char* separator = "\n";
    for (const std::string& item : items) {
      out += separator;
      out += item;
      separator = ",\n";
    }
    out += "]";
  }

  std::string texture_name(int index) {
    const Texture& texture = *scene_.textures[index];
    const std::string path = readable_path(texture);
    const TextureKey key{path, texture.srgb, texture.nearest, texture.extension,
                         path.empty() ? index : kNone};
    return textures_.name_of(key, [&](UniqueNames& names) {
      const std::string& name =
          path.empty() ? texture.name : std::filesystem::path(path).filename().string();
      Json out = names.element(name.empty() ? "texture" : name);
      if (path.empty()) {
        out["pixels"] = texel_element(texture, arrays_);
      } else {
        out["file"] = path;
      }
      out["srgb"] = texture.srgb;
      out["nearest"] = texture.nearest;
      out["extension"] = kExtensionWords[static_cast<size_t>(texture.extension)];
      return out;
    });
  }

  Json material_element(const Material& m, UniqueNames& names) {
    Json out = names.element(m.name);
    out["emission"] = numbers(m.emission);
    out["ambient"] = numbers(m.ambient);
    out["diffuse"] = numbers(m.diffuse);
    out["specular"] = numbers(m.specular);
    out["reflectivity"] = number(m.optical.x);
    out["ior"] = number(m.optical.y);
    out["opacity"] = number(m.optical.z);
    out["reflection_color"] = numbers(m.reflection_color);
    out["transmission_color"] = numbers(m.transmission_color);
    static constexpr const char* kTextureKeys[] = {"emission_texture", "ambient_texture",
                                                   "diffuse_texture",  "specular_texture",
                                                   "normal_texture",   "optical_texture"};
    for (int slot = 0; slot < kTextureSlots; ++slot) {
      if (m.texture(slot) != kNone) out[kTextureKeys[slot]] = texture_name(m.texture(slot));
    }
    out["normal_strength"] = number(m.normal_strength);
    out["tiling"] = numbers(m.tiling);
    out["offset"] = numbers(m.offset);
    out["casts_shadow"] = m.casts_shadow;
    out["alpha_mode"] = kAlphaModeWords[static_cast<size_t>(m.alpha_mode)];
    out["alpha_cutoff"] = number(m.alpha_cutoff);
    out["pass_index"] = m.pass_index;
    add_attribute_ids(m, out);
    return out;
  }

  static void add_attribute_ids(const Material& m, Json& out) {
    if (std::any_of(std::begin(m.uv_maps), std::end(m.uv_maps), [](uint64_t id) { return id; })) {
      out["uv_maps"] = m.uv_maps;
    }
    if (m.tangent_map) out["tangent_map"] = m.tangent_map;
    if (m.emission_colors) out["emission_attribute"] = m.emission_colors;
    if (m.ambient_colors) out["ambient_attribute"] = m.ambient_colors;
    if (m.diffuse_colors) out["diffuse_attribute"] = m.diffuse_colors;
  }

  Json material_names(const std::vector<int>& materials) {
    Json out = Json::array();
    for (const int index : materials) {
      if (index == 0) {
        out.push_back(nullptr);
        continue;
      }
      out.push_back(materials_.name_of(index, [&](UniqueNames& names) {
        return material_element(scene_.materials[index], names);
      }));
    }
    return out;
  }

  Json object_element(const Object& object) {
    const std::string name = plain(object.name);
    const Unit& unit = scene_.units[object.unit];
    Json out = {{"name", name}};
    out["mesh"] = meshes_.name_of(object.mesh, [&](UniqueNames& names) {
      return mesh_element(*scene_.meshes[object.mesh], names, arrays_);
    });
    out["materials"] = material_names(object.materials);
    out["matrix"] = matrix_numbers(object.world_from_object);
    if (unit.name != object.name) out["unit"] = plain(unit.name);
    if (object.asset != object.name) out["asset"] = plain(object.asset);
    if (object.pass_index) out["pass_index"] = object.pass_index;
    for (size_t bit = 0; bit < kRayWords.size(); ++bit) {
      if (object.hidden_from >> bit & 1) out["hidden_from"].push_back(kRayWords[bit]);
    }
    if (object.holdout) out["holdout"] = true;
    if (object.motion_matrices) {
      for (const mat4x3& m : *object.motion_matrices) out["motion"].push_back(matrix_numbers(m));
    }
    if (units_.insert(object.unit).second) add_settings(unit.settings, out);
    return out;
  }

  Json world_element(const World& world) {
    Json out = {{"color", numbers(world.color)}};
    for (const int index : world.textures) {
      if (index != kNone) out["textures"].push_back(texture_name(index));
    }
    if (world.kind != WorldKind::color) out["matrix"] = matrix_numbers(world.map_from_world);
    out["mist"] = {{"start", number(world.mist.start)},
                   {"depth", number(world.mist.depth)},
                   {"falloff", number(world.mist.falloff)}};
    return out;
  }

  const Scene& scene_;
  ArrayFile& arrays_;
  std::vector<std::string> objects_;  // as text
  Json world_;
  std::set<int> units_;  // whose settings are written
  Elements<int> meshes_;
  Elements<int> materials_;
  Elements<TextureKey> textures_;
};

}  // namespace

void write_scene(const Scene& scene, const std::string& path, int width, int height) {
  const bool is_open = width == 0 && height == 0;
  if (!is_open && !(width >= 1 && height >= 1 && width <= kMaximumSide && height <= kMaximumSide)) {
    fail(ErrorCode::invalid_argument,
         "A picture of {} x {} pixels cannot be rendered. Use 1 to {} on each side, or 0 x 0 to "
         "leave the size open.",
         width, height, kMaximumSide);
  }
  WholeFile file(path);
  ArrayFile arrays(scene_buffer_path(path));
  const std::string text = SceneWriter(scene, arrays).text(width, height);
  file.write(text.data(), text.size());
  file.close();
  arrays.publish();
  file.publish();
}

}  // namespace kestrel
