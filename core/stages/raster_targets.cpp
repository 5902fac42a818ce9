// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/raster_targets.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "gl/debug.h"
#include "gl/octahedral.h"

namespace kestrel {
namespace {

constexpr GLuint kIdUnit = 6;

void require_size(int width, int height) {
  GLint limits[2] = {0, 0}, texture_limit = 0;
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, limits);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture_limit);
  if (width <= std::min(limits[0], texture_limit) && height <= std::min(limits[1], texture_limit)) {
    return;
  }
  fail(ErrorCode::unsupported,
       "A picture of {}x{} is larger than this OpenGL device draws ({}x{}); render with "
       "primary=rays, or in parts.",
       width, height, std::min(limits[0], texture_limit), std::min(limits[1], texture_limit));
}

template <typename Function>
void for_each_pixel(size_t count, const Function& function) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1 << 14), [&](const auto& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) function(i);
  });
}

template <typename T>
void read_plane(const gl::Texture2D& target, GLenum format, GLenum type, Plane<T>& plane) {
  target.read(format, type, plane.data(), plane.size() * sizeof(T));
}

}  // namespace

RasterTargets::RasterTargets(const FrameInputs& inputs)
    : width_(inputs.width), height_(inputs.height), keep_uv_(inputs.keep_uv) {
  require_size(width_, height_);
  const auto target = [&](const char* name, GLenum format) {
    return gl::Texture2D(name, format, width_, height_);
  };
  // Table 2, with reasons where the format is not the paper's. The heuristic mask (GL_R32F there)
  // has no target: stage 2 runs on the processor and fills GBuffer::heuristic_mask.
  position_ = target("position", GL_RGBA32F);
  // Not RGBA16: shading and geometric normal, octahedral, at full precision, since mirror rays
  // start with them; two vectors in one target keep the count within GL's guaranteed 8.
  normals_ = target("normals", GL_RGBA32F);
  // Not RGBA8: lamps are brighter than 1.
  emission_ = target("emission", GL_RGBA16F);
  // Not RGBA8: linear colours band in 8 bits, and ambient may exceed 1.
  ambient_ = target("ambient", GL_RGBA16F);
  // Not RGBA8: linear colours band in 8 bits.
  diffuse_ = target("diffuse", GL_RGBA16F);
  // Not RGBA8: linear colours band in 8 bits, and so would the exponent.
  specular_ = target("specular", GL_RGBA16F);
  // Not RGBA8: holds the index of refraction as it is, without an encoding.
  optical_ = target("optical", GL_RGBA16F);
  // Not in the paper: object and material of each pixel, for areas, masks and ray tracing.
  // The mesh's UVs, where they are wanted, share it as the bits of two floats.
  id_ = target("id", keep_uv_ ? GL_RGBA32UI : GL_RG32UI);
  // Not DEPTH_COMPONENT32F: the stencil keeps occlusion queries from counting a pixel twice.
  depth_ = target("depth", GL_DEPTH32F_STENCIL8);
  lighting_ = target("lighting", GL_RGBA16F);
  gl::check_errors(fmt::format("allocating targets of {}x{}", width_, height_));

  gbuffer_ = gl::Framebuffer(
      "G-buffer",
      {&position_, &normals_, &emission_, &ambient_, &diffuse_, &specular_, &optical_, &id_},
      &depth_);
  pbuffer_ = gl::Framebuffer("P-buffer", {&lighting_}, nullptr);
  occlusion_ = gl::Framebuffer("occlusion", {}, &depth_);
}

void RasterTargets::begin_gbuffer() const {
  const GLfloat zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
  const GLuint no_id[4] = {0, 0, 0, 0};
  glBindFramebuffer(GL_FRAMEBUFFER, gbuffer_.name());
  glViewport(0, 0, width_, height_);
  glDepthMask(GL_TRUE);
  for (GLint i = 0; i < 7; ++i) glClearNamedFramebufferfv(gbuffer_.name(), GL_COLOR, i, zero);
  glClearNamedFramebufferuiv(gbuffer_.name(), GL_COLOR, 7, no_id);
  // Reversed z: 0 is the far plane.
  glClearNamedFramebufferfi(gbuffer_.name(), GL_DEPTH_STENCIL, 0, 0.0f, 0);
}

void RasterTargets::begin_lighting() const {
  glBindFramebuffer(GL_FRAMEBUFFER, pbuffer_.name());
  glViewport(0, 0, width_, height_);
  const gl::Texture2D* targets[] = {&position_, &normals_,  &emission_, &ambient_,
                                    &diffuse_,  &specular_, &id_};
  for (GLuint unit = 0; unit <= kIdUnit; ++unit) {
    glBindTextureUnit(unit, targets[unit]->name());
    glBindSampler(unit, 0);
  }
}

void RasterTargets::begin_occlusion() const {
  const GLint empty = 0;
  glBindFramebuffer(GL_FRAMEBUFFER, occlusion_.name());
  glViewport(0, 0, width_, height_);
  glClearNamedFramebufferiv(occlusion_.name(), GL_STENCIL, 0, &empty);
  glBindTextureUnit(kIdUnit, id_.name());
  glBindSampler(kIdUnit, 0);
}

void RasterTargets::read(GBuffer& out) {
  const size_t pixels = out.object.size();
  read_plane(position_, GL_RGB, GL_FLOAT, out.position);
  read_plane(emission_, GL_RGB, GL_FLOAT, out.emission);
  read_plane(ambient_, GL_RGB, GL_FLOAT, out.ambient);
  read_plane(diffuse_, GL_RGBA, GL_FLOAT, out.diffuse);
  read_plane(specular_, GL_RGBA, GL_FLOAT, out.specular);
  read_plane(optical_, GL_RGB, GL_FLOAT, out.optical);
  read_plane(depth_, GL_DEPTH_COMPONENT, GL_FLOAT, out.depth);
  read_plane(lighting_, GL_RGB, GL_FLOAT, out.lighting);

  staging_.resize(pixels * sizeof(vec4));
  if (keep_uv_) {
    id_.read(GL_RGBA_INTEGER, GL_UNSIGNED_INT, staging_.data(), pixels * sizeof(uvec4));
    const auto* ids = reinterpret_cast<const uvec4*>(staging_.data());
    for_each_pixel(pixels, [&](size_t i) {
      out.object[i] = ids[i].x;
      out.material[i] = ids[i].y;
      out.uv[i] = {std::bit_cast<float>(ids[i].z), std::bit_cast<float>(ids[i].w)};
    });
  } else {
    id_.read(GL_RG_INTEGER, GL_UNSIGNED_INT, staging_.data(), pixels * sizeof(uvec2));
    const auto* ids = reinterpret_cast<const uvec2*>(staging_.data());
    for_each_pixel(pixels, [&](size_t i) {
      out.object[i] = ids[i].x;
      out.material[i] = ids[i].y;
    });
  }
  normals_.read(GL_RGBA, GL_FLOAT, staging_.data(), pixels * sizeof(vec4));
  const auto* normals = reinterpret_cast<const vec4*>(staging_.data());
  for_each_pixel(pixels, [&](size_t i) {
    const bool nothing = out.object[i] == 0;
    out.normal[i] = nothing ? vec3(0.0f) : gl::decode_octahedral(vec2(normals[i].x, normals[i].y));
    out.normal_geometric[i] =
        nothing ? vec3(0.0f) : gl::decode_octahedral(vec2(normals[i].z, normals[i].w));
  });
  gl::check_errors("reading the picture back");
}

}  // namespace kestrel
