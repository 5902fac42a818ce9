// SPDX-License-Identifier: GPL-3.0-or-later
// Move-only owners of OpenGL objects, made with direct state access. Create, use and destroy them
// on the GL thread alone; an owner made by default owns nothing.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kestrel::gl {

/// Owns one GL name; `Kind::destroy` deletes it.
template <typename Kind>
class Handle {
 public:
  Handle() = default;
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }

  GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 protected:
  explicit Handle(GLuint name) : name_(name) {}

 private:
  void reset() {
    if (name_ != 0) Kind::destroy(name_);
    name_ = 0;
  }
  GLuint name_ = 0;
};

struct BufferKind {
  static void destroy(GLuint name) { glDeleteBuffers(1, &name); }
};
struct TextureKind {
  static void destroy(GLuint name) { glDeleteTextures(1, &name); }
};
struct SamplerKind {
  static void destroy(GLuint name) { glDeleteSamplers(1, &name); }
};
struct FramebufferKind {
  static void destroy(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct VertexArrayKind {
  static void destroy(GLuint name) { glDeleteVertexArrays(1, &name); }
};
struct ProgramKind {
  static void destroy(GLuint name) { glDeleteProgram(name); }
};
struct ShaderKind {
  static void destroy(GLuint name) { glDeleteShader(name); }
};
struct QueryKind {
  static void destroy(GLuint name) { glDeleteQueries(1, &name); }
};

/// Memory of a fixed size; `flags` as glNamedBufferStorage takes them (0: never changes).
class Buffer : public Handle<BufferKind> {
 public:
  Buffer() = default;
  Buffer(std::string_view label, size_t byte_count, const void* data, GLbitfield flags = 0);

  template <typename T>
  Buffer(std::string_view label, const std::vector<T>& data)
      : Buffer(label, data.size() * sizeof(T), data.data()) {}
};

/// Bytes that are sent again only when they differ from those sent last; grows as needed.
class MirroredBuffer {
 public:
  explicit MirroredBuffer(std::string label) : label_(std::move(label)) {}

  void assign(const void* data, size_t byte_count);
  template <typename T>
  void assign(const std::vector<T>& data) {
    assign(data.data(), data.size() * sizeof(T));
  }

  GLuint name() const { return buffer_.name(); }

 private:
  std::string label_;
  Buffer buffer_;
  size_t capacity_ = 0;
  std::vector<std::byte> mirror_;
};

/// A 2D image with one level.
class Texture2D : public Handle<TextureKind> {
 public:
  Texture2D() = default;
  Texture2D(std::string_view label, GLenum internal_format, int width, int height);

  /// Replaces every texel; rows follow each other without padding, row 0 first.
  void upload(GLenum format, GLenum type, const void* texels);
  /// Reads every texel, packed as in upload().
  void read(GLenum format, GLenum type, void* texels, size_t byte_count) const;

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  int width_ = 0;
  int height_ = 0;
};

/// How a texture is read; borders are transparent black. Level 0 alone.
class Sampler : public Handle<SamplerKind> {
 public:
  Sampler() = default;
  Sampler(std::string_view label, GLenum wrap_s, GLenum wrap_t, GLenum filter);
};

class Framebuffer : public Handle<FramebufferKind> {
 public:
  Framebuffer() = default;
  /// Colour attachments in order, all drawn to; `depth_stencil` may be null. Throws
  /// Error(unsupported) where the driver cannot draw to that combination.
  Framebuffer(std::string_view label, const std::vector<const Texture2D*>& colors,
              const Texture2D* depth_stencil);
};

class VertexArray : public Handle<VertexArrayKind> {
 public:
  VertexArray() = default;
  explicit VertexArray(std::string_view label);

  /// Attribute `index` reads `components` floats from tightly packed `buffer`; an empty buffer
  /// switches the attribute off, which then has its constant value.
  void set_floats(GLuint index, int components, const Buffer& buffer) const;
};

class Program : public Handle<ProgramKind> {
 public:
  Program() = default;
  /// Takes over a linked program.
  explicit Program(GLuint linked) : Handle(linked) {}
};

class Shader : public Handle<ShaderKind> {
 public:
  Shader(GLenum stage, std::string_view label);
};

/// Counts the samples that pass between begin() and end().
class SampleQuery : public Handle<QueryKind> {
 public:
  SampleQuery();
  void begin() { glBeginQuery(GL_SAMPLES_PASSED, name()); }
  void end() { glEndQuery(GL_SAMPLES_PASSED); }
  /// Waits for the result.
  uint64_t result() const;
};

}  // namespace kestrel::gl
