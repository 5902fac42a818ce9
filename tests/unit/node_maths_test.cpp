// SPDX-License-Identifier: GPL-3.0-or-later
// The maths of colour and texture nodes: what each is known for, and that shaders compute the same.
// Against Blender itself: tests/blender/test_node_maths.py.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "gl/context.h"
#include "gl/debug.h"
#include "gl/objects.h"
#include "gl/shader_library.h"
#include "node_maths/evaluate.h"

namespace kestrel::nodes {
namespace {

constexpr int kVersions[] = {3, 4, 5};

/// Points of -3 to 3, the same every time.
std::vector<vec4> random_points(size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-3.0f, 3.0f);
  std::vector<vec4> points(count);
  for (vec4& p : points) p = {uniform(random), uniform(random), uniform(random), uniform(random)};
  return points;
}

vec4 value(const std::string& call, const vec4& at) {
  return parse_call(call).value()(at);
}

NoiseInputs fractal_noise() {
  return {kNoiseFbm, true, 2.0f, 0.5f, 2.0f, 0.0f, 1.0f, 0.0f};
}

VoronoiInputs cells(uint feature) {
  return {feature, kVoronoiEuclidean, false, 1.0f, 0.0f, 0.5f, 2.0f, 1.0f, 0.5f, 1.0f};
}

// ---- hashes ------------------------------------------------------------------------------------

TEST(NodeHash, IsLookup3) {
  // hashword() of Bob Jenkins' lookup3.c with an initial value of 13.
  EXPECT_EQ(hash_uint(0), 2501500005u);
  EXPECT_NE(hash_uint2(1, 2), hash_uint2(2, 1));
  EXPECT_NE(hash_uint3(1, 2, 0), hash_uint2(1, 2));
}

TEST(NodeHash, IsUniform) {
  double sums[4] = {};
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    const float f = static_cast<float>(i);
    const vec4 hashes(hash_float(f), hash_vec2({f, 1}), hash_vec4({1, 2, f, 4}),
                      pcg_ivec3_to_vec3(i, 2, -3).y);
    for (int k = 0; k < 4; ++k) {
      EXPECT_TRUE(hashes[k] >= 0.0f && hashes[k] <= 1.0f);
      sums[k] += hashes[k];
    }
  }
  for (const double sum : sums) EXPECT_NEAR(sum / count, 0.5, 0.01);
}

TEST(NodeHash, RemainderIsThatOfC) {
  for (float x : {0.0f, 99999.9f, 100000.0f, -100001.5f, 12345678.0f, -33.3f, 7e6f}) {
    EXPECT_EQ(signed_remainder(x, 100000.0f), std::fmod(x, 100000.0f)) << x;
    EXPECT_NEAR(std::sin(signed_remainder(x * 1e-3f, 6.2831853f)),
                std::sin(std::fmod(x * 1e-3f, 6.2831853f)), 1e-5)
        << x;
  }
}

// ---- noise -------------------------------------------------------------------------------------

TEST(NodeNoise, IsZeroOnTheGridAndBoundedElsewhere) {
  for (int dimensions = 1; dimensions <= 4; ++dimensions) {
    EXPECT_EQ(signed_noise(dimensions, {3, -2, 1, 5}, 4), 0.0f);
    float largest = 0.0f;
    for (const vec4& p : random_points(20000)) {
      largest = std::max(largest, std::abs(signed_noise(dimensions, p, 4)));
    }
    EXPECT_LE(largest, 1.001f);
    EXPECT_GE(largest, 0.5f);
  }
}

TEST(NodeNoise, IsSmoothAcrossCells) {
  for (int dimensions = 1; dimensions <= 4; ++dimensions) {
    for (const vec4& p : random_points(200)) {
      vec4 below = p, above = p;
      below.x = std::round(p.x) - 1e-4f;
      above.x = std::round(p.x) + 1e-4f;
      EXPECT_NEAR(signed_noise(dimensions, below, 4), signed_noise(dimensions, above, 4), 2e-3f);
    }
  }
}

TEST(NodeNoise, RepeatsFarOutFromBlender4On) {
  for (int dimensions = 1; dimensions <= 4; ++dimensions) {
    const vec4 p(0.25f, 0.5f, 0.75f, 0.125f);
    EXPECT_EQ(signed_noise(dimensions, p + vec4(200000.0f), 4), signed_noise(dimensions, p, 4));
    EXPECT_NE(signed_noise(dimensions, p + vec4(200000.0f), 3), signed_noise(dimensions, p, 3));
  }
}

TEST(NodeNoise, DetailBlendsOctavesIn) {
  NoiseInputs inputs = fractal_noise();
  const vec4 p(0.3f, 1.7f, -0.4f, 0.9f);
  inputs.detail = 2.0f;
  const float two = noise_fractal(4, p, inputs, 4);
  inputs.detail = 3.0f;
  const float three = noise_fractal(4, p, inputs, 4);
  inputs.detail = 2.25f;
  EXPECT_NEAR(noise_fractal(4, p, inputs, 4), 0.75f * two + 0.25f * three, 1e-6f);
  inputs.detail = 99.0f;
  const float most = noise_fractal(4, p, inputs, 4);
  inputs.detail = 15.0f;
  EXPECT_EQ(noise_fractal(4, p, inputs, 4), most);
}

TEST(NodeNoise, ColorChannelsAreNoisesOfTheirOwn) {
  const vec3 color = node_noise(3, {0.3f, 1.7f, -0.4f, 0}, fractal_noise(), 3, 4);
  EXPECT_EQ(color.x, node_noise(3, {0.3f, 1.7f, -0.4f, 0}, fractal_noise(), 1, 4).x);
  EXPECT_NE(color.x, color.y);
  EXPECT_NE(color.y, color.z);
}

// ---- Voronoi -----------------------------------------------------------------------------------

TEST(NodeVoronoi, FeaturesAreInOrder) {
  for (int blender : kVersions) {
    for (int dimensions = 1; dimensions <= 4; ++dimensions) {
      for (const vec4& p : random_points(100)) {
        const float f1 = node_voronoi(dimensions, p, cells(kVoronoiF1), blender).distance;
        EXPECT_LE(f1, node_voronoi(dimensions, p, cells(kVoronoiF2), blender).distance);
        EXPECT_LE(node_voronoi(dimensions, p, cells(kVoronoiSmoothF1), blender).distance,
                  f1 + 1e-6f);
      }
    }
  }
}

TEST(NodeVoronoi, PositionIsThatOfTheNearestPoint) {
  for (int blender : kVersions) {
    for (int dimensions = 2; dimensions <= 4; ++dimensions) {
      for (const vec4& at : random_points(100)) {
        VoronoiInputs inputs = cells(kVoronoiF1);
        inputs.scale = 2.5f;
        const vec4 p = texture_point(dimensions, {at.x, at.y, at.z}, at.w, inputs.scale);
        const VoronoiFeature found = node_voronoi(dimensions, p, inputs, blender);
        EXPECT_NEAR(glm::length(p - inputs.scale * found.position), found.distance, 1e-5f);
      }
    }
  }
}

TEST(NodeVoronoi, WithoutRandomnessThePointsAreTheGrid) {
  VoronoiInputs inputs = cells(kVoronoiF1);
  inputs.randomness = 0.0f;
  for (int blender : kVersions) {
    EXPECT_NEAR(node_voronoi(3, {4.5f, -2.5f, 0.5f, 0}, inputs, blender).distance, std::sqrt(0.75f),
                1e-6f);
    inputs.feature = kVoronoiNSphereRadius;
    EXPECT_NEAR(node_voronoi(3, {4.3f, -2.4f, 0.2f, 0}, inputs, blender).distance, 0.5f, 1e-6f);
    inputs.feature = kVoronoiDistanceToEdge;
    EXPECT_NEAR(node_voronoi(3, {4.3f, -2.0f, 0.0f, 0}, inputs, blender).distance, 0.2f, 1e-6f);
    inputs.feature = kVoronoiF1;
  }
}

TEST(NodeVoronoi, NormalizedDistancesEndAboutAtOne) {
  for (uint feature : {kVoronoiF1, kVoronoiF2, kVoronoiDistanceToEdge}) {
    VoronoiInputs inputs = cells(feature);
    inputs.normalize = true;
    inputs.detail = 2.5f;
    float largest = 0.0f;
    for (const vec4& p : random_points(2000)) {
      largest = std::max(largest, node_voronoi(2, p, inputs, 4).distance);
    }
    EXPECT_LE(largest, 1.2f);
    EXPECT_GE(largest, 0.3f);
  }
}

// ---- patterns ----------------------------------------------------------------------------------

TEST(NodePatterns, Checker) {
  EXPECT_EQ(node_checker({0.5f, 0.5f, 0.5f}, 1.0f), 0.0f);
  EXPECT_EQ(node_checker({1.5f, 0.5f, 0.5f}, 1.0f), 1.0f);
  EXPECT_EQ(node_checker({-0.5f, -0.5f, 0.5f}, 1.0f), 0.0f);
  EXPECT_EQ(node_checker({-0.5f, 0.5f, 0.5f}, 1.0f), 1.0f);
  EXPECT_EQ(node_checker({1.0f, 1.0f, 0.0f}, 1.0f), node_checker({1.0001f, 1.0001f, 0.0f}, 1.0f));
}

TEST(NodePatterns, Gradient) {
  EXPECT_FLOAT_EQ(node_gradient(0, {0.3f, 9, 9}), 0.3f);
  EXPECT_FLOAT_EQ(node_gradient(1, {0.5f, 9, 9}), 0.25f);
  EXPECT_FLOAT_EQ(node_gradient(2, {0.5f, 9, 9}), 0.5f);
  EXPECT_FLOAT_EQ(node_gradient(3, {0.2f, 0.4f, 9}), 0.3f);
  EXPECT_NEAR(node_gradient(4, {0.6f, 0, 0}), 0.4f, 1e-5f);
  EXPECT_NEAR(node_gradient(5, {0.6f, 0, 0}), 0.16f, 1e-5f);
  EXPECT_FLOAT_EQ(node_gradient(6, {0, 1, 0}), 0.75f);
  EXPECT_EQ(node_gradient(4, {0, 1, 0}), 0.0f);
}

TEST(NodePatterns, WaveHasItsPeriodAndProfiles) {
  const float period = 6.2831853f / 20.0f;
  for (uint profile = 0; profile < 3; ++profile) {
    const auto at = [&](float x) {
      return node_wave(kWaveBands, 0, profile, {x, 0.3f, 0.9f}, 1, 0, 2, 1, 0.5f, 0, 3);
    };
    EXPECT_NEAR(at(0.1f), at(0.1f + period), 1e-4f);
    EXPECT_NEAR(at(0.25f * period), profile == 1 ? 0.25f : 0.5f, 1e-4f);
  }
}

TEST(NodePatterns, BricksShiftEverySecondRow) {
  const auto mortar = [](float x, float y) {
    return node_brick({x, y, 0}, 1, 0.05f, 0, 0, 1, 0.5f, 0.5f, 2, 1, 2).y;
  };
  EXPECT_EQ(mortar(0.0f, 0.75f), 1.0f);
  EXPECT_EQ(mortar(0.5f, 0.75f), 0.0f);
  EXPECT_EQ(mortar(0.0f, 0.25f), 0.0f);
  EXPECT_EQ(mortar(0.5f, 0.25f), 1.0f);
  EXPECT_EQ(mortar(0.3f, 0.5f), 1.0f);
}

TEST(NodePatterns, EveryMagicDepthDiffers) {
  for (int depth = 0; depth < 10; ++depth) {
    EXPECT_NE(node_magic(depth, {1, 2, 3}, 5, 1, 4), node_magic(depth + 1, {1, 2, 3}, 5, 1, 4));
  }
}

// ---- colours -----------------------------------------------------------------------------------

TEST(NodeColor, HueRoundTrips) {
  for (const vec4& p : random_points(1000)) {
    const vec3 rgb = glm::abs(vec3(p.x, p.y, p.z)) / 3.0f;
    EXPECT_LT(glm::distance(rgb_from_hsv(hsv_from_rgb(rgb)), rgb), 2e-6f);
    EXPECT_LT(glm::distance(rgb_from_hsl(hsl_from_rgb(rgb)), rgb), 2e-6f);
  }
  EXPECT_EQ(hsv_from_rgb({0, 1, 0}), vec3(1.0f / 3.0f, 1, 1));
  EXPECT_EQ(hsv_from_rgb(vec3(0)), vec3(0));
}

TEST(NodeColor, BlendsStartAtTheFirstColor) {
  for (uint type = 0; type < kNodeBlendTypes; ++type) {
    const vec3 a(0.2f, 0.6f, 0.9f), b(0.5f, 0.1f, 0.3f);
    EXPECT_LT(glm::distance(node_blend(type, 0.0f, a, b), a), 1e-6f) << type;
    EXPECT_GT(glm::distance(node_blend(type, 1.0f, a, b), a), 1e-2f) << type;
  }
  EXPECT_EQ(node_blend(5, 1.0f, vec3(0.5f), vec3(0.5f)), vec3(0.75f)) << "screen";
  EXPECT_EQ(node_blend(14, 1.0f, vec3(0.5f), vec3(0.0f)), vec3(0.5f)) << "division by zero";
}

TEST(NodeColor, LightHasItsColors) {
  EXPECT_NEAR(color_luminance(node_blackbody(6500.0f)), 1.0f, 0.02f);
  EXPECT_GT(node_blackbody(2000.0f).x, 3.0f * node_blackbody(2000.0f).y);
  EXPECT_GT(node_blackbody(11000.0f).z, node_blackbody(11000.0f).x);
  EXPECT_EQ(node_blackbody(100.0f), node_blackbody(799.0f));
  const vec3 red = node_wavelength(650), green = node_wavelength(530), blue = node_wavelength(450);
  EXPECT_TRUE(red.x > red.y && green.y > green.x && blue.z > blue.y);
  EXPECT_EQ(node_wavelength(900), vec3(0));
}

// ---- every function ----------------------------------------------------------------------------

/// Calls that between them go through every branch of every function.
std::vector<std::string> calls() {
  std::vector<std::string> all;
  const auto add = [&](auto... words) {
    std::ostringstream line;
    ((line << words << ' '), ...);
    all.push_back(line.str());
  };
  for (int dimensions = 1; dimensions <= 4; ++dimensions) {
    add("white_noise", dimensions);
    for (int type = 0; type < 5; ++type) {
      add("noise", dimensions, type, 1, 2.3, 2.6, 0.6, 2.4, 0.4, 1.3, 0.3, 4);
      add("musgrave", dimensions, type, 2.3, 2.6, 0.8, 2.2, 0.4, 1.3);
    }
    add("noise", dimensions, 0, 0, 2.3, 2.6, 0.6, 2.4, 0, 1, 0, 4);
    add("noise", dimensions, 0, 1, 4, 3, 0.5, 2, 0, 1, 0.5, 3);
    add("noise", dimensions, 0, 1, 70000, 0, 0.5, 2, 0, 1, 0, 4);
    for (int blender : kVersions) {
      for (int feature = 0; feature < 8; ++feature) {
        const float detail = blender == 3 ? 0.0f : 1.4f;
        add("voronoi", dimensions, feature, feature % 4, blender != 3, 1.7, detail, 0.6, 2.2, 0.7,
            0.8, 0.9, blender);
      }
    }
  }
  for (int i = 0; i < 3 * 8; ++i)
    add("wave", i % 2, i / 2 % 4, i / 8, 0.3, i % 3, 2.5, 1, 0.6, 1, 4);
  for (int depth = 0; depth <= 10; ++depth) add("magic", depth, 0.8, 1.5, depth % 3 + 3);
  for (int type = 0; type < 7; ++type) add("gradient", type);
  add("checker", 2.3);
  add("brick", 2, 0.05, 0.4, -0.2, 0.6, 0.3, 0.4, 3, 1.5, 2);
  add("brick", 2, 0.05, 0, 0, 0.6, 0.3, 0.4, 0, 1.5, 0);
  for (uint type = 0; type < kNodeBlendTypes; ++type) add("blend", type, 0.7, 0.8, 0.3, 0.5);
  for (int conversion = 0; conversion < 4; ++conversion) add("color_space", conversion);
  add("hue_saturation", 0.3, 1.4, 0.8);
  add("bright_contrast", 0.1, 0.7);
  add("gamma", 0);
  add("gamma", 2.2);
  add("invert", 0.8);
  add("luminance");
  add("blackbody", 6000, 2500);
  add("wavelength", 580, 80);
  return all;
}

TEST(NodeMaths, AnyNumberIsSafe) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (const std::string& line : calls()) {
    for (float x : {0.0f, -0.0f, 1e-40f, 1e9f, -1e9f, 3e38f, inf, -inf, std::nanf("")}) {
      for (const vec4& at : {vec4(x), vec4(x, 0.3f, 0.4f, 0.5f), vec4(0.3f, 0.4f, 0.5f, x)}) {
        const vec4 result = value(line, at);
        if (std::abs(x) < 1e10f) {
          EXPECT_TRUE(std::isfinite(result.x)) << line << " at " << x;
        }
      }
    }
  }
}

/// The values of a call as a compute shader gives them.
class ShaderMaths {
 public:
  ShaderMaths() {
    std::ifstream file(KESTREL_SOURCE_DIR "/tests/node_maths/evaluate.glsl");
    std::ostringstream evaluate;
    evaluate << file.rdbuf();
    std::string files;
    const std::string source =
        gl::expand_shader("nodes/textures.glsl", files) + evaluate.str() + R"(
layout(local_size_x = 64) in;
layout(location = 0) uniform int function;
layout(location = 1) uniform float parameters[12];
layout(std430, binding = 0) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 1) writeonly buffer Values { vec4 values[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < uint(points.length())) values[i] = evaluate(function, parameters, points[i]);
}
)";
    const gl::Shader shader(GL_COMPUTE_SHADER, "node maths");
    const char* text = source.c_str();
    glShaderSource(shader.name(), 1, &text, nullptr);
    glCompileShader(shader.name());
    program_ = gl::Program(glCreateProgram());
    glAttachShader(program_.name(), shader.name());
    glLinkProgram(program_.name());
    GLint linked = GL_FALSE;
    glGetProgramiv(program_.name(), GL_LINK_STATUS, &linked);
    char log[4096] = "";
    glGetShaderInfoLog(shader.name(), sizeof(log), nullptr, log);
    if (!linked) throw std::runtime_error(std::string("the shader does not compile: ") + log);
  }

  std::vector<vec4> operator()(const NodeCall& call, const std::vector<vec4>& points) const {
    const gl::Buffer from("points", points);
    std::vector<vec4> values(points.size());
    const gl::Buffer to("values", values);
    glUseProgram(program_.name());
    glUniform1i(0, call.function);
    glUniform1fv(1, kParameters, call.parameters);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, from.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, to.name());
    glDispatchCompute(static_cast<GLuint>((points.size() + 63) / 64), 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(to.name(), 0, static_cast<GLsizeiptr>(points.size() * sizeof(vec4)),
                            values.data());
    gl::check_errors("computing nodes' values");
    return values;
  }

 private:
  gl::Program program_;
};

TEST(NodeMaths, ShadersComputeTheSame) {
  std::unique_ptr<gl::Context> context;
  try {
    context = std::make_unique<gl::Context>();
  } catch (const Error& error) {
    GTEST_SKIP() << "No OpenGL here: " << error.what();
  }
  context->run([] {
    const ShaderMaths shader;
    const std::vector<vec4> points = random_points(1000);
    float worst = 0.0f;
    for (const std::string& line : calls()) {
      NodeCall call = parse_call(line).value();
      const std::vector<vec4> computed = shader(call, points);
      float range = 1.0f;
      std::vector<float> errors;
      for (size_t i = 0; i < points.size(); ++i) {
        const vec4 expected = call(points[i]);
        const vec4 away = glm::abs(computed[i] - expected);
        range = std::max(range, glm::length(expected));
        errors.push_back(std::max(std::max(away.x, away.y), std::max(away.z, away.w)));
      }
      // The edge of a cell may lie on either side of a point: one in a thousand.
      std::nth_element(errors.begin(), errors.end() - 2, errors.end());
      worst = std::max(worst, errors[errors.size() - 2] / range);
      EXPECT_LT(errors[errors.size() - 2], 1e-4f * range) << line;
    }
    std::cout << "largest difference of the range: " << worst << '\n';
  });
}

}  // namespace
}  // namespace kestrel::nodes
