// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/ranges.h>

#include "cli/parse.h"
#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

const nlohmann::json& parameter_table() {
  static const nlohmann::json table = nlohmann::json::parse(kestrelGetParameterTable());
  return table;
}

/// A setting's JSON value as the text that the library takes.
std::string setting_text(const JsonNode& node, const nlohmann::json& row) {
  const auto type = row.at("type").get<std::string>();
  if (type == "bool") return node.boolean() ? "true" : "false";
  if (type == "enum") {
    const auto items = row.at("items").get<std::vector<std::string>>();
    return items[node.choice(items)];
  }
  const double minimum = row.at("min").get<double>(), maximum = row.at("max").get<double>();
  if (type == "int") {
    return fmt::format("{}", node.integer(static_cast<int>(minimum), static_cast<int>(maximum)));
  }
  if (type == "color") {
    return fmt::format("{}", fmt::join(node.numbers(3, 3, minimum, maximum), " "));
  }
  return fmt::format("{}", node.number(minimum, maximum));
}

}  // namespace

std::string Names::add(const JsonNode& element, int index) {
  const JsonNode name = element.require("name");
  const std::string text = name.text();
  if (!indices_.emplace(text, index).second) {
    name.fail("another {} is called '{}'; names of {}s must differ", kind_, text, kind_);
  }
  return text;
}

int Names::find(const JsonNode& reference) const {
  const std::string text = reference.text();
  const auto it = indices_.find(text);
  if (it != indices_.end()) return it->second;
  std::vector<std::string> known;
  for (const auto& [name, index] : indices_) known.push_back(name);
  reference.fail("there is no {} '{}'{}", kind_, text, did_you_mean(text, known));
}

vec3 parse_vec3(const JsonNode& parent, const std::string& key, const vec3& fallback,
                double minimum, double maximum) {
  const auto node = parent.find(key);
  if (!node) return fallback;
  const std::vector<float> v = node->numbers(3, 3, minimum, maximum);
  return {v[0], v[1], v[2]};
}

std::string parse_label(const JsonNode& parent, const std::string& name) {
  const auto label = parent.find("label");
  return label ? label->text() : name;
}

UpAxis parse_up(const JsonNode& parent) {
  const auto node = parent.find("up");
  return node && node->choice({"y", "z"}) == 0 ? UpAxis::y : UpAxis::z;
}

mat3 rotation_from_degrees(const vec3& degrees) {
  // In double: a quarter turn of something large stays flat.
  const glm::dvec3 r = glm::radians(glm::dvec3(degrees));
  const vec3 c(glm::cos(r)), s(glm::sin(r));
  const mat3 x(1, 0, 0, 0, c.x, s.x, 0, -s.x, c.x);
  const mat3 y(c.y, 0, -s.y, 0, 1, 0, s.y, 0, c.y);
  const mat3 z(c.z, s.z, 0, -s.z, c.z, 0, 0, 0, 1);
  return z * y * x;
}

mat4x3 parse_matrix(const JsonNode& node) {
  const std::vector<float> v = node.numbers(12, 12, -kMaximumSceneNumber, kMaximumSceneNumber);
  mat4x3 m;
  for (int i = 0; i < 12; ++i) m[i / 3][i % 3] = v[i];
  return m;
}

const std::vector<std::string>& transform_keys() {
  static const std::vector<std::string> keys = {"matrix", "position", "rotation", "scale"};
  return keys;
}

mat4x3 parse_transform(const JsonNode& parent) {
  if (const auto matrix = parent.find("matrix")) {
    for (const char* other : {"position", "rotation", "scale"}) {
      if (parent.has(other)) parent.fail("has both 'matrix' and '{}'; use one of them", other);
    }
    return parse_matrix(*matrix);
  }
  vec3 scale(1.0f);
  if (const auto node = parent.find("scale")) {
    scale = node->value().is_number() ? vec3(node->number(-kMaximumLength, kMaximumLength))
                                      : parse_vec3(parent, "scale", scale);
  }
  const mat3 linear = rotation_from_degrees(parse_vec3(parent, "rotation", vec3(0.0f), -1e6, 1e6));
  return mat4x3(linear[0] * scale.x, linear[1] * scale.y, linear[2] * scale.z,
                parse_vec3(parent, "position", vec3(0.0f)));
}

std::vector<std::string> setting_names(const std::string& scope) {
  std::vector<std::string> names;
  for (const auto& row : parameter_table()) {
    if (row.at("scope") == scope) names.push_back(row.at("name"));
  }
  return names;
}

std::vector<std::pair<std::string, std::string>> parse_settings(const JsonNode& node,
                                                                const std::string& scope) {
  std::vector<std::pair<std::string, std::string>> settings;
  for (const auto& row : parameter_table()) {
    if (row.at("scope") != scope) continue;
    const auto name = row.at("name").get<std::string>();
    if (const auto value = node.find(name)) settings.emplace_back(name, setting_text(*value, row));
  }
  return settings;
}

}  // namespace kestrel::cli
