// SPDX-License-Identifier: GPL-3.0-or-later
// The background against the formulas of core/scene/world.h and against landmarks by hand.
#include <array>
#include <cmath>

#include "raster_fixture.h"
#include "scene/world.h"

namespace kestrel {
namespace {

using test::at;
using test::SceneMaker;

/// A camera that looks along `forward` through a narrow window: every pixel sees almost that
/// direction.
void look_along(Scene& scene, const vec3& forward) {
  const vec3 back = -glm::normalize(forward);
  const vec3 aside = std::abs(back.z) > 0.9f ? vec3(0, 1, 0) : vec3(0, 0, 1);
  const vec3 right = glm::normalize(glm::cross(aside, back));
  scene.camera.projection = Projection::perspective;
  scene.camera.world_from_camera = mat4x3(right, glm::cross(back, right), back, vec3(3, -2, 7));
  scene.camera.left = scene.camera.bottom = -1e-4f;
  scene.camera.right = scene.camera.top = 1e-4f;
}

/// One flat colour.
Texture plain(const vec3& color) {
  Texture t{"plain", 1, 1};
  t.texels_float = {color.x, color.y, color.z, 1};
  return t;
}

/// Red and green grow with u and v: every place has a colour of its own, and bilinear
/// interpolation is exact between the texels' centres.
Texture gradient(int width, int height) {
  Texture t{"gradient", width, height};
  t.extension = Extension::repeat;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      t.texels_float.insert(t.texels_float.end(), {u, v, 0.5f, 1.0f});
    }
  }
  return t;
}

class RasterWorld : public test::RasterTest {
 protected:
  vec3 seen_along(SceneMaker maker, const vec3& direction) {
    maker.scene = std::make_shared<Scene>(*maker.scene);
    look_along(*maker.scene, direction);
    return render(maker, 1, 1).lighting[0];
  }

  static SceneMaker equirectangular(const Texture& texture) {
    SceneMaker maker;
    maker.scene->world.kind = WorldKind::equirectangular;
    maker.scene->world.color = vec3(1.0f);
    maker.scene->world.textures[0] = maker.texture(texture);
    return maker;
  }

  static SceneMaker cube(const std::array<Texture, 6>& faces) {
    SceneMaker maker;
    maker.scene->world.kind = WorldKind::cube;
    maker.scene->world.color = vec3(1.0f);
    for (size_t i = 0; i < 6; ++i) maker.scene->world.textures[i] = maker.texture(faces[i]);
    return maker;
  }
};

TEST_F(RasterWorld, EquirectangularLandmarks) {
  const SceneMaker maker = equirectangular(gradient(64, 32));
  // Blender: +X is the middle, -Y lies a quarter to the right, the top is up.
  EXPECT_VEC_NEAR(seen_along(maker, vec3(1, 0, 0)), vec3(0.5f, 0.5f, 0.5f), 2e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0, -1, 0)), vec3(0.75f, 0.5f, 0.5f), 2e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0, 1, 0)), vec3(0.25f, 0.5f, 0.5f), 2e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(1, 0, 1)), vec3(0.5f, 0.75f, 0.5f), 2e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(1, 0, -1)), vec3(0.5f, 0.25f, 0.5f), 2e-3);
}

TEST_F(RasterWorld, EquirectangularFollowsTheFormulaEverywhere) {
  SceneMaker maker = equirectangular(gradient(256, 128));
  Scene& scene = *maker.scene;
  scene.world.color = vec3(2.0f, 1.0f, 0.5f);
  scene.camera.projection = Projection::perspective;
  scene.camera.left = -2.0f;
  scene.camera.right = 3.0f;
  const int width = 40, height = 24;
  const vec2 subpixel(0.25f, -0.125f);
  const GBuffer g = render(maker, width, height, subpixel);  // looks down
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float px = (static_cast<float>(x) + 0.5f + subpixel.x) / width;
      const float py = (static_cast<float>(y) + 0.5f + subpixel.y) / height;
      const vec3 d = glm::normalize(vec3(-2.0f + 5.0f * px, -1.0f + 2.0f * py, -1.0f));
      const vec2 uv = equirectangular_uv(d);
      if (uv.x < 0.01f || uv.x > 0.99f || uv.y < 0.01f) continue;  // beyond the texels' centres
      EXPECT_VEC_NEAR(g.lighting[at(g, x, y)], vec3(2.0f * uv.x, uv.y, 0.25f), 4e-3);
    }
  }
}

TEST_F(RasterWorld, EquirectangularHasNoSeamAndClampedPoles) {
  Texture t{"bands", 4, 2};
  t.extension = Extension::clip;  // a world ignores it
  // Left column 0, right column 1; bottom row green 0, top row green 1.
  for (const float v : {0.0f, 1.0f}) {
    for (const float u : {0.0f, 0.5f, 0.5f, 1.0f}) {
      t.texels_float.insert(t.texels_float.end(), {u, v, 1, 1});
    }
  }
  const SceneMaker maker = equirectangular(t);
  // -X is the seam: halfway between the last column and the first.
  EXPECT_VEC_NEAR(seen_along(maker, vec3(-1, 0, 0)), vec3(0.5f, 0.5f, 1), 5e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0.001f, 0, 1)), vec3(0.5f, 1, 1), 5e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0.001f, 0, -1)), vec3(0.5f, 0, 1), 5e-3);
}

TEST_F(RasterWorld, MapTurnsTheDirections) {
  SceneMaker maker = equirectangular(gradient(64, 32));
  // Turned by 90 degrees about Z: what lies towards +Y in the world is read at +X.
  maker.scene->world.map_from_world = mat3(vec3(0, -1, 0), vec3(1, 0, 0), vec3(0, 0, 1));
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0, 1, 0)), vec3(0.5f, 0.5f, 0.5f), 2e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(1, 0, 0)), vec3(0.75f, 0.5f, 0.5f), 2e-3);
}

TEST_F(RasterWorld, CubeFacesLieAlongTheAxes) {
  const vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::array<Texture, 6> faces;
  for (size_t i = 0; i < 6; ++i) faces[i] = plain(vec3(static_cast<float>(i) + 1.0f, 0.0f, 2.0f));
  const SceneMaker maker = cube(faces);
  for (size_t i = 0; i < 6; ++i) {
    const vec3 expected(static_cast<float>(i) + 1.0f, 0.0f, 2.0f);
    EXPECT_EQ(seen_along(maker, axes[i]), expected) << "face " << i;
    EXPECT_EQ(seen_along(maker, axes[i] + vec3(0.3f, 0.4f, -0.35f)), expected) << "face " << i;
  }
}

TEST_F(RasterWorld, CubeFacesAreTurnedAsGlTurnsThem) {
  // The face +X with GL's axes: u along -Z, v (upwards in the image) along +Y. +Z: u along +X.
  // +Y: u along +X, v along -Z.
  std::array<Texture, 6> faces;
  for (Texture& face : faces) face = gradient(32, 32);
  const SceneMaker maker = cube(faces);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(1, 0, -0.5f)), vec3(0.75f, 0.5f, 0.5f), 3e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(1, 0.5f, 0)), vec3(0.5f, 0.75f, 0.5f), 3e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0.5f, 0, 1)), vec3(0.75f, 0.5f, 0.5f), 3e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0.5f, 1, 0)), vec3(0.75f, 0.5f, 0.5f), 3e-3);
  EXPECT_VEC_NEAR(seen_along(maker, vec3(0, 1, -0.5f)), vec3(0.5f, 0.75f, 0.5f), 3e-3);
}

TEST_F(RasterWorld, CubeFollowsTheFormulaOnEveryFace) {
  std::array<Texture, 6> faces;
  for (Texture& face : faces) face = gradient(64, 64);
  SceneMaker maker = cube(faces);
  for (int k = 0; k < 60; ++k) {
    const float a = 2.39996f * static_cast<float>(k),
                z = 1.0f - (static_cast<float>(k) + 0.5f) / 30;
    const vec3 d = vec3(std::sqrt(1 - z * z) * vec2(std::cos(a), std::sin(a)), z);
    const CubeUv expected = cube_uv(d);
    const vec2 inside = glm::clamp(expected.uv, vec2(0.5f / 64), vec2(1 - 0.5f / 64));
    EXPECT_VEC_NEAR(seen_along(maker, d), vec3(inside, 0.5f), 3e-3);
  }
}

TEST_F(RasterWorld, CubeEdgesDoNotWrapAround) {
  std::array<Texture, 6> faces;
  for (Texture& face : faces) {
    face = Texture{"halves", 2, 1};
    face.texels_float = {0, 0, 0, 1, 1, 1, 1, 1};
  }
  // At the edge of the face +Z towards +X: the right texel alone.
  EXPECT_VEC_NEAR(seen_along(cube(faces), vec3(0.99f, 0, 1)), vec3(1.0f), 1e-3);
}

TEST_F(RasterWorld, WorldWithoutAnImageShowsItsColor) {
  SceneMaker maker;
  maker.scene->world.kind = WorldKind::cube;
  maker.scene->world.color = vec3(0.25f, 0.5f, 0.75f);
  EXPECT_EQ(seen_along(maker, vec3(0, 1, 0)), vec3(0.25f, 0.5f, 0.75f));
}

TEST_F(RasterWorld, OrthographicPixelsSeeOneDirection) {
  SceneMaker maker = equirectangular(gradient(64, 32));
  // Looks along +X, up is +Z.
  maker.scene->camera.world_from_camera =
      mat4x3(vec3(0, -1, 0), vec3(0, 0, 1), vec3(-1, 0, 0), vec3(0));
  const GBuffer g = render(maker, 3, 3);
  for (const vec3& radiance : g.lighting) {
    EXPECT_VEC_NEAR(radiance, vec3(0.5f, 0.5f, 0.5f), 2e-3);
  }
}

}  // namespace
}  // namespace kestrel
