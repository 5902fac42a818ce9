// SPDX-License-Identifier: GPL-3.0-or-later
// GLSL programs from the shaders built into the library.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "gl/objects.h"

namespace kestrel::gl {

/// The text of an embedded shader with its `#include "common/…"` lines replaced, each file once,
/// and `#version 450 core` in front. Line numbers in messages are "source string:line", the source
/// strings being listed in `files`. Throws Error(unknown) for a path that is not embedded.
std::string expand_shader(std::string_view path, std::string& files);

struct ShaderStage {
  GLenum stage;           // GL_VERTEX_SHADER …
  std::string_view path;  // below shaders/
};

/// Compiles and links. Throws Error(unsupported) with the driver's log: the shaders are ours, so a
/// driver that refuses one lacks something. GL thread only.
Program build_program(std::string_view label, std::initializer_list<ShaderStage> stages);

}  // namespace kestrel::gl
