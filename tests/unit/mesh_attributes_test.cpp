// SPDX-License-Identifier: GPL-3.0-or-later
// Further UV maps and colours of a mesh, and the materials that ask for them.
#include "scene_builder_fixture.h"
#include "shading/surface.h"

namespace kestrel {
namespace {

constexpr uint64_t kOwn = 11, kTurned = 12, kMissing = 13, kColor = 14;

/// A square whose second map is turned by 90 degrees, and whose colours are its coordinates.
struct RichSquare : Square {
  std::vector<float> turned = {0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1};
  std::vector<float> colors = {0, 0, 2, 1, 0, 2, 1, 1, 2, 0, 0, 2, 1, 1, 2, 0, 1, 2};

  MeshInput input() const {
    MeshInput out = Square::input();
    out.uv_map = kOwn;
    out.attributes = {{kTurned, 2, turned}, {kColor, 3, colors}};
    return out;
  }
};

/// A material of one texture for everything.
MaterialInput textured_material(uint64_t diffuse_map, uint64_t emission_map) {
  MaterialInput material;
  material.values.name = "material";
  material.diffuse_texture = material.emission_texture = 1;
  material.values.uv_maps[kDiffuseTexture] = diffuse_map;
  material.values.uv_maps[kEmissionTexture] = emission_map;
  return material;
}

std::shared_ptr<const Scene> commit(Builder& builder, const MaterialInput& material,
                                    const RichSquare& square = {}) {
  const std::vector<float> texels = {0, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 1, 1, 1, 0, 1};
  builder.set_texture_pixels_float(1, 2, 2, texels, {.nearest = true});
  builder.set_material(1, material);
  builder.set_mesh(1, square.input());
  builder.set_object(1, object_of(1, "o", {1}));
  return builder.commit();
}

/// The surface a quarter of the way along X and Y, plus `x` and `y` halves.
Surface surface_at(const Scene& scene, float x, float y) {
  const mat3 normal_from_object(1.0f);
  const vec2 p(0.25f + 0.5f * x, 0.25f + 0.5f * y);
  // The triangles are (0, 0), (1, 0), (1, 1) and (0, 0), (1, 1), (0, 1).
  const SurfaceHit hit =
      p.x >= p.y ? SurfaceHit{0, 0, {p.x - p.y, p.y}} : SurfaceHit{0, 1, {p.x, p.y - p.x}};
  Surface surface;
  const Look look;
  evaluate_surfaces(scene, {&normal_from_object, 1}, {&hit, 1}, {&look, 1}, &surface);
  return surface;
}

TEST(MeshAttributes, EachTextureIsLookedUpAlongItsMap) {
  Builder builder;
  MaterialInput material = textured_material(0, kTurned);
  material.values.diffuse = vec4(1.0f);
  material.values.emission = vec3(1.0f);
  const auto scene = commit(builder, material);
  EXPECT_TRUE(scene->materials[1].several_uv_maps);
  for (const float x : {0.0f, 1.0f}) {
    for (const float y : {0.0f, 1.0f}) {
      const Surface s = surface_at(*scene, x, y);
      EXPECT_EQ(vec3(s.diffuse), vec3(x, y, 0.0f));
      EXPECT_EQ(s.emission, vec3(y, 1.0f - x, 0.0f)) << "u = y, v = 1 - x";
    }
  }
}

TEST(MeshAttributes, TheMeshsOwnMapGoesByItsNameToo) {
  Builder builder;
  MaterialInput material = textured_material(kOwn, kOwn);
  material.values.diffuse = vec4(1.0f);
  const auto scene = commit(builder, material);
  EXPECT_FALSE(scene->materials[1].several_uv_maps);
  EXPECT_EQ(vec3(surface_at(*scene, 1, 0).diffuse), vec3(1, 0, 0));
}

TEST(MeshAttributes, AMapThatTheMeshLacksReadsAsTheCorner) {
  Builder builder;
  MaterialInput material = textured_material(kMissing, kMissing);
  material.values.diffuse = vec4(1.0f);
  const auto scene = commit(builder, material);
  EXPECT_EQ(vec3(surface_at(*scene, 1, 1).diffuse), vec3(0.0f)) << "texel (0, 0)";
}

TEST(MeshAttributes, ColoursMultiply) {
  Builder builder;
  MaterialInput material;
  material.values.name = "material";
  material.values.diffuse = vec4(1.0f, 0.5f, 1.0f, 0.5f);
  material.values.ambient = material.values.emission = vec3(1.0f);
  material.values.diffuse_colors = kColor;
  material.values.emission_colors = kMissing;
  const Surface s = surface_at(*commit(builder, material), 1, 0);
  EXPECT_EQ(vec3(s.diffuse), vec3(0.75f, 0.125f, 2.0f));
  EXPECT_EQ(s.ambient, vec3(1.0f)) << "no colours are asked for";
  EXPECT_EQ(s.emission, vec3(0.0f)) << "black where the mesh has none";
}

TEST(MeshAttributes, TangentsAreMadeAlongTheMapThatANormalMapLiesOn) {
  Builder builder;
  MaterialInput material = textured_material(0, 0);
  material.normal_texture = 1;
  material.values.tangent_map = kTurned;
  const Mesh& mesh = *commit(builder, material)->meshes[0];
  EXPECT_TRUE(mesh.corner_tangents.empty());
  ASSERT_EQ(mesh.tangents_of(kTurned).size(), 6u);
  for (const vec4& t : mesh.tangents_of(kTurned)) {
    EXPECT_NEAR(glm::distance(t, vec4(0, 1, 0, 1)), 0.0f, 1e-6f) << "u grows with y";
  }
  EXPECT_GT(mesh.positions.capacity(), mesh.positions.size());
  EXPECT_TRUE(mesh.tangents_of(kMissing).empty());
}

TEST(MeshAttributes, LeftOutTrianglesTakeTheirValuesAlong) {
  Builder builder;
  RichSquare square;
  square.triangles[1] = square.triangles[0];  // the first triangle has no area
  square.colors[9] = kNan;
  const Mesh& mesh = *commit(builder, textured_material(0, 0), square)->meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.uvs_of(kTurned)[1], vec2(1.0f, 0.0f));
  EXPECT_EQ(mesh.colors_of(kColor)->corner_colors[0], vec3(0.0f)) << "not finite";
  EXPECT_EQ(mesh.colors_of(kColor)->corner_colors[1], vec3(1.0f, 1.0f, 2.0f));
}

}  // namespace
}  // namespace kestrel
