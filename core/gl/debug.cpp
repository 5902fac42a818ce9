// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/debug.h"

#include <algorithm>

#include "base/error.h"
#include "base/log.h"

namespace kestrel::gl {
namespace {

/// The driver's explanation of its last error on this GL thread.
thread_local std::string last_error_text;

void GLAPIENTRY receive_message(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length,
                                const GLchar* text, const void*) {
  const std::string_view message(text, static_cast<size_t>(std::max(length, 0)));
  if (type == GL_DEBUG_TYPE_ERROR) {
    last_error_text = message;
    log::warning_once("OpenGL: {}", message);
  } else if (severity != GL_DEBUG_SEVERITY_NOTIFICATION) {
    log::debug("OpenGL: {}", message);
  }
}

const char* error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    case GL_CONTEXT_LOST:
      return "GL_CONTEXT_LOST";
    default:
      return "an unknown error";
  }
}

}  // namespace

void install_debug_output() {
  glEnable(GL_DEBUG_OUTPUT);
  if (log::enabled(log::Level::debug)) glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(receive_message, nullptr);
  // Our own group markers would come back as messages.
  for (const GLenum type : {GL_DEBUG_TYPE_PUSH_GROUP, GL_DEBUG_TYPE_POP_GROUP}) {
    glDebugMessageControl(GL_DONT_CARE, type, GL_DONT_CARE, 0, nullptr, GL_FALSE);
  }
}

void check_errors(std::string_view what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  // Errors are flags, one each: leave none behind for the next check. A lost context repeats.
  for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
  }
  const std::string detail = last_error_text.empty() ? "" : " (" + last_error_text + ")";
  last_error_text.clear();
  if (error == GL_OUT_OF_MEMORY) {
    fail(ErrorCode::out_of_memory,
         "OpenGL ran out of memory while {}{}; use a smaller picture or smaller textures, or "
         "render with primary=rays.",
         what, detail);
  }
  fail(ErrorCode::unknown, "OpenGL failed while {}: {}{}; render with primary=rays to go without.",
       what, error_name(error), detail);
}

void label(GLenum kind, GLuint object, std::string_view name) {
  constexpr size_t kLongest = 255;  // GL_MAX_LABEL_LENGTH is at least 256, its final zero included
  glObjectLabel(kind, object, static_cast<GLsizei>(std::min(name.size(), kLongest)), name.data());
}

DebugGroup::DebugGroup(std::string_view name) {
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, static_cast<GLsizei>(name.size()), name.data());
}

DebugGroup::~DebugGroup() {
  glPopDebugGroup();
}

}  // namespace kestrel::gl
