// SPDX-License-Identifier: GPL-3.0-or-later
// The shaders against the same maths on the processor (core/shading): lights and worlds at random.
#include <cmath>
#include <random>

#include "raster_fixture.h"
#include "shading/shading.h"
#include "shading/texture.h"

namespace kestrel {
namespace {

using test::at;
using test::SceneMaker;

class RasterParity : public test::RasterTest {
 protected:
  std::mt19937 random_{17};

  float uniform(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  vec3 uniform_vec(float low, float high) {
    return {uniform(low, high), uniform(low, high), uniform(low, high)};
  }

  void add_random_lights(SceneMaker& maker, int count) {
    for (int i = 0; i < count; ++i) {
      const auto type = static_cast<LightType>(i % 3);
      Light& light = maker.light(type, uniform_vec(0, 2), uniform_vec(-4, 4) + vec3(0, 0, 1));
      light.direction = glm::normalize(uniform_vec(-1, 1));
      if (type == LightType::spot) light.direction = glm::normalize(-light.position);
      light.attenuation = uniform_vec(0.1f, 1);
      light.cos_outer = uniform(0.2f, 0.99f);
      light.blend = i % 2 ? uniform(0, 1) : 0.0f;
      light.specular_factor = uniform(0, 2);
    }
  }
};

/// The surface that the G-buffer shows at a pixel.
Surface surface_of(const GBuffer& g, size_t i) {
  Surface s{};
  s.position = g.position[i];
  s.normal = g.normal[i];
  s.normal_geometric = g.normal_geometric[i];
  s.emission = g.emission[i];
  s.ambient = g.ambient[i];
  s.diffuse = g.diffuse[i];
  s.specular = g.specular[i];
  s.optical = g.optical[i];
  return s;
}

TEST_F(RasterParity, LightingIsTheProcessors) {
  SceneMaker maker = test::perspective_scene();
  Camera& camera = maker.scene->camera;
  camera.left = camera.bottom = -0.2f;
  camera.right = camera.top = 0.2f;
  maker.scene->settings.ambient = vec3(0.1f, 0.2f, 0.05f);
  for (int i = 0; i < 8; ++i) {
    Material m;
    m.diffuse = vec4(uniform_vec(0, 1), 1);
    m.specular = vec4(uniform_vec(0, 1), uniform(0, 1));
    m.ambient = uniform_vec(0, 1);
    if (i == 0) m.emission = uniform_vec(0, 5);
    const int material = maker.material(m);
    maker.object("ball", test::sphere_mesh(48, 24), material,
                 test::placed(uniform_vec(-1.5f, 1.5f), uniform(0.2f, 0.8f)));
  }
  add_random_lights(maker, 12);
  const GBuffer g = render(maker, 96, 96);
  int compared = 0;
  for (size_t i = 0; i < g.object.size(); ++i) {
    if (g.object[i] == 0) continue;
    const vec3 to_viewer =
        glm::normalize(vec3(maker.scene->camera.world_from_camera[3]) - g.position[i]);
    Surface surface = surface_of(g, i);
    face_viewer(surface, to_viewer);
    const vec3 expected = lighting_without_shadows(*maker.scene, surface, to_viewer);
    for (int k = 0; k < 3; ++k) {
      ASSERT_NEAR(g.lighting[i][k], expected[k], 2e-3f * expected[k] + 1e-4f) << "pixel " << i;
    }
    ++compared;
  }
  EXPECT_GT(compared, 1500);
}

TEST_F(RasterParity, BackgroundIsTheProcessors) {
  for (const WorldKind kind : {WorldKind::equirectangular, WorldKind::cube}) {
    SceneMaker maker = test::perspective_scene();
    World& world = maker.scene->world;
    world.kind = kind;
    world.color = vec3(1.0f, 0.5f, 2.0f);
    world.map_from_world = mat3(vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0));
    for (int& texture : world.textures) {
      Texture t{"noise", 32, 16};
      t.extension = Extension::repeat;
      for (int i = 0; i < 4 * t.width * t.height; ++i) t.texels_float.push_back(uniform(0, 1));
      if (kind == WorldKind::cube) t.extension = Extension::clamp;
      texture = maker.texture(t);
    }
    const GBuffer g = render(maker, 64, 64);
    double sum = 0.0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const vec2 p = (vec2(x, y) + 0.5f) / 32.0f - 1.0f;
        const vec3 expected = sample_world(*maker.scene, glm::normalize(vec3(p, -1.0f)));
        // Samplers weigh texels in steps of 1/256.
        EXPECT_VEC_NEAR(g.lighting[at(g, x, y)], expected, 0.03);
        sum += glm::length(g.lighting[at(g, x, y)] - expected);
      }
    }
    EXPECT_LT(sum / (64 * 64), 4e-3);
  }
}

}  // namespace
}  // namespace kestrel
