// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string_view>

namespace kestrel::gl {

/// Shader sources built into the library, by path below `shaders/` ("raster/gbuffer.vert").
const std::map<std::string_view, std::string_view>& embedded_shaders();

}  // namespace kestrel::gl
