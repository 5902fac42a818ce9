// SPDX-License-Identifier: GPL-3.0-or-later
// The G-buffer's geometry: what is where, in which pixel, at which depth.
#include <cmath>
#include <random>

#include "raster_fixture.h"

namespace kestrel {
namespace {

using test::at;
using test::perspective_scene;
using test::rectangle;
using test::SceneMaker;

using RasterGeometry = test::RasterTest;

TEST_F(RasterGeometry, RectangleIsWhereThePinholeCameraSeesIt) {
  SceneMaker maker = perspective_scene();
  const int red = maker.material({.name = "red"});
  maker.object("wall", rectangle(0, -2, 4, 3), red);
  const GBuffer g = render(maker, 20, 20);  // pixels of 1 m on the plane z = 0
  int covered = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const vec3 center(static_cast<float>(x) - 9.5f, static_cast<float>(y) - 9.5f, 0.0f);
      const bool inside = center.x > 0 && center.x < 4 && center.y > -2 && center.y < 3;
      const size_t i = at(g, x, y);
      ASSERT_EQ(g.object[i], inside ? 1u : 0u) << x << ", " << y;
      if (!inside) continue;
      ++covered;
      EXPECT_VEC_NEAR(g.position[i], center, 2e-5);
      EXPECT_VEC_NEAR(g.normal[i], vec3(0, 0, 1), 1e-6);
      EXPECT_VEC_NEAR(g.normal_geometric[i], vec3(0, 0, 1), 1e-6);
      EXPECT_EQ(g.material[i], static_cast<uint32_t>(red));
      const double n = 0.1f, f = 100.0;
      EXPECT_NEAR(g.depth[i], n * (f - 10.0) / (10.0 * (f - n)), 1e-7);
    }
  }
  EXPECT_EQ(covered, 4 * 5);
}

TEST_F(RasterGeometry, WhereNothingIsEveryPlaneIsZeroButTheWorld) {
  SceneMaker maker = perspective_scene();
  maker.scene->world.color = vec3(0.25f, 0.5f, 2.0f);
  const GBuffer g = render(maker, 3, 2);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(g.object[i], 0u);
    EXPECT_EQ(g.material[i], 0u);
    EXPECT_EQ(g.depth[i], 0.0f);
    for (const auto* plane :
         {&g.position, &g.normal, &g.normal_geometric, &g.emission, &g.ambient, &g.optical}) {
      EXPECT_EQ((*plane)[i], vec3(0.0f));
    }
    EXPECT_EQ(g.diffuse[i], vec4(0.0f));
    EXPECT_EQ(g.specular[i], vec4(0.0f));
    EXPECT_EQ(g.lighting[i], vec3(0.25f, 0.5f, 2.0f));
  }
}

TEST_F(RasterGeometry, NearerSurfaceHidesFartherInAnyOrder) {
  for (const bool nearer_first : {true, false}) {
    SceneMaker maker = perspective_scene();
    maker.object("first", rectangle(-20, -20, 20, 20, nearer_first ? 1.0f : 0.0f), 0);
    maker.object("second", rectangle(-20, -20, 20, 20, nearer_first ? 0.0f : 1.0f), 0);
    const GBuffer g = render(maker, 4, 4);
    for (const uint32_t object : g.object) EXPECT_EQ(object, nearer_first ? 1u : 2u);
  }
}

TEST_F(RasterGeometry, DistantSurfacesACentimetreApartDoNotFlicker) {
  // A usual z-buffer of 24 bits resolves about 0.6 m at 1 km with the near plane at 0.1 m.
  SceneMaker maker = perspective_scene();
  maker.scene->camera.far_clip = 2000.0f;
  maker.object("far", rectangle(-2000, -2000, 2000, 2000, -990.000f), 0);
  maker.object("near", rectangle(-2000, -2000, 2000, 2000, -989.990f), 0);
  const GBuffer g = render(maker, 16, 16);
  for (const uint32_t object : g.object) EXPECT_EQ(object, 2u);
}

TEST_F(RasterGeometry, DepthRunsFromOneAtTheNearPlaneToZeroAtTheFar) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    SceneMaker maker;
    maker.scene->camera.projection = projection;
    maker.scene->camera.near_clip = 2.0f;
    maker.scene->camera.far_clip = 50.0f;
    const auto depth_at = [&](float distance) {
      maker.scene = std::make_shared<Scene>(*maker.scene);
      maker.scene->objects.clear();
      maker.object("wall", rectangle(-99, -99, 99, 99, 10.0f - distance), 0);
      const GBuffer g = render(maker, 2, 2);
      return g.object[0] ? g.depth[0] : -1.0f;
    };
    EXPECT_NEAR(depth_at(2.0001f), 1.0, 1e-4);
    EXPECT_NEAR(depth_at(49.999f), 0.0, 1e-4);
    EXPECT_EQ(depth_at(1.999f), -1.0f) << "in front of the near plane";
    EXPECT_EQ(depth_at(50.01f), -1.0f) << "behind the far plane";
    // Perspective: n (f - d) / (d (f - n)); orthographic: (f - d) / (f - n).
    const double middle =
        projection == Projection::perspective ? 2.0 * 25.0 / (25.0 * 48.0) : 25.0 / 48.0;
    EXPECT_NEAR(depth_at(25.0f), middle, 1e-6);
  }
}

TEST_F(RasterGeometry, SurfaceBehindTheCameraIsNotSeen) {
  SceneMaker maker = perspective_scene();
  maker.object("behind", rectangle(-50, -50, 50, 50, 12.0f), 0);
  for (const uint32_t object : render(maker, 4, 4).object) EXPECT_EQ(object, 0u);
}

TEST_F(RasterGeometry, SurfaceThroughTheCameraPlaneIsClipped) {
  SceneMaker maker = perspective_scene();
  // A floor 2 m below a camera that looks along +Y, from far behind it to far before it.
  maker.scene->camera.world_from_camera =
      mat4x3(vec3(1, 0, 0), vec3(0, 0, 1), vec3(0, -1, 0), vec3(0, 0, 2));
  maker.object("floor", rectangle(-50, -50, 50, 50), 0);
  const GBuffer g = render(maker, 8, 8);
  for (int x = 0; x < 8; ++x) {
    EXPECT_EQ(g.object[at(g, x, 0)], 1u);
    EXPECT_EQ(g.object[at(g, x, 7)], 0u);
    // The lowest row's centres look down at 7/8: 2 m below at 2 / (7/8) m before the camera.
    EXPECT_NEAR(g.position[at(g, x, 0)].y, 16.0 / 7.0, 1e-5);
  }
}

TEST_F(RasterGeometry, OrthographicWindowMayLieAnywhere) {
  SceneMaker maker;
  Camera& camera = maker.scene->camera;
  camera.left = 3.0f;
  camera.right = 7.0f;
  camera.bottom = -1.0f;
  camera.top = 1.0f;
  maker.object("wall", rectangle(4, -9, 99, 9), 0);
  const GBuffer g = render(maker, 8, 4);  // pixels of half a metre
  EXPECT_EQ(g.object[at(g, 1, 0)], 0u);
  EXPECT_EQ(g.object[at(g, 2, 0)], 1u);
  EXPECT_VEC_NEAR(g.position[at(g, 2, 0)], vec3(4.25f, -0.75f, 0.0f), 2e-6);
  EXPECT_VEC_NEAR(g.position[at(g, 7, 3)], vec3(6.75f, 0.75f, 0.0f), 2e-6);
}

TEST_F(RasterGeometry, PerspectiveWindowMayBeShifted) {
  SceneMaker maker = perspective_scene();
  Camera& camera = maker.scene->camera;
  camera.left = 0.2f;
  camera.right = 0.6f;
  camera.bottom = -0.3f;
  camera.top = 0.1f;
  maker.object("wall", rectangle(-99, -99, 99, 99), 0);
  const GBuffer g = render(maker, 4, 4);  // pixels of 1 m at a distance of 10 m
  EXPECT_VEC_NEAR(g.position[at(g, 0, 0)], vec3(2.5f, -2.5f, 0.0f), 3e-5);
  EXPECT_VEC_NEAR(g.position[at(g, 3, 3)], vec3(5.5f, 0.5f, 0.0f), 3e-5);
}

TEST_F(RasterGeometry, TurnedCameraLooksWhereItPoints) {
  SceneMaker maker = perspective_scene();
  // At (5, 0, 1), looking along +X, up is +Z; so right is -Y.
  maker.scene->camera.world_from_camera =
      mat4x3(vec3(0, -1, 0), vec3(0, 0, 1), vec3(-1, 0, 0), vec3(5, 0, 1));
  maker.object("wall", test::quad_mesh(vec3(9, 40, -40), vec3(0, -80, 0), vec3(0, 0, 80)), 0);
  const GBuffer g = render(maker, 2, 2);  // the window's quarter centres lie at +-0.5
  EXPECT_VEC_NEAR(g.position[at(g, 0, 0)], vec3(9, 2, -1), 1e-5);
  EXPECT_VEC_NEAR(g.position[at(g, 1, 1)], vec3(9, -2, 3), 1e-5);
  EXPECT_VEC_NEAR(g.normal_geometric[0], vec3(-1, 0, 0), 1e-6);
}

TEST_F(RasterGeometry, SubpixelMovesTheSampleNotThePicture) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    SceneMaker maker;
    maker.scene->camera.projection = projection;
    if (projection == Projection::orthographic) {
      Camera& camera = maker.scene->camera;
      camera.left = camera.bottom = -10.0f;
      camera.right = camera.top = 10.0f;
    }
    // Pixels of 1 m; pixel (10, 10) has its centre at (0.5, 0.5), the edges are beyond it.
    maker.object("wall", rectangle(0.75f, 0.75f, 9, 9), 0);
    const auto sees = [&](const vec2& subpixel) {
      const GBuffer g = render(maker, 20, 20, subpixel);
      return g.object[at(g, 10, 10)] == 1u;
    };
    EXPECT_FALSE(sees({0, 0}));
    EXPECT_TRUE(sees({0.3f, 0.3f}));
    EXPECT_FALSE(sees({0.2f, 0.3f}));
    EXPECT_FALSE(sees({0.3f, 0.2f}));
    EXPECT_FALSE(sees({-0.3f, 0.3f}));
    const GBuffer g = render(maker, 20, 20, {0.3f, -0.4f});
    EXPECT_VEC_NEAR(g.position[at(g, 12, 12)], vec3(2.8f, 2.1f, 0.0f), 2e-5);
  }
}

TEST_F(RasterGeometry, BackOfASurfaceIsDrawnWithTheMeshsOwnNormal) {
  SceneMaker maker = perspective_scene();
  auto mesh = std::make_shared<Mesh>(*rectangle(-20, -20, 20, 20));
  for (uvec3& t : mesh->triangles) std::swap(t.y, t.z);
  maker.object("from behind", mesh, 0);
  const GBuffer g = render(maker, 2, 2);
  EXPECT_EQ(g.object[0], 1u);
  EXPECT_VEC_NEAR(g.normal[0], vec3(0, 0, -1), 1e-6);
  EXPECT_VEC_NEAR(g.normal_geometric[0], vec3(0, 0, -1), 1e-6);
}

TEST_F(RasterGeometry, SmoothNormalsInterpolateAndTheGeometricNormalStaysFlat) {
  SceneMaker maker;
  auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
  const vec3 left = glm::normalize(vec3(-1, 0, 1)), right = glm::normalize(vec3(1, 0, 1));
  mesh->corner_normals = {left, right, right, left, right, left};
  maker.object("cushion", mesh, 0);
  const GBuffer g = render(maker, 4, 4);
  for (int x = 0; x < 4; ++x) {
    const float across = (static_cast<float>(x) + 0.5f) / 4.0f;
    const vec3 expected = glm::normalize(glm::mix(left, right, across));
    EXPECT_VEC_NEAR(g.normal[at(g, x, 1)], expected, 2e-6);
    EXPECT_VEC_NEAR(g.normal_geometric[at(g, x, 1)], vec3(0, 0, 1), 1e-6);
  }
}

TEST_F(RasterGeometry, NormalsOfStretchedObjectsStayPerpendicular) {
  SceneMaker maker;
  // The plane x + z = 0, stretched fourfold along X: its normal is (1, 0, 4), normalised.
  const auto slope = test::quad_mesh(vec3(-1, -1, 1), vec3(2, 0, -2), vec3(0, 2, 0));
  mat4x3 stretched(1.0f);
  stretched[0] = vec3(4, 0, 0);
  maker.object("slope", slope, 0, stretched);
  const GBuffer g = render(maker, 2, 2);
  const vec3 expected = glm::normalize(vec3(1, 0, 4));
  EXPECT_VEC_NEAR(g.normal[0], expected, 1e-6);
  EXPECT_VEC_NEAR(g.normal_geometric[0], expected, 1e-6);
}

TEST_F(RasterGeometry, MirroredObjectKeepsItsOuterSide) {
  SceneMaker maker;
  const auto slope = test::quad_mesh(vec3(-1, -1, 1), vec3(2, 0, -2), vec3(0, 2, 0));
  mat4x3 mirrored(1.0f);
  mirrored[0] = vec3(-1, 0, 0);
  maker.object("mirrored", slope, 0, mirrored);
  ASSERT_TRUE(maker.scene->objects[0].flips_orientation);
  const GBuffer g = render(maker, 2, 2);
  const vec3 expected = glm::normalize(vec3(-1, 0, 1));
  EXPECT_VEC_NEAR(g.normal[0], expected, 1e-6);
  EXPECT_VEC_NEAR(g.normal_geometric[0], expected, 1e-6);
}

TEST_F(RasterGeometry, NormalsSurviveTheTargetInEveryDirection) {
  std::mt19937 random(7);
  std::normal_distribution<float> gauss;
  for (int k = 0; k < 60; ++k) {
    vec3 n = glm::normalize(vec3(gauss(random), gauss(random), gauss(random)));
    if (k < 6) {  // the axes, where the encoding folds
      n = vec3(0.0f);
      n[k / 2] = k % 2 ? -1.0f : 1.0f;
    }
    SceneMaker maker;
    auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
    mesh->corner_normals.assign(6, n);
    maker.object("wall", mesh, 0);
    const GBuffer g = render(maker, 1, 1);
    EXPECT_VEC_NEAR(g.normal[0], n, 5e-7);
  }
}

TEST_F(RasterGeometry, EachSlotHasItsMaterial) {
  SceneMaker maker;
  const int red = maker.material({.name = "red", .diffuse = vec4(1, 0, 0, 1)});
  const int green = maker.material({.name = "green", .diffuse = vec4(0, 1, 0, 1)});
  auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));  // split along the diagonal x = y
  mesh->triangle_materials = {1, 0};
  maker.object("two-tone", mesh, red);
  maker.scene->objects[0].materials = {red, green};
  const GBuffer g = render(maker, 8, 8);
  EXPECT_EQ(g.material[at(g, 6, 1)], static_cast<uint32_t>(green));
  EXPECT_EQ(g.diffuse[at(g, 6, 1)], vec4(0, 1, 0, 1));
  EXPECT_EQ(g.material[at(g, 1, 6)], static_cast<uint32_t>(red));
  EXPECT_EQ(g.diffuse[at(g, 1, 6)], vec4(1, 0, 0, 1));
}

TEST_F(RasterGeometry, SlotBeyondTheObjectsListTakesItsLastMaterial) {
  SceneMaker maker;
  const int red = maker.material({.name = "red"});
  auto mesh = std::make_shared<Mesh>(*rectangle(-1, -1, 1, 1));
  mesh->triangle_materials = {7, 7};
  maker.object("wall", mesh, red);
  EXPECT_EQ(render(maker, 1, 1).material[0], static_cast<uint32_t>(red));
}

TEST_F(RasterGeometry, ObjectsShareAMesh) {
  SceneMaker maker;
  const auto mesh = rectangle(-0.4f, -0.4f, 0.4f, 0.4f);
  maker.object("left", mesh, 0, test::placed(vec3(-0.5f, 0, 0)));
  maker.object("right", mesh, 0, test::placed(vec3(0.5f, 0, 0)));
  const GBuffer g = render(maker, 4, 1);
  EXPECT_EQ(g.object[0], 1u);
  EXPECT_EQ(g.object[3], 2u);
}

TEST_F(RasterGeometry, EmptyMeshesAndUnusedMeshesAreFine) {
  SceneMaker maker;
  maker.object("empty", std::make_shared<Mesh>(), 0);
  maker.object("wall", rectangle(-1, -1, 1, 1), 0);
  maker.scene->meshes.push_back(std::make_shared<Mesh>());
  EXPECT_EQ(render(maker, 1, 1).object[0], 2u);
}

TEST_F(RasterGeometry, FlattenedObjectKeepsItsNormal) {
  SceneMaker maker;
  mat4x3 flat(1.0f);
  flat[2] = vec3(0.0f);
  maker.object("pancake", test::sphere_mesh(16, 8), 0, flat);
  const GBuffer g = render(maker, 3, 3);
  EXPECT_EQ(g.object[at(g, 1, 1)], 1u);
  EXPECT_NEAR(std::abs(g.normal_geometric[at(g, 1, 1)].z), 1.0, 1e-6);
}

TEST_F(RasterGeometry, NextSceneReplacesTheLast) {
  SceneMaker maker;
  maker.object("wall", rectangle(-1, -1, 1, 1), 0);
  EXPECT_EQ(render(maker, 2, 1).object[0], 1u);

  // The same mesh elsewhere.
  maker.scene = std::make_shared<Scene>(*maker.scene);
  maker.scene->objects[0].world_from_object[3] = vec3(1, 0, 0);
  GBuffer g = render(maker, 2, 1);
  EXPECT_EQ(g.object[0], 0u);
  EXPECT_EQ(g.object[1], 1u);

  // Another mesh in its place.
  maker.scene = std::make_shared<Scene>(*maker.scene);
  maker.scene->meshes[0] = rectangle(-2, -1, -1, 1);
  g = render(maker, 2, 1);
  EXPECT_EQ(g.object[0], 1u);
  EXPECT_EQ(g.object[1], 0u);

  // Nothing.
  g = render(SceneMaker(), 2, 1);
  EXPECT_EQ(g.object[0], 0u);
}

TEST_F(RasterGeometry, PictureSizeMayChangeBetweenFrames) {
  SceneMaker maker;
  maker.object("wall", rectangle(0, -1, 1, 1), 0);
  for (const int width : {8, 2, 130}) {
    const GBuffer g = render(maker, width, 3);
    EXPECT_EQ(g.object[at(g, width / 2 - 1, 1)], 0u);
    EXPECT_EQ(g.object[at(g, width / 2, 1)], 1u);
  }
}

TEST_F(RasterGeometry, PictureBeyondTheDeviceIsRefusedWithARemedy) {
  SceneMaker maker;
  stage_->update(maker.scene);
  GBuffer out;
  try {
    stage_->run({*maker.scene, 65536, 1}, out);
    FAIL() << "no device is that wide";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
    EXPECT_NE(std::string(error.what()).find("primary=rays"), std::string::npos);
  }
  EXPECT_EQ(render(maker, 2, 2).object[0], 0u) << "and the next picture works";
}

TEST_F(RasterGeometry, RunBeforeUpdateIsAnError) {
  const Scene scene;
  GBuffer out;
  EXPECT_THROW(stage_->run({scene, 2, 2}, out), Error);
}

}  // namespace
}  // namespace kestrel
