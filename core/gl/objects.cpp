// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/objects.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "gl/debug.h"

namespace kestrel::gl {
namespace {

GLuint new_buffer() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  return name;
}

GLuint new_texture() {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  return name;
}

GLuint new_sampler() {
  GLuint name = 0;
  glCreateSamplers(1, &name);
  return name;
}

GLuint new_framebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return name;
}

GLuint new_vertex_array() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return name;
}

GLuint new_sample_query() {
  GLuint name = 0;
  glCreateQueries(GL_SAMPLES_PASSED, 1, &name);
  return name;
}

}  // namespace

Buffer::Buffer(std::string_view name_text, size_t byte_count, const void* data, GLbitfield flags)
    : Handle(new_buffer()) {
  // GL knows no empty storage.
  const size_t at_least = std::max<size_t>(byte_count, 16);
  glNamedBufferStorage(name(), static_cast<GLsizeiptr>(at_least),
                       byte_count == at_least ? data : nullptr, flags | GL_DYNAMIC_STORAGE_BIT);
  if (byte_count > 0 && byte_count < at_least && data) {
    glNamedBufferSubData(name(), 0, static_cast<GLsizeiptr>(byte_count), data);
  }
  label(GL_BUFFER, name(), name_text);
}

void MirroredBuffer::assign(const void* data, size_t byte_count) {
  if (buffer_ && byte_count == mirror_.size() &&
      (byte_count == 0 || std::memcmp(data, mirror_.data(), byte_count) == 0)) {
    return;
  }
  if (!buffer_ || byte_count > capacity_) {
    capacity_ = byte_count;
    buffer_ = Buffer(label_, capacity_, data);
    check_errors("allocating " + label_);
  } else if (byte_count > 0) {
    glNamedBufferSubData(buffer_.name(), 0, static_cast<GLsizeiptr>(byte_count), data);
  }
  const auto* bytes = static_cast<const std::byte*>(data);
  mirror_.assign(bytes, bytes + byte_count);
}

Texture2D::Texture2D(std::string_view name_text, GLenum internal_format, int width, int height)
    : Handle(new_texture()), width_(width), height_(height) {
  glTextureStorage2D(name(), 1, internal_format, width, height);
  glTextureParameteri(name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  label(GL_TEXTURE, name(), name_text);
}

void Texture2D::upload(GLenum format, GLenum type, const void* texels) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(name(), 0, 0, 0, width_, height_, format, type, texels);
}

void Texture2D::read(GLenum format, GLenum type, void* texels, size_t byte_count) const {
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  // The size is only a guard against writing past the end; pictures past 2 GiB give up its help.
  const size_t guard = std::min<size_t>(byte_count, INT32_MAX);
  if (byte_count == guard) {
    glGetTextureSubImage(name(), 0, 0, 0, 0, width_, height_, 1, format, type,
                         static_cast<GLsizei>(guard), texels);
    return;
  }
  const size_t row = byte_count / static_cast<size_t>(height_);
  for (int y = 0; y < height_; ++y) {
    glGetTextureSubImage(name(), 0, 0, y, 0, width_, 1, 1, format, type, static_cast<GLsizei>(row),
                         static_cast<std::byte*>(texels) + row * static_cast<size_t>(y));
  }
}

Sampler::Sampler(std::string_view name_text, GLenum wrap_s, GLenum wrap_t, GLenum filter)
    : Handle(new_sampler()) {
  const GLfloat transparent_black[4] = {0.0f, 0.0f, 0.0f, 0.0f};
  glSamplerParameteri(name(), GL_TEXTURE_WRAP_S, static_cast<GLint>(wrap_s));
  glSamplerParameteri(name(), GL_TEXTURE_WRAP_T, static_cast<GLint>(wrap_t));
  glSamplerParameteri(name(), GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
  glSamplerParameteri(name(), GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
  glSamplerParameterfv(name(), GL_TEXTURE_BORDER_COLOR, transparent_black);
  label(GL_SAMPLER, name(), name_text);
}

Framebuffer::Framebuffer(std::string_view name_text, const std::vector<const Texture2D*>& colors,
                         const Texture2D* depth_stencil)
    : Handle(new_framebuffer()) {
  std::vector<GLenum> draw_buffers;
  for (const Texture2D* color : colors) {
    const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(draw_buffers.size());
    glNamedFramebufferTexture(name(), attachment, color->name(), 0);
    draw_buffers.push_back(attachment);
  }
  glNamedFramebufferDrawBuffers(name(), static_cast<GLsizei>(draw_buffers.size()),
                                draw_buffers.data());
  if (depth_stencil) {
    glNamedFramebufferTexture(name(), GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil->name(), 0);
  }
  label(GL_FRAMEBUFFER, name(), name_text);
  const GLenum status = glCheckNamedFramebufferStatus(name(), GL_DRAW_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    check_errors(fmt::format("making the targets '{}'", name_text));
    fail(ErrorCode::unsupported,
         "The OpenGL driver cannot draw to the targets '{}' (status 0x{:x}); render with "
         "primary=rays.",
         name_text, status);
  }
}

VertexArray::VertexArray(std::string_view name_text) : Handle(new_vertex_array()) {
  label(GL_VERTEX_ARRAY, name(), name_text);
}

void VertexArray::set_floats(GLuint index, int components, const Buffer& buffer) const {
  if (!buffer) {
    glDisableVertexArrayAttrib(name(), index);
    return;
  }
  glVertexArrayVertexBuffer(name(), index, buffer.name(), 0,
                            components * static_cast<GLsizei>(sizeof(float)));
  glVertexArrayAttribFormat(name(), index, components, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(name(), index, index);
  glEnableVertexArrayAttrib(name(), index);
}

Shader::Shader(GLenum stage, std::string_view name_text) : Handle(glCreateShader(stage)) {
  label(GL_SHADER, name(), name_text);
}

SampleQuery::SampleQuery() : Handle(new_sample_query()) {}

uint64_t SampleQuery::result() const {
  GLuint64 samples = 0;
  glGetQueryObjectui64v(name(), GL_QUERY_RESULT, &samples);
  return samples;
}

}  // namespace kestrel::gl
