// SPDX-License-Identifier: GPL-3.0-or-later
// Materials in the G-buffer: colour times texture, mapping, normal maps, alpha.
#include <cmath>

#include "raster_fixture.h"

namespace kestrel {
namespace {

using test::at;
using test::rectangle;
using test::SceneMaker;

constexpr float kHalfUlp = 1.0f / 1024.0f;  // a 16-bit float target may round down

/// 2 x 2 texels, each a colour of its own: rows from the bottom are red green, blue white.
Texture four_colors() {
  Texture t{"four colours", 2, 2};
  t.nearest = true;
  t.texels8 = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
  return t;
}

Texture one_texel(const vec4& value) {
  Texture t{"one texel", 1, 1};
  t.texels_float = {value.x, value.y, value.z, value.w};
  return t;
}

class RasterMaterial : public test::RasterTest {
 protected:
  /// A wall over the whole picture with one material; edges of the UVs at the picture's edges.
  GBuffer render_wall(SceneMaker& maker, const Material& material, int size) {
    maker.object("wall", rectangle(-1, -1, 1, 1), maker.material(material));
    return render(maker, size, size);
  }
  GBuffer render_wall(const Material& material, int size = 1) {
    SceneMaker maker;
    return render_wall(maker, material, size);
  }
};

TEST_F(RasterMaterial, PlainColorsArriveAsTheyAre) {
  Material m;
  m.emission = vec3(100.0f, 0.5f, 0.0f);  // brighter than any 8-bit target holds
  m.ambient = vec3(0.1f, 0.2f, 3.0f);
  m.diffuse = vec4(0.8f, 0.4f, 0.2f, 0.3f);
  m.specular = vec4(0.9f, 0.7f, 0.5f, 0.25f);
  m.optical = vec3(0.125f, 1.45f, 0.75f);
  const GBuffer g = render_wall(m);
  EXPECT_VEC_NEAR(g.emission[0], m.emission, 100 * kHalfUlp);
  EXPECT_VEC_NEAR(g.ambient[0], m.ambient, 3 * kHalfUlp);
  EXPECT_VEC_NEAR(vec3(g.diffuse[0]), vec3(m.diffuse), kHalfUlp);
  EXPECT_EQ(g.diffuse[0].w, 1.0f) << "an opaque material ignores its alpha";
  EXPECT_VEC_NEAR(g.specular[0], m.specular, kHalfUlp);
  EXPECT_VEC_NEAR(g.optical[0], m.optical, 1.5f * kHalfUlp);
}

TEST_F(RasterMaterial, EveryPropertyIsItsColorTimesItsTexture) {
  SceneMaker maker;
  Material m;
  m.emission = m.ambient = vec3(0.5f, 1.0f, 2.0f);
  m.diffuse = m.specular = vec4(0.5f, 1.0f, 0.25f, 0.5f);
  m.optical = vec3(1.0f, 2.0f, 0.5f);
  m.emission_texture = maker.texture(one_texel({8, 4, 2, 1}));
  m.ambient_texture = maker.texture(one_texel({0.5f, 0.25f, 0.125f, 1}));
  m.diffuse_texture = maker.texture(one_texel({0.5f, 0.5f, 1, 1}));
  m.specular_texture = maker.texture(one_texel({1, 0.5f, 1, 0.5f}));
  m.optical_texture = maker.texture(one_texel({0.25f, 0.75f, 0.5f, 1}));
  const GBuffer g = render_wall(maker, m, 1);
  EXPECT_EQ(g.emission[0], vec3(4, 4, 4));
  EXPECT_EQ(g.ambient[0], vec3(0.25f, 0.25f, 0.25f));
  EXPECT_EQ(g.diffuse[0], vec4(0.25f, 0.5f, 0.25f, 1));
  EXPECT_EQ(g.specular[0], vec4(0.5f, 0.5f, 0.25f, 0.25f));
  EXPECT_EQ(g.optical[0], vec3(0.25f, 1.5f, 0.25f));
}

TEST_F(RasterMaterial, SrgbTexelsAreDecodedButTheirAlphaIsNot) {
  SceneMaker maker;
  Texture t{"grey", 1, 1, true};
  t.texels8 = {188, 10, 255, 128};
  Material m;
  m.diffuse = vec4(1.0f);
  m.alpha_mode = AlphaMode::blend;
  m.diffuse_texture = maker.texture(t);
  const GBuffer g = render_wall(maker, m, 1);
  // Drivers may approximate the curve, but stay well within one 8-bit code of it.
  const auto code = [](double c) {
    return 255.0 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055);
  };
  EXPECT_NEAR(code(g.diffuse[0].x), 188.0, 0.4);
  EXPECT_NEAR(code(g.diffuse[0].y), 10.0, 0.4);
  EXPECT_EQ(g.diffuse[0].z, 1.0f);
  EXPECT_NEAR(g.diffuse[0].w, 128.0 / 255.0, kHalfUlp);
}

TEST_F(RasterMaterial, TexturesStandUprightAndUnmirrored) {
  SceneMaker maker;
  Material m;
  m.diffuse = vec4(1.0f);
  m.diffuse_texture = maker.texture(four_colors());
  const GBuffer g = render_wall(maker, m, 2);
  EXPECT_EQ(vec3(g.diffuse[at(g, 0, 0)]), vec3(1, 0, 0));
  EXPECT_EQ(vec3(g.diffuse[at(g, 1, 0)]), vec3(0, 1, 0));
  EXPECT_EQ(vec3(g.diffuse[at(g, 0, 1)]), vec3(0, 0, 1));
  EXPECT_EQ(vec3(g.diffuse[at(g, 1, 1)]), vec3(1, 1, 1));
}

TEST_F(RasterMaterial, TilingRepeatsAndOffsetShifts) {
  SceneMaker maker;
  Material m;
  m.diffuse = vec4(1.0f);
  m.diffuse_texture = maker.texture(four_colors());
  m.tiling = vec2(2.0f, 1.0f);
  m.offset = vec2(0.5f, 0.0f);
  const GBuffer g = render_wall(maker, m, 4);
  // u' = 0.5 + 2 u at the centres 1/8, 3/8 …: 0.75, 1.25, 1.75, 2.25; the lower row repeats.
  const vec3 expected[] = {vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 1, 0), vec3(1, 0, 0)};
  for (int x = 0; x < 4; ++x) EXPECT_EQ(vec3(g.diffuse[at(g, x, 0)]), expected[x]) << x;
}

TEST_F(RasterMaterial, ExtensionDecidesWhatLiesOutside) {
  const vec4 red(1, 0, 0, 1), green(0, 1, 0, 1), nothing(0.0f);
  // u' = -1 + 3 u at the centres of six pixels: from -0.75 to 1.75 in steps of a half.
  const vec4 repeat[] = {red, green, red, green, red, green};
  const vec4 clamp[] = {red, red, red, green, green, green};
  const vec4 clip[] = {nothing, nothing, red, green, nothing, nothing};
  const std::pair<Extension, const vec4*> cases[] = {
      {Extension::repeat, repeat}, {Extension::clamp, clamp}, {Extension::clip, clip}};
  for (const auto& [extension, expected] : cases) {
    SceneMaker maker;
    Texture t = four_colors();
    t.extension = extension;
    Material m;
    m.diffuse = vec4(1.0f);
    m.alpha_mode = AlphaMode::blend;
    m.diffuse_texture = maker.texture(t);
    m.tiling = vec2(3.0f, 0.5f);
    m.offset = vec2(-1.0f, 0.0f);
    const GBuffer g = render_wall(maker, m, 6);
    for (int x = 0; x < 6; ++x) {
      EXPECT_EQ(g.diffuse[at(g, x, 0)], expected[x])
          << "extension " << static_cast<int>(extension) << ", pixel " << x;
    }
  }
}

TEST_F(RasterMaterial, TexelsAreInterpolatedUnlessNearest) {
  for (const bool nearest : {false, true}) {
    SceneMaker maker;
    Texture t{"ramp", 2, 1};
    t.nearest = nearest;
    t.extension = Extension::clamp;
    t.texels_float = {0, 0, 0, 1, 1, 1, 1, 1};
    Material m;
    m.diffuse = vec4(1.0f);
    m.diffuse_texture = maker.texture(t);
    const GBuffer g = render_wall(maker, m, 8);
    // Texel centres at 1/4 and 3/4; pixel centres at 1/16, 3/16 …
    const float linear[] = {0, 0, 0.125f, 0.375f, 0.625f, 0.875f, 1, 1};
    for (int x = 0; x < 8; ++x) {
      const float expected = nearest ? (x < 4 ? 0.0f : 1.0f) : linear[x];
      EXPECT_NEAR(g.diffuse[at(g, x, 3)].x, expected, 1e-3) << x;
    }
  }
}

TEST_F(RasterMaterial, DistantTexturesAreReadAtFullResolution) {
  // Minified 16-fold: one texel each pixel, no average, as rays do.
  SceneMaker maker;
  Texture t{"stripes", 64, 64};
  t.nearest = true;
  for (int i = 0; i < 64 * 64; ++i) {
    const uint8_t v = i % 2 ? 255 : 0;
    t.texels8.insert(t.texels8.end(), {v, v, v, 255});
  }
  Material m;
  m.diffuse = vec4(1.0f);
  m.diffuse_texture = maker.texture(t);
  m.offset = vec2(0.25f / 64.0f);  // centres of pixels lie on the edges of texels
  const GBuffer g = render_wall(maker, m, 4);
  for (const vec4& d : g.diffuse) EXPECT_EQ(d.x, 0.0f);
}

TEST_F(RasterMaterial, EmptyTextureIsWhite) {
  SceneMaker maker;
  Material m;
  m.diffuse = vec4(0.25f, 0.5f, 0.75f, 1.0f);
  m.diffuse_texture = maker.texture(Texture{"empty"});
  EXPECT_EQ(render_wall(maker, m, 1).diffuse[0], m.diffuse);
}

TEST_F(RasterMaterial, MeshWithoutUvsReadsTheOrigin) {
  SceneMaker maker;
  Material m;
  m.diffuse = vec4(1.0f);
  m.diffuse_texture = maker.texture(four_colors());
  m.offset = vec2(0.75f, 0.25f);
  auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
  mesh->corner_uvs.clear();
  maker.object("wall", mesh, maker.material(m));
  EXPECT_EQ(vec3(render(maker, 1, 1).diffuse[0]), vec3(0, 1, 0));
}

// ---- normal maps -----------------------------------------------------------------------------

class RasterNormalMap : public test::RasterTest {
 protected:
  /// The normal of a wall in the plane z = 0 whose texel is `texel`, tangent +X.
  vec3 mapped(const vec3& texel, float strength = 1.0f, float bitangent_sign = 1.0f,
              const mat4x3& world_from_object = mat4x3(1.0f), bool tangents = true) {
    SceneMaker maker;
    Material m;
    m.normal_texture = maker.texture(one_texel(vec4(0.5f * texel + 0.5f, 1.0f)));
    m.normal_strength = strength;
    auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
    if (tangents) mesh->corner_tangents.assign(6, vec4(1, 0, 0, bitangent_sign));
    maker.object("wall", mesh, maker.material(m), world_from_object);
    const GBuffer g = render(maker, 1, 1);
    const vec3 geometric = g.normal_geometric[0];
    EXPECT_NEAR(std::abs(geometric.z), 1.0f, 1e-6) << "the map leaves the triangle's normal alone";
    return g.normal[0];
  }
};

TEST_F(RasterNormalMap, TiltsTowardsTangentAndBitangent) {
  EXPECT_VEC_NEAR(mapped({0.6f, 0, 0.8f}), vec3(0.6f, 0, 0.8f), 1e-6);
  EXPECT_VEC_NEAR(mapped({0, 0.6f, 0.8f}), vec3(0, 0.6f, 0.8f), 1e-6);
  EXPECT_VEC_NEAR(mapped({0, 0.6f, 0.8f}, 1.0f, -1.0f), vec3(0, -0.6f, 0.8f), 1e-6);
}

TEST_F(RasterNormalMap, StrengthFadesItOut) {
  EXPECT_VEC_NEAR(mapped({0.6f, 0, 0.8f}, 0.0f), vec3(0, 0, 1), 1e-6);
  EXPECT_VEC_NEAR(mapped({0.6f, 0, 0.8f}, 0.5f), glm::normalize(vec3(0.3f, 0, 0.9f)), 1e-6);
}

TEST_F(RasterNormalMap, MirroredObjectsAreMirrorImages) {
  mat4x3 mirrored(1.0f);
  mirrored[0] = vec3(-1, 0, 0);
  EXPECT_VEC_NEAR(mapped({0.6f, 0, 0.8f}, 1, 1, mirrored), vec3(-0.6f, 0, 0.8f), 1e-6);
  EXPECT_VEC_NEAR(mapped({0, 0.6f, 0.8f}, 1, 1, mirrored), vec3(0, 0.6f, 0.8f), 1e-6);
}

TEST_F(RasterNormalMap, MeshWithoutTangentsIsLeftAlone) {
  EXPECT_VEC_NEAR(mapped({0.6f, 0, 0.8f}, 1, 1, mat4x3(1.0f), false), vec3(0, 0, 1), 1e-6);
}

TEST_F(RasterNormalMap, FlatTexelLeavesASmoothNormalAlone) {
  SceneMaker maker;
  Material m;
  m.normal_texture = maker.texture(one_texel({0.5f, 0.5f, 1.0f, 1.0f}));
  auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
  const vec3 smooth = glm::normalize(vec3(0.3f, -0.2f, 1.0f));
  mesh->corner_normals.assign(6, smooth);
  mesh->corner_tangents.assign(6, vec4(1, 0, 0, 1));  // not perpendicular to the normal
  maker.object("wall", mesh, maker.material(m));
  EXPECT_VEC_NEAR(render(maker, 1, 1).normal[0], smooth, 1e-6);
}

// ---- alpha -----------------------------------------------------------------------------------

TEST_F(RasterMaterial, MaskCutsHolesThroughWhichTheBackgroundShows) {
  SceneMaker maker;
  Texture t{"stencil", 2, 1};
  t.nearest = true;
  t.texels8 = {255, 255, 255, 127, 255, 255, 255, 129};
  Material m;
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 0.5f;
  m.diffuse = vec4(1.0f);
  m.diffuse_texture = maker.texture(t);
  maker.object("behind", rectangle(-1, -1, 1, 1, -1.0f), 0);
  const GBuffer g = render_wall(maker, m, 2);
  EXPECT_EQ(g.object[0], 1u);
  EXPECT_NEAR(g.position[0].z, -1.0f, 1e-5);
  EXPECT_EQ(g.object[1], 2u);
  EXPECT_EQ(g.diffuse[1].w, 1.0f) << "what a mask leaves is whole";
  EXPECT_EQ(g.optical[1].z, 1.0f);
}

TEST_F(RasterMaterial, MaskMultipliesColorAndTextureAlpha) {
  SceneMaker maker;
  Material m;
  m.alpha_mode = AlphaMode::mask;
  m.alpha_cutoff = 0.5f;
  m.diffuse = vec4(1, 1, 1, 0.7f);
  m.diffuse_texture = maker.texture(one_texel({1, 1, 1, 0.7f}));
  EXPECT_EQ(render_wall(maker, m, 1).object[0], 0u);
}

TEST_F(RasterMaterial, BlendedAlphaIsOpacityThatDoesNotBend) {
  SceneMaker maker;
  maker.scene->settings.environment_ior = 1.25f;
  Material m;
  m.alpha_mode = AlphaMode::blend;
  m.diffuse = vec4(1, 1, 1, 0.5f);
  m.optical = vec3(0.0f, 1.5f, 1.0f);
  const GBuffer g = render_wall(maker, m, 1);
  EXPECT_EQ(g.diffuse[0].w, 0.5f);
  EXPECT_EQ(g.optical[0], vec3(0.0f, 1.25f, 0.5f));
}

TEST_F(RasterMaterial, BlendedGlassKeepsItsIndexOfRefraction) {
  SceneMaker maker;
  maker.scene->settings.environment_ior = 1.25f;
  Material m;
  m.alpha_mode = AlphaMode::blend;
  m.diffuse = vec4(1, 1, 1, 0.5f);
  m.optical = vec3(0.25f, 1.5f, 0.5f);
  EXPECT_EQ(render_wall(maker, m, 1).optical[0], vec3(0.25f, 1.5f, 0.25f));
}

}  // namespace
}  // namespace kestrel
