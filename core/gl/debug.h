// SPDX-License-Identifier: GPL-3.0-or-later
// What OpenGL says: its messages go to the log, its errors become exceptions. GL thread only.
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <string_view>

namespace kestrel::gl {

/// Sends KHR_debug messages of the current context to the log: errors as warnings, each once, the
/// rest at debug level. Where debug logging is on, messages come in step with the calls.
void install_debug_output();

/// Throws where an error is pending: Error(out_of_memory), else Error(unknown), with the driver's
/// text. `what` says what was being done ("uploading the mesh Suzanne").
void check_errors(std::string_view what);

/// Names an object for debuggers and messages; `kind` is GL_BUFFER, GL_TEXTURE …
void label(GLenum kind, GLuint object, std::string_view name);

/// Marks the calls of a scope, for debuggers such as RenderDoc.
class DebugGroup {
 public:
  explicit DebugGroup(std::string_view name);
  ~DebugGroup();
  DebugGroup(const DebugGroup&) = delete;
  DebugGroup& operator=(const DebugGroup&) = delete;
};

}  // namespace kestrel::gl
