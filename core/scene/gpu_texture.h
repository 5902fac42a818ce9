// SPDX-License-Identifier: GPL-3.0-or-later
// Textures as the shaders read them.
#pragma once

#include <array>

#include "gl/objects.h"
#include "scene/scene.h"

namespace kestrel {

/// The texture itself where both sides are at most `limit`, else a copy averaged down to fit;
/// sRGB texels are averaged as linear light.
Texture fit_texture(const Texture& texture, int limit);

/// GL_SRGB8_ALPHA8, GL_RGBA8, or for float texels GL_RGBA16F where that loses nothing (as for
/// files of half floats), else GL_RGBA32F.
GLenum texture_format(const Texture& texture);

/// Level 0 in GL memory; white where the texture is empty. Larger than the driver's limit: smaller,
/// with a warning. GL thread only.
gl::Texture2D upload_texture(const Texture& texture);

/// Which samplers read which texture. GL thread only.
class TextureSamplers {
 public:
  TextureSamplers();

  /// As the texture's extension and interpolation ask.
  GLuint for_material(const Texture& texture) const;
  /// Around the horizon without a seam, clamped at the poles.
  GLuint for_equirectangular(const Texture& texture) const;
  /// Each face by itself, clamped.
  GLuint for_cube_face(const Texture& texture) const;

 private:
  std::array<std::array<gl::Sampler, 2>, 3> by_extension_;  // [Extension][nearest]
  std::array<gl::Sampler, 2> equirectangular_;              // [nearest]
};

}  // namespace kestrel
