// SPDX-License-Identifier: GPL-3.0-or-later
// The one parameter table. From it come the C++ structs, get and set by name in the C ABI, the
// command's options, Blender's properties and the reference in the docs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"

namespace kestrel {

enum class Primary : int { automatic, raster, rays };
enum class TracerKind : int { automatic, embree };
enum class SelectionPolicy : int { graph, all, none };
enum class ShadingModel : int { blinn_phong };
enum class PixelFilter : int { box, blackman_harris };
enum class ShadowMode : int { hard };
/// Per object and effect: let the heuristic decide, or override it.
enum class EffectMode : int { automatic, always, never };

/// Settings of a whole render. Every field is a row of `parameter_table()`.
struct Settings {
  float budget_ms = 0.0f;
  float selection_inertia = 500.0f;
  int max_depth = 10;
  float importance_cutoff = 0.01f;
  vec3 ambient{0.0f};
  float environment_ior = 1.0f;
  SelectionPolicy selection = SelectionPolicy::graph;
  ShadingModel shading_model = ShadingModel::blinn_phong;
  Primary primary = Primary::automatic;
  TracerKind tracer = TracerKind::automatic;
  int samples = 16;
  int first_sample = 0;
  PixelFilter pixel_filter = PixelFilter::blackman_harris;
  float filter_width = 1.5f;
  ShadowMode shadow_mode = ShadowMode::hard;
  int threads = 0;
  bool validate_areas = false;
  bool film_transparent = false;
  bool motion_blur = false;
};

/// Settings of one object (paper: K and E), and per-effect overrides.
struct ObjectSettings {
  float relevance = 1.0f;
  float cost = 0.0f;
  EffectMode shadows = EffectMode::automatic;
  EffectMode reflections = EffectMode::automatic;
  EffectMode refractions = EffectMode::automatic;
};

enum class ParameterScope { scene, object };
enum class ParameterType { boolean, integer, real, color, enumeration };

/// One row. Values of every type travel as text: "true", "12", "0.5", "0.1 0.2 0.3", "graph".
struct Parameter {
  std::string_view name;
  ParameterScope scope;
  ParameterType type;
  std::string_view default_value;
  double minimum;                       // numbers only
  double maximum;                       // numbers only
  std::vector<std::string_view> items;  // enumerations only, in enum order
  std::string_view unit;                // "ms", "px", "" …
  std::string_view paper;               // the paper's letter, "" where it has none
  std::string_view help;                // one or two sentences: what it does and what it costs
};

const std::vector<Parameter>& parameter_table();

/// The row called `name` in `scope`; throws Error(invalid_argument) that lists the known ones.
const Parameter& find_parameter(ParameterScope scope, std::string_view name);

/// Sets one field from text; throws Error(invalid_argument) naming range or items when it is off.
void set_parameter(Settings& settings, std::string_view name, std::string_view value);
void set_parameter(ObjectSettings& settings, std::string_view name, std::string_view value);

std::string get_parameter(const Settings& settings, std::string_view name);
std::string get_parameter(const ObjectSettings& settings, std::string_view name);

/// The table as a JSON array of objects with the fields of `Parameter`.
std::string parameter_table_json();

}  // namespace kestrel
