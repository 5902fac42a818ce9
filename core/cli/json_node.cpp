// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/json_node.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <numeric>
#include <set>

#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

constexpr int kMaximumDepth = 64;

/// Levenshtein distance.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

std::string escaped(std::string_view key) {
  std::string out;
  for (const char c : key) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

/// The parser's text without its "[json.exception…] " prefix.
std::string parser_reason(const std::exception& error) {
  const std::string text = error.what();
  const size_t end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

std::string described(const nlohmann::json& value) {
  if (value.is_null()) return "null";
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return fmt::format("the number {}", value.dump());
  if (value.is_string()) return "a text";
  return value.is_array() ? "an array" : "an object";
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  std::string best;
  size_t best_distance = std::max<size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    if (name.size() > 64 || candidate.size() > 64) continue;
    const size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

nlohmann::json parse_json(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto check = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > kMaximumDepth) {
      throw SceneFileError(file, "", fmt::format("nested deeper than {} levels", kMaximumDepth));
    }
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(parsed.get<std::string>()).second) {
      throw SceneFileError(file, "",
                           fmt::format("the key '{}' stands twice in one object; remove one",
                                       parsed.get<std::string>()));
    }
    return true;
  };
  try {
    return nlohmann::json::parse(text, check);
  } catch (const nlohmann::json::exception& error) {
    throw SceneFileError(file, "", fmt::format("not valid JSON: {}", parser_reason(error)));
  }
}

void JsonNode::fail_type(std::string_view expected) const {
  fail("expected {}, found {}", expected, described(*value_));
}

void JsonNode::expect_keys(const std::vector<std::string>& known) const {
  if (!value_->is_object()) fail_type("an object");
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw SceneFileError(
        *file_, pointer_ + "/" + escaped(key),
        fmt::format("unknown key{}", nearest_name(key, known).empty()
                                         ? fmt::format("; known here: {}", fmt::join(known, ", "))
                                         : did_you_mean(key, known)));
  }
}

std::optional<JsonNode> JsonNode::find(const std::string& key) const {
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return JsonNode(*file_, *it, pointer_ + "/" + escaped(key));
}

JsonNode JsonNode::require(const std::string& key) const {
  if (!value_->is_object()) fail_type("an object");
  if (auto node = find(key)) return *node;
  throw SceneFileError(*file_, pointer_ + "/" + escaped(key), "missing");
}

std::vector<JsonNode> JsonNode::items(size_t limit) const {
  if (!value_->is_array()) fail_type("an array");
  if (value_->size() > limit) {
    fail("{} entries; at most {} are allowed", value_->size(), limit);
  }
  std::vector<JsonNode> nodes;
  nodes.reserve(value_->size());
  for (size_t i = 0; i < value_->size(); ++i) {
    nodes.emplace_back(*file_, (*value_)[i], fmt::format("{}/{}", pointer_, i));
  }
  return nodes;
}

float JsonNode::number(double minimum, double maximum) const {
  if (!value_->is_number()) {
    fail_type(fmt::format("a number from {:g} to {:g}", minimum, maximum));
  }
  const double v = value_->get<double>();
  if (!(v >= minimum && v <= maximum)) {
    fail("expected a number from {:g} to {:g}, found {:g}", minimum, maximum, v);
  }
  return static_cast<float>(v);
}

int JsonNode::integer(int minimum, int maximum) const {
  const bool is_number = value_->is_number();
  const double v = is_number ? value_->get<double>() : 0.0;
  if (!is_number || v != std::floor(v) || v < minimum || v > maximum) {
    fail_type(fmt::format("a whole number from {} to {}", minimum, maximum));
  }
  return static_cast<int>(v);
}

uint64_t JsonNode::whole() const {
  if (!value_->is_number_unsigned()) fail_type("a whole number from 0 to 2^64 - 1");
  return value_->get<uint64_t>();
}

float JsonNode::radians(double minimum, double maximum) const {
  number(minimum, maximum);
  return static_cast<float>(glm::radians(value_->get<double>()));
}

bool JsonNode::boolean() const {
  if (!value_->is_boolean()) fail_type("true or false");
  return value_->get<bool>();
}

std::string JsonNode::text() const {
  if (!value_->is_string()) fail_type("a text");
  const auto& text = value_->get_ref<const std::string&>();
  if (text.empty()) fail("expected a text that is not empty");
  if (text.size() > kMaximumSceneText) fail("longer than {} bytes", kMaximumSceneText);
  for (const unsigned char c : text) {
    if (c < 0x20) fail("a text must not hold control characters");
  }
  return text;
}

std::vector<float> JsonNode::numbers(size_t least, size_t most, double minimum,
                                     double maximum) const {
  const auto expected = [&] {
    return least == most ? fmt::format("an array of {} numbers", least)
                         : fmt::format("an array of {} to {} numbers", least, most);
  };
  if (!value_->is_array()) fail_type(expected());
  if (value_->size() < least || value_->size() > most) {
    fail("expected {}, found {}", expected(), value_->size());
  }
  std::vector<float> out;
  out.reserve(value_->size());
  for (size_t i = 0; i < value_->size(); ++i) {
    const nlohmann::json& item = (*value_)[i];
    const double v = item.is_number() ? item.get<double>() : NAN;
    if (!(v >= minimum && v <= maximum)) {
      return {JsonNode(*file_, item, fmt::format("{}/{}", pointer_, i)).number(minimum, maximum)};
    }
    out.push_back(static_cast<float>(v));
  }
  return out;
}

int JsonNode::choice(const std::vector<std::string>& names) const {
  if (!value_->is_string()) fail_type(fmt::format("one of: {}", fmt::join(names, ", ")));
  const auto& name = value_->get_ref<const std::string&>();
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end()) {
    fail("expected one of: {}; found '{}'", fmt::join(names, ", "), name.substr(0, 80));
  }
  return static_cast<int>(it - names.begin());
}

}  // namespace kestrel::cli
