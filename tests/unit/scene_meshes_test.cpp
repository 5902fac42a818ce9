// SPDX-License-Identifier: GPL-3.0-or-later
// What becomes of a host's meshes: unusable triangles, normals, tangents.
#include <cmath>

#include "log_capture.h"
#include "scene/tangents.h"
#include "scene_builder_fixture.h"

namespace kestrel {
namespace {

using test::LogCapture;

TEST(MeshRules, AnIndexOutOfRangeNamesMeshTriangleIndexAndCount) {
  Builder builder;
  Square square;
  square.triangles[4] = 1234;
  const std::string text =
      failure(ErrorCode::invalid_argument, [&] { builder.set_mesh(1, square.input("broken")); });
  expect_words(text, {"broken", "triangle 1", "1234", "4 vertices"});
  builder.set_object(1, object_of(1, "o"));
  EXPECT_EQ(builder.commit()->meshes[0]->name, "square") << "the mesh set before stays";
}

TEST(MeshRules, ASlotOutOfRangeIsAnError) {
  SceneBuilder builder;
  Square square;
  square.slots = {0, 4000000000u};
  expect_words(
      failure(ErrorCode::invalid_argument, [&] { builder.set_mesh(1, square.input("slots")); }),
      {"slots", "triangle 1", "4000000000", "65535"});
}

TEST(MeshRules, UnusableTrianglesAreLeftOutWithOneWarningThatCountsThem) {
  Builder builder;
  Square square;
  square.positions.insert(square.positions.end(), {kNan, 0, 0, 0, kInf, 0, 2, 0, 0, 3, 0, 1e30f});
  // Not finite: 0-1-4, 0-1-5, 0-1-7 (beyond what can be traced). No area: in line, one point twice.
  square.triangles = {0, 1, 4, 0, 1, 5, 0, 1, 7, 0, 1, 2, 0, 1, 6, 1, 1, 2};
  square.uvs.clear();
  square.slots = {0, 1, 2, 3, 4, 5};
  const LogCapture log;
  builder.set_mesh(1, square.input("torn"));
  EXPECT_EQ(log.messages().size(), 1u);
  EXPECT_EQ(log.count("torn"), 1);
  EXPECT_EQ(log.count("(6 triangles)"), 1);
  EXPECT_EQ(log.count("3 triangles left out whose vertices are not finite"), 1);
  EXPECT_EQ(log.count("2 triangles left out that have no area"), 1);
  builder.set_object(1, object_of(1, "o"));
  const Mesh& mesh = *builder.commit()->meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], uvec3(0, 1, 2));
  EXPECT_EQ(mesh.triangle_materials, std::vector<uint32_t>{3});
  EXPECT_EQ(mesh.bounds.lower, vec3(0.0f)) << "only what is rendered counts";
  EXPECT_EQ(mesh.bounds.upper, vec3(1.0f, 1.0f, 0.0f));
}

TEST(MeshRules, ThinAndTinyTrianglesStay) {
  Builder builder;
  Square square;
  square.positions = {0, 0, 0, 1, 0, 0, 1, 1e-6f, 0, 0, 1e-6f, 0};
  const LogCapture log;
  builder.set_mesh(1, square.input("thin"));
  square.positions = {0, 0, 0, 1e-6f, 0, 0, 1e-6f, 1e-6f, 0, 0, 1e-6f, 0};
  builder.set_mesh(2, square.input("tiny"));
  EXPECT_TRUE(log.messages().empty());
  builder.set_object(1, object_of(1, "thin"));
  builder.set_object(2, object_of(2, "tiny"));
  const auto scene = builder.commit();
  EXPECT_EQ(scene->meshes[0]->triangles.size(), 2u);
  EXPECT_EQ(scene->meshes[1]->triangles.size(), 2u);
}

TEST(MeshRules, NormalsBecomeUnitAndBrokenOnesTheFaces) {
  Builder builder;
  Square square;
  square.normals = {0, 0, 5, kNan, 0, 0, 0, 0, 0, 3, 0, 4, kInf, 0, 0, 0, -2, 0};
  const LogCapture log;
  builder.set_mesh(1, square.input("bent"));
  EXPECT_EQ(log.count("3 normals"), 1);
  builder.set_object(1, object_of(1, "o"));
  const std::vector<vec3>& n = builder.commit()->meshes[0]->corner_normals;
  const vec3 face(0, 0, 1);
  ASSERT_EQ(n.size(), 6u);
  EXPECT_EQ(n[0], face);
  EXPECT_EQ(n[1], face);
  EXPECT_EQ(n[2], face);
  EXPECT_NEAR(glm::length(n[3] - vec3(0.6f, 0.0f, 0.8f)), 0.0f, 1e-6f);
  EXPECT_EQ(n[4], face);
  EXPECT_EQ(n[5], vec3(0, -1, 0));
}

TEST(MeshRules, BrokenUvsBecomeZero) {
  Builder builder;
  Square square;
  square.uvs[2] = kNan;
  const LogCapture log;
  builder.set_mesh(1, square.input("unwrapped"));
  EXPECT_EQ(log.count("1 UVs"), 1);
  builder.set_object(1, object_of(1, "o"));
  EXPECT_EQ(builder.commit()->meshes[0]->corner_uvs[1], vec2(0.0f));
}

TEST(MeshRules, AMeshWithoutAttributesHasNone) {
  Builder builder;
  Square square;
  square.uvs.clear();
  builder.set_mesh(1, square.input());
  builder.set_object(1, object_of(1, "o"));
  const Mesh& mesh = *builder.commit()->meshes[0];
  EXPECT_TRUE(mesh.corner_uvs.empty());
  EXPECT_TRUE(mesh.corner_normals.empty());
  EXPECT_TRUE(mesh.corner_tangents.empty());
  EXPECT_TRUE(mesh.triangle_materials.empty());
  EXPECT_GT(mesh.positions.capacity(), mesh.positions.size()) << "Embree reads past the last one";
}

// ---- Tangents -----------------------------------------------------------------------------------

/// Commits the square under a material with a normal map.
std::shared_ptr<const Mesh> with_normal_map(Builder& builder, const Square& square) {
  const uint8_t texel[4] = {128, 128, 255, 255};
  builder.set_texture_pixels8(1, 1, 1, texel, {});
  MaterialInput bumpy = material_called("bumpy");
  bumpy.normal_texture = 1;
  builder.set_material(1, bumpy);
  builder.set_mesh(1, square.input());
  builder.set_object(1, object_of(1, "o", {1}));
  return builder.commit()->meshes.at(0);
}

TEST(Tangents, PointTheWayUGrows) {
  Builder builder;
  const auto mesh = with_normal_map(builder, {});
  ASSERT_EQ(mesh->corner_tangents.size(), 6u);
  for (const vec4& t : mesh->corner_tangents) EXPECT_EQ(t, vec4(1, 0, 0, 1));
  EXPECT_GT(mesh->positions.capacity(), mesh->positions.size());
}

TEST(Tangents, OfMirroredUvsHaveTheOtherSign) {
  Builder builder;
  Square square;
  for (size_t i = 0; i < square.uvs.size(); i += 2) square.uvs[i] = 1.0f - square.uvs[i];
  for (const vec4& t : with_normal_map(builder, square)->corner_tangents) {
    EXPECT_EQ(t, vec4(-1, 0, 0, -1));
    const vec3 bitangent = t.w * glm::cross(vec3(0, 0, 1), vec3(t));
    EXPECT_EQ(bitangent, vec3(0, 1, 0)) << "the way v grows";
  }
}

TEST(Tangents, LieAcrossTheNormalAndAreShared) {
  Builder builder;
  Square square;
  // A fold along the diagonal 0-2, smooth there.
  square.positions[11] = 1.0f;
  const float s = std::sqrt(1.0f / 3.0f);
  square.normals = {s, -s, s, 0, 0, 1, s, -s, s, s, -s, s, s, -s, s, 1, -1, 1};
  const auto mesh = with_normal_map(builder, square);
  for (size_t c = 0; c < 6; ++c) {
    const vec3 t(mesh->corner_tangents[c]);
    EXPECT_NEAR(glm::length(t), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(t, mesh->corner_normals[c]), 0.0f, 1e-6f);
  }
  EXPECT_EQ(mesh->corner_tangents[0], mesh->corner_tangents[3]);
  EXPECT_EQ(mesh->corner_tangents[2], mesh->corner_tangents[4]);
}

TEST(Tangents, OfDegenerateUvsAreStillAcrossTheNormal) {
  Builder builder;
  Square square;
  std::fill(square.uvs.begin(), square.uvs.end(), 0.5f);
  const auto flat = with_normal_map(builder, square);
  square.uvs.clear();
  const auto none = with_normal_map(builder, square);
  for (const auto& mesh : {flat, none}) {
    ASSERT_EQ(mesh->corner_tangents.size(), 6u);
    for (const vec4& t : mesh->corner_tangents) {
      EXPECT_NEAR(glm::length(vec3(t)), 1.0f, 1e-6f);
      EXPECT_EQ(t.z, 0.0f);
      EXPECT_EQ(t.w, 1.0f);
    }
  }
}

TEST(Tangents, AreSharedByHoweverManyTriangles) {
  // A flat fan of 20000 triangles around the origin, unwrapped as seen from above.
  constexpr uint32_t kCount = 20000;
  Square fan;
  fan.positions = {0, 0, 0};
  fan.triangles.clear();
  fan.uvs.clear();
  for (uint32_t i = 0; i < kCount; ++i) {
    const float angle = 2.0f * kPi * static_cast<float>(i) / kCount;
    fan.positions.insert(fan.positions.end(), {std::cos(angle), std::sin(angle), 0.0f});
    for (const uint32_t v : {0u, i + 1, (i + 1) % kCount + 1}) fan.triangles.push_back(v);
  }
  for (const uint32_t v : fan.triangles) {
    fan.uvs.push_back(fan.positions[3 * v]);
    fan.uvs.push_back(fan.positions[3 * v + 1]);
  }
  Builder builder;
  const auto mesh = with_normal_map(builder, fan);
  ASSERT_EQ(mesh->triangles.size(), kCount);
  for (uint32_t t = 0; t < kCount; ++t) {
    EXPECT_EQ(mesh->corner_tangents[3 * t], mesh->corner_tangents[0]);
  }
  EXPECT_NEAR(mesh->corner_tangents[0].x, 1.0f, 1e-5f);
}

TEST(Tangents, AreMadeOnceAndOnlyWhereNeeded) {
  Builder builder;
  builder.set_object(7, object_of(1, "plain"));
  EXPECT_TRUE(builder.commit()->meshes[0]->corner_tangents.empty());
  const auto made = with_normal_map(builder, {});
  EXPECT_FALSE(made->corner_tangents.empty());
  builder.set_object_transform(1, mat4x3(3.0f));
  EXPECT_EQ(builder.commit()->meshes[0], made);
}

TEST(Tangents, GivenOnesStay) {
  Builder builder;
  Square square;
  square.tangents = {0, 2, 0, -1, 0, 2, 0, -1, 0, 2,    0, 1,  //
                     0, 2, 0, -1, 0, 0, 0, -1, 0, kNan, 0, 1};
  const LogCapture log;
  const auto mesh = with_normal_map(builder, square);
  EXPECT_EQ(log.count("2 tangents"), 1);
  EXPECT_EQ(mesh->corner_tangents[0], vec4(0, 1, 0, -1));
  EXPECT_EQ(mesh->corner_tangents[2], vec4(0, 1, 0, 1));
  for (const vec4& t : mesh->corner_tangents) EXPECT_NEAR(glm::length(vec3(t)), 1.0f, 1e-6f);
}

TEST(Tangents, AnyPerpendicularIsOne) {
  for (const vec3 n : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1), vec3(0.6f, 0.0f, 0.8f)}) {
    EXPECT_NEAR(glm::length(any_perpendicular(n)), 1.0f, 1e-6f);
    EXPECT_NEAR(glm::dot(any_perpendicular(n), n), 0.0f, 1e-6f);
  }
}

}  // namespace
}  // namespace kestrel
