// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/shader_library.h"

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "gl/debug.h"
#include "gl/embedded_shaders.h"

namespace kestrel::gl {
namespace {

constexpr std::string_view kInclude = "#include \"";

/// Expands one file into `out`; `paths` are the files seen, by source string number.
void expand(std::string_view path, std::vector<std::string>& paths, std::string& out) {
  const auto found = embedded_shaders().find(path);
  if (found == embedded_shaders().end()) {
    fail(ErrorCode::unknown, "The shader '{}' is not built into this library; build it anew.",
         path);
  }
  const size_t number = paths.size();
  paths.emplace_back(path);
  out += fmt::format("#line 1 {}\n", number);
  std::string_view text = found->second;
  for (int line_number = 1; !text.empty(); ++line_number) {
    const size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
    if (line.substr(0, kInclude.size()) != kInclude) {
      out.append(line) += '\n';
      continue;
    }
    const std::string_view rest = line.substr(kInclude.size());
    const std::string_view included = rest.substr(0, rest.find('"'));
    if (std::find(paths.begin(), paths.end(), included) == paths.end()) {
      expand(included, paths, out);
    }
    out += fmt::format("#line {} {}\n", line_number + 1, number);
  }
}

std::string shader_log(GLuint shader) {
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string text(static_cast<size_t>(std::max(length, 1)), '\0');
  glGetShaderInfoLog(shader, length, nullptr, text.data());
  return text.c_str();
}

std::string program_log(GLuint program) {
  GLint length = 0;
  glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
  std::string text(static_cast<size_t>(std::max(length, 1)), '\0');
  glGetProgramInfoLog(program, length, nullptr, text.data());
  return text.c_str();
}

Shader compile(const ShaderStage& stage) {
  std::string files;
  const std::string source = expand_shader(stage.path, files);
  const char* text = source.c_str();
  Shader shader(stage.stage, stage.path);
  glShaderSource(shader.name(), 1, &text, nullptr);
  glCompileShader(shader.name());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    fail(ErrorCode::unsupported,
         "The OpenGL driver refuses the shader '{}' (files: {}); update it, or render with "
         "primary=rays. It says: {}",
         stage.path, files, shader_log(shader.name()));
  }
  return shader;
}

}  // namespace

std::string expand_shader(std::string_view path, std::string& files) {
  std::vector<std::string> paths;
  std::string out = "#version 450 core\n";
  expand(path, paths, out);
  files.clear();
  for (size_t i = 0; i < paths.size(); ++i) {
    files += fmt::format("{}{} {}", i == 0 ? "" : ", ", i, paths[i]);
  }
  return out;
}

Program build_program(std::string_view name_text, std::initializer_list<ShaderStage> stages) {
  std::vector<Shader> shaders;
  for (const ShaderStage& stage : stages) shaders.push_back(compile(stage));
  Program program(glCreateProgram());
  for (const Shader& shader : shaders) glAttachShader(program.name(), shader.name());
  glLinkProgram(program.name());
  for (const Shader& shader : shaders) glDetachShader(program.name(), shader.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (!linked) {
    fail(ErrorCode::unsupported,
         "The OpenGL driver cannot link the program '{}'; update it, or render with "
         "primary=rays. It says: {}",
         name_text, program_log(program.name()));
  }
  label(GL_PROGRAM, program.name(), name_text);
  return program;
}

}  // namespace kestrel::gl
