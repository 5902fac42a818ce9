// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of evaluate.glsl by name.
#pragma once

#include <array>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "shading/node_textures.h"

namespace kestrel::nodes {

#include "evaluate.glsl"

inline constexpr size_t kParameters = 12;

struct NodeFunction {
  std::string_view name;
  std::string_view parameters;  // separated by spaces
};

inline constexpr std::array kNodeFunctions = {
    NodeFunction{"white_noise", "dimensions"},
    NodeFunction{"noise",
                 "dimensions type normalize scale detail roughness lacunarity offset gain "
                 "distortion blender"},
    NodeFunction{"musgrave", "dimensions type scale detail dimension lacunarity offset gain"},
    NodeFunction{"voronoi",  // feature + 5: the position
                 "dimensions feature metric normalize scale detail roughness lacunarity "
                 "smoothness exponent randomness blender"},
    NodeFunction{"wave",
                 "type direction profile scale distortion detail detail_scale roughness phase "
                 "blender"},
    NodeFunction{"magic", "depth scale distortion blender"},
    NodeFunction{"gradient", "type"},
    NodeFunction{"checker", "scale"},
    NodeFunction{"brick",
                 "scale mortar_size mortar_smooth bias brick_width row_height offset "
                 "offset_frequency squash squash_frequency"},
    NodeFunction{"blend", "type factor b_red b_green b_blue"},
    NodeFunction{"color_space", "conversion"},
    NodeFunction{"hue_saturation", "hue saturation value"},
    NodeFunction{"bright_contrast", "bright contrast"},
    NodeFunction{"gamma", "gamma"},
    NodeFunction{"invert", "factor"},
    NodeFunction{"luminance", ""},
    NodeFunction{"blackbody", "at_0 by_x"},
    NodeFunction{"wavelength", "at_0 by_x"},
};

struct NodeCall {
  int function;  // place in kNodeFunctions
  float parameters[kParameters] = {};

  vec4 operator()(const vec4& at) { return evaluate(function, parameters, at); }
};

/// The call that a line such as "magic 2 5 1 3" stands for, or nothing where name or number of
/// parameters are wrong.
inline std::optional<NodeCall> parse_call(const std::string& line) {
  std::istringstream words(line);
  std::string name;
  words >> name;
  for (size_t i = 0; i < kNodeFunctions.size(); ++i) {
    if (kNodeFunctions[i].name != name) continue;
    NodeCall call{static_cast<int>(i)};
    std::istringstream named{std::string(kNodeFunctions[i].parameters)};
    size_t count = 0;
    for (std::string parameter; named >> parameter;) {
      if (!(words >> call.parameters[count++])) return std::nullopt;
    }
    return (words >> name) ? std::nullopt : std::optional(call);
  }
  return std::nullopt;
}

}  // namespace kestrel::nodes
