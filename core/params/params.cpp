// SPDX-License-Identifier: GPL-3.0-or-later
#include "params/params.h"

#include <charconv>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace kestrel {
namespace {

double parse_number(const Parameter& p, std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = p.type != ParameterType::integer || value == std::floor(value);
  if (error != std::errc() || end != text.data() + text.size() || !whole ||
      !(value >= p.minimum && value <= p.maximum)) {
    fail(ErrorCode::invalid_argument, "'{}' is no value of '{}'. Use {} from {} to {}.", text,
         p.name, p.type == ParameterType::integer ? "a whole number" : "a number", p.minimum,
         p.maximum);
  }
  return value;
}

double parse_enumeration(const Parameter& p, std::string_view text) {
  std::string known;
  for (size_t i = 0; i < p.items.size(); ++i) {
    if (p.items[i] == text) return static_cast<double>(i);
    known += (i ? ", " : "") + std::string(p.items[i]);
  }
  fail(ErrorCode::invalid_argument, "'{}' is no value of '{}'. Use one of: {}.", text, p.name,
       known);
}

double parse_boolean(const Parameter& p, std::string_view text) {
  if (text == "true" || text == "1") return 1.0;
  if (text == "false" || text == "0") return 0.0;
  fail(ErrorCode::invalid_argument, "'{}' is no value of '{}'. Use true or false.", text, p.name);
}

vec3 parse_color(const Parameter& p, std::string_view text) {
  std::vector<std::string_view> words;
  for (std::string_view rest = text; rest.find_first_not_of(' ') != std::string_view::npos;) {
    rest.remove_prefix(rest.find_first_not_of(' '));
    words.push_back(rest.substr(0, rest.find(' ')));
    rest.remove_prefix(words.back().size());
  }
  if (words.size() != 3) {
    fail(ErrorCode::invalid_argument,
         "'{}' is no value of '{}'. Use three numbers, red, green and blue: \"0.5 0.5 0.5\".", text,
         p.name);
  }
  return vec3(parse_number(p, words[0]), parse_number(p, words[1]), parse_number(p, words[2]));
}

/// A row with the way to its field, as text.
template <typename S>
struct Row {
  Parameter parameter;
  std::function<std::string(const Parameter&, const S&)> get;
  std::function<void(const Parameter&, S&, std::string_view)> set;
};

template <typename S, typename T>
Row<S> row(T S::*field, Parameter parameter) {
  Row<S> r{std::move(parameter), {}, {}};
  if constexpr (std::is_same_v<T, vec3>) {
    r.get = [field](const Parameter&, const S& s) {
      const vec3& v = s.*field;
      return fmt::format("{} {} {}", v.x, v.y, v.z);
    };
    r.set = [field](const Parameter& p, S& s, std::string_view t) { s.*field = parse_color(p, t); };
  } else if constexpr (std::is_same_v<T, bool>) {
    r.get = [field](const Parameter&, const S& s) { return s.*field ? "true" : "false"; };
    r.set = [field](const Parameter& p, S& s, std::string_view t) {
      s.*field = parse_boolean(p, t) != 0.0;
    };
  } else if constexpr (std::is_enum_v<T>) {
    r.get = [field](const Parameter& p, const S& s) {
      return std::string(p.items.at(static_cast<size_t>(s.*field)));
    };
    r.set = [field](const Parameter& p, S& s, std::string_view t) {
      s.*field = static_cast<T>(static_cast<int>(parse_enumeration(p, t)));
    };
  } else {
    r.get = [field](const Parameter&, const S& s) { return fmt::format("{}", s.*field); };
    r.set = [field](const Parameter& p, S& s, std::string_view t) {
      s.*field = static_cast<T>(parse_number(p, t));
    };
  }
  return r;
}

constexpr auto kScene = ParameterScope::scene;
constexpr auto kObject = ParameterScope::object;
constexpr auto kBool = ParameterType::boolean;
constexpr auto kInt = ParameterType::integer;
constexpr auto kReal = ParameterType::real;
constexpr auto kColor = ParameterType::color;
constexpr auto kEnum = ParameterType::enumeration;

// A row reads: name, scope, type, default, range, items, unit, letter, help.
// clang-format off
const std::vector<Row<Settings>>& scene_rows() {
  using S = Settings;
  static const std::vector<Row<S>> rows = {
      row(&S::budget_ms,
          {"budget_ms", kScene, kReal, "0", 0, 1e6, {}, "ms", "T",
           "Time that ray tracing may take per frame, in milliseconds. Objects that do not fit "
           "keep their rasterised look, so less is faster and shows fewer shadows, reflections "
           "and refractions. 0 means no limit"}),
      row(&S::selection_inertia,
          {"selection_inertia", kScene, kReal, "500", 0, 1e9, {}, "", "I",
           "How strongly an object that was ray traced in the last frame is preferred in the "
           "next. Higher values flicker less and react later, and cost no time; the unit is that "
           "of visibility, pixels per metre"}),
      row(&S::max_depth,
          {"max_depth", kScene, kInt, "10", 1, 64, {}, "", "",
           "Longest chain of reflections and refractions that is followed. Glass and mirrors "
           "that face each other need more; each step may cost another ray"}),
      row(&S::importance_cutoff,
          {"importance_cutoff", kScene, kReal, "0.01", 0, 1, {}, "", "",
           "A reflection or refraction is no longer followed once its share of the pixel falls "
           "below this. Lower is more exact and slower"}),
      row(&S::ambient,
          {"ambient", kScene, kColor, "0 0 0", 0, 1e6, {}, "", "",
           "Global ambient light: linear red, green and blue, reflected by every surface's "
           "ambient colour. It costs no time"}),
      row(&S::environment_ior,
          {"environment_ior", kScene, kReal, "1", 0.1, 10, {}, "", "",
           "Index of refraction of what surrounds the objects: 1 for air, 1.33 for water. It "
           "bends light at every glass surface and costs no time"}),
      row(&S::selection,
          {"selection", kScene, kEnum, "graph", 0, 0, {"graph", "all", "none"}, "", "",
           "Which objects are ray traced: the most relevant within the budget, all visible ones "
           "whatever it costs, or none, which is the fastest"}),
      row(&S::shading_model,
          {"shading_model", kScene, kEnum, "blinn_phong", 0, 0, {"blinn_phong"}, "", "",
           "How light is reflected by a surface: the formula for diffuse reflection and "
           "highlights"}),
      row(&S::primary,
          {"primary", kScene, kEnum, "auto", 0, 0, {"auto", "raster", "rays"}, "", "",
           "How the objects in view are found: rasterised with OpenGL, by rays on the processor, "
           "or whichever is faster on this machine"}),
      row(&S::tracer,
          {"tracer", kScene, kEnum, "auto", 0, 0, {"auto", "embree"}, "", "",
           "What traces shadows, reflections and refractions, which decides how exact they are "
           "and how long they take"}),
      row(&S::samples,
          {"samples", kScene, kInt, "16", 1, 65536, {}, "", "",
           "Anti-aliasing samples per pixel of the picture. More give smoother edges; the time "
           "grows in proportion"}),
      row(&S::first_sample,
          {"first_sample", kScene, kInt, "0", 0, 1 << 24, {}, "", "",
           "Number of the first sample. Pictures of consecutive samples, weighted by how many "
           "each has, add up to the picture of all of them"}),
      row(&S::pixel_filter,
          {"pixel_filter", kScene, kEnum, "blackman_harris", 0, 0, {"box", "blackman_harris"}, "",
           "", "How samples are weighted around a pixel's centre: sharp or smooth. It costs no time"}),
      row(&S::filter_width,
          {"filter_width", kScene, kReal, "1.5", 0.01, 10, {}, "px", "",
           "Width of the pixel filter. Wider is softer, narrower is sharper and shows steps at "
           "edges. It costs no time"}),
      row(&S::shadow_mode,
          {"shadow_mode", kScene, kEnum, "hard", 0, 0, {"hard"}, "", "",
           "Shadow edges: hard treats every light as a point or a direction"}),
      row(&S::threads,
          {"threads", kScene, kInt, "0", 0, 1024, {}, "", "",
           "Processor threads to use, 0 for all. Fewer leave the machine free for other work and "
           "take longer; the picture does not depend on it"}),
      row(&S::validate_areas,
          {"validate_areas", kScene, kBool, "false", 0, 0, {}, "", "A",
           "Also measure visible areas with occlusion queries and report objects whose area "
           "differs. Needs OpenGL and takes longer; for checking only"}),
      row(&S::film_transparent,
          {"film_transparent", kScene, kBool, "false", 0, 0, {}, "", "",
           "Leave the world out of the picture: it still lights and shows in mirrors and glass, "
           "and the picture's alpha is 0 where nothing else is seen"}),
      row(&S::motion_blur,
          {"motion_blur", kScene, kBool, "false", 0, 0, {}, "", "",
           "Blur what moves while the shutter is open. Each sample has its own moment, for which "
           "what moves is built anew; fast motion needs many samples"}),
  };
  return rows;
}

const std::vector<Row<ObjectSettings>>& object_rows() {
  using S = ObjectSettings;
  static const std::vector<std::string_view> kModes = {"auto", "always", "never"};
  static const std::vector<Row<S>> rows = {
      row(&S::relevance,
          {"relevance", kObject, kReal, "1", 0, 1e6, {}, "", "K",
           "How much this object matters. Within the budget, objects of higher relevance are ray "
           "traced first, at the cost of the others; 0 leaves it for last"}),
      row(&S::cost,
          {"cost", kObject, kReal, "0", 0, 1e6, {}, "", "E",
           "Estimated cost of a ray on this object, 1 for an average one. Dearer objects are "
           "chosen later. 0 learns it from measured times"}),
      row(&S::shadows,
          {"shadows", kObject, kEnum, "auto", 0, 0, kModes, "", "",
           "Shadows received by this object: ray traced as the budget allows, always, or never. A "
           "ray for each light and pixel"}),
      row(&S::reflections,
          {"reflections", kObject, kEnum, "auto", 0, 0, kModes, "", "",
           "Reflections in this object: ray traced as the budget allows, always, or never. A ray "
           "for each pixel, and one more for each surface that is mirrored in turn"}),
      row(&S::refractions,
          {"refractions", kObject, kEnum, "auto", 0, 0, kModes, "", "",
           "Refraction through this object: ray traced as the budget allows, always, or never. Two "
           "rays or more for each pixel"}),
  };
  return rows;
}
// clang-format on

template <typename S>
const Row<S>& find_row(const std::vector<Row<S>>& rows, std::string_view name) {
  std::string known;
  for (const Row<S>& r : rows) {
    if (r.parameter.name == name) return r;
    known += known.empty() ? "" : ", ";
    known += r.parameter.name;
  }
  fail(ErrorCode::invalid_argument, "There is no setting '{}'. Known settings: {}.", name, known);
}

}  // namespace

const std::vector<Parameter>& parameter_table() {
  static const std::vector<Parameter> table = [] {
    std::vector<Parameter> all;
    for (const auto& r : scene_rows()) all.push_back(r.parameter);
    for (const auto& r : object_rows()) all.push_back(r.parameter);
    return all;
  }();
  return table;
}

const Parameter& find_parameter(ParameterScope scope, std::string_view name) {
  return scope == kScene ? find_row(scene_rows(), name).parameter
                         : find_row(object_rows(), name).parameter;
}

void set_parameter(Settings& settings, std::string_view name, std::string_view value) {
  const auto& r = find_row(scene_rows(), name);
  r.set(r.parameter, settings, value);
}

void set_parameter(ObjectSettings& settings, std::string_view name, std::string_view value) {
  const auto& r = find_row(object_rows(), name);
  r.set(r.parameter, settings, value);
}

std::string get_parameter(const Settings& settings, std::string_view name) {
  const auto& r = find_row(scene_rows(), name);
  return r.get(r.parameter, settings);
}

std::string get_parameter(const ObjectSettings& settings, std::string_view name) {
  const auto& r = find_row(object_rows(), name);
  return r.get(r.parameter, settings);
}

std::string parameter_table_json() {
  static constexpr const char* kTypes[] = {"bool", "int", "float", "color", "enum"};
  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  for (const Parameter& p : parameter_table()) {
    nlohmann::ordered_json entry = {{"name", p.name},
                                    {"scope", p.scope == kScene ? "scene" : "object"},
                                    {"type", kTypes[static_cast<int>(p.type)]},
                                    {"default", p.default_value},
                                    {"unit", p.unit},
                                    {"paper", p.paper},
                                    {"help", p.help}};
    if (p.type == kEnum) entry["items"] = p.items;
    if (p.type == kInt || p.type == kReal || p.type == kColor) {
      entry["min"] = p.minimum;
      entry["max"] = p.maximum;
    }
    table.push_back(entry);
  }
  return table.dump();
}

}  // namespace kestrel
