// SPDX-License-Identifier: GPL-3.0-or-later
// Node programs: their table, and their arithmetic by known values.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "shading/node_maths.h"
#include "shading/node_table.h"

namespace kestrel {
namespace {

using nodes::node_math;

uint32_t op_named(std::string_view name) {
  const auto table = node_table();
  for (uint32_t i = 0; i < table.size(); ++i) {
    if (table[i].name == name) return i;
  }
  ADD_FAILURE() << "no op " << name;
  return 0;
}

uint32_t mode_named(std::string_view op, std::initializer_list<std::string_view> values) {
  const NodeOp& entry = node_table()[op_named(op)];
  uint32_t mode = 0, digit = 1, place = 0;
  for (const std::string_view value : values) {
    const auto& names = entry.modes.at(place++);
    const auto found = std::find(names.begin(), names.end(), value);
    EXPECT_NE(found, names.end()) << op << " has no mode " << value;
    mode += digit * static_cast<uint32_t>(found - names.begin());
    digit *= static_cast<uint32_t>(names.size());
  }
  return mode;
}

TEST(NodeTable, NumbersAreThoseOfTheShaders) {
  const std::map<std::string_view, uint32_t> expected = {
      {"input", nodes::kNodeInput},
      {"attribute", nodes::kNodeAttribute},
      {"image", nodes::kNodeImage},
      {"component", nodes::kNodeComponent},
      {"scalar", nodes::kNodeScalar},
      {"combine", nodes::kNodeCombine},
      {"color_space", nodes::kNodeColorSpace},
      {"math", nodes::kNodeMath},
      {"vector_math", nodes::kNodeVectorMath},
      {"mix", nodes::kNodeMix},
      {"mix_color", nodes::kNodeMixColor},
      {"table", nodes::kNodeTable},
      {"hue_saturation", nodes::kNodeHueSaturation},
      {"bright_contrast", nodes::kNodeBrightContrast},
      {"gamma", nodes::kNodeGamma},
      {"blackbody", nodes::kNodeBlackbody},
      {"wavelength", nodes::kNodeWavelength},
      {"mapping", nodes::kNodeMapping},
      {"vector_rotate", nodes::kNodeVectorRotate},
      {"vector_transform", nodes::kNodeVectorTransform},
      {"normal_map", nodes::kNodeNormalMap},
      {"bump", nodes::kNodeBump},
      {"fresnel", nodes::kNodeFresnel},
      {"layer_weight", nodes::kNodeLayerWeight},
      {"checker", nodes::kNodeChecker},
      {"gradient", nodes::kNodeGradient},
      {"magic", nodes::kNodeMagic},
      {"wave", nodes::kNodeWave},
      {"brick", nodes::kNodeBrick},
      {"white_noise", nodes::kNodeWhiteNoise},
      {"noise", nodes::kNodeNoise},
      {"musgrave", nodes::kNodeMusgrave},
      {"voronoi", nodes::kNodeVoronoi}};
  ASSERT_EQ(node_table().size(), expected.size());
  for (const auto& [name, number] : expected) EXPECT_EQ(op_named(name), number) << name;
  EXPECT_EQ(mode_named("input", {"VIEW_DISTANCE"}), nodes::kInputViewDistance);
  EXPECT_EQ(mode_named("input", {"BACKFACING"}), nodes::kInputBackfacing);
  const auto json = nlohmann::json::parse(node_table_json());
  EXPECT_EQ(json["ops"].size(), expected.size());
  EXPECT_EQ(json["outputs"].size(), size_t{nodes::kNodeOutputs});
}

TEST(NodeMath, OperationsGiveWhatBlenderDefines) {
  const float nan = std::nanf("");
  struct Case {
    const char* operation;
    float a, b, c, expected;
  };
  const Case cases[] = {
      {"ADD", 2, 3, 0, 5},
      {"SUBTRACT", 2, 3, 0, -1},
      {"MULTIPLY", 2, 3, 0, 6},
      {"DIVIDE", 3, 2, 0, 1.5f},
      {"DIVIDE", 3, 0, 0, 0},
      {"MULTIPLY_ADD", 2, 3, 4, 10},
      {"POWER", 2, 3, 0, 8},
      {"POWER", -2, 3, 0, -8},
      {"POWER", -2, 2, 0, 4},
      {"POWER", -2, 0.5f, 0, 0},
      {"POWER", 0, 0, 0, 1},
      {"LOGARITHM", 8, 2, 0, 3},
      {"LOGARITHM", -8, 2, 0, 0},
      {"SQRT", 9, 0, 0, 3},
      {"SQRT", -9, 0, 0, 0},
      {"INVERSE_SQRT", 4, 0, 0, 0.5f},
      {"ABSOLUTE", -4, 0, 0, 4},
      {"EXPONENT", 1, 0, 0, 2.7182818f},
      {"MINIMUM", 1, 2, 0, 1},
      {"MAXIMUM", 1, 2, 0, 2},
      {"LESS_THAN", 1, 2, 0, 1},
      {"GREATER_THAN", 1, 2, 0, 0},
      {"SIGN", -3, 0, 0, -1},
      {"COMPARE", 1, 1.1f, 0.2f, 1},
      {"COMPARE", 1, 1.3f, 0.2f, 0},
      {"SMOOTH_MIN", 1, 2, 0, 1},
      {"SMOOTH_MIN", 1, 1, 0.6f, 0.9f},
      {"SMOOTH_MAX", 1, 1, 0.6f, 1.1f},
      {"ROUND", 1.5f, 0, 0, 2},
      {"ROUND", -1.5f, 0, 0, -1},
      {"FLOOR", -1.5f, 0, 0, -2},
      {"CEIL", -1.5f, 0, 0, -1},
      {"TRUNC", -1.5f, 0, 0, -1},
      {"FRACT", -1.25f, 0, 0, 0.75f},
      {"MODULO", -5, 3, 0, -2},
      {"FLOORED_MODULO", -5, 3, 0, 1},
      {"MODULO", 5, 0, 0, 0},
      {"WRAP", 7, 5, 1, 3},
      {"SNAP", 7, 2, 0, 6},
      {"PINGPONG", 2.5f, 1, 0, 0.5f},
      {"SINE", 1, 0, 0, 0.84147098f},
      {"COSINE", 1, 0, 0, 0.54030231f},
      {"TANGENT", 1, 0, 0, 1.55740772f},
      {"ARCSINE", 0.5f, 0, 0, 0.52359878f},
      {"ARCSINE", 2, 0, 0, 0.5f * kPi},
      {"ARCCOSINE", 0.5f, 0, 0, 1.04719755f},
      {"ARCTANGENT", 1, 0, 0, 0.78539816f},
      {"ARCTAN2", 1, -1, 0, 2.35619449f},
      {"SINH", 1, 0, 0, 1.17520119f},
      {"COSH", 1, 0, 0, 1.54308063f},
      {"TANH", 1, 0, 0, 0.76159416f},
      {"RADIANS", 180, 0, 0, kPi},
      {"DEGREES", kPi, 0, 0, 180},
  };
  for (const auto& [operation, a, b, c, expected] : cases) {
    const float found = node_math(mode_named("math", {operation}), a, b, c);
    EXPECT_NEAR(found, expected, 1e-5f * std::max(1.0f, std::abs(expected)))
        << operation << " " << a << " " << b << " " << c;
  }
  for (uint32_t mode = 0; mode < 41; ++mode) {
    EXPECT_NE(node_math(mode, 0.3f, 0.7f, 0.2f), nan);
  }
}

TEST(NodeMath, EulerAnglesTurnXFirst) {
  const vec3 v = nodes::node_mapping(0, vec3(0, 1, 0), vec3(10, 0, 0),
                                     vec3(0.5f * kPi, 0, 0.5f * kPi), vec3(2.0f));
  EXPECT_NEAR(v.x, 10.0f, 1e-5f);  // 2 Y to 2 Z by X, which Z leaves alone
  EXPECT_NEAR(v.y, 0.0f, 1e-5f);
  EXPECT_NEAR(v.z, 2.0f, 1e-5f);
  const vec3 there(0.3f, -0.2f, 0.9f), turn(0.3f, 1.0f, -2.0f), place(1, 2, 3), size(2, 3, 0.5f);
  const vec3 back =
      nodes::node_mapping(1, nodes::node_mapping(0, there, place, turn, size), place, turn, size);
  EXPECT_NEAR(glm::length(back - there), 0.0f, 1e-5f);
}

TEST(NodeMath, FresnelOfGlass) {
  EXPECT_NEAR(nodes::node_fresnel(1.0f, 1.5f), 0.04f, 1e-6f);
  EXPECT_NEAR(nodes::node_fresnel(0.0f, 1.5f), 1.0f, 1e-6f);
  EXPECT_EQ(nodes::node_fresnel(0.3f, 1.0f / 1.5f), 1.0f);  // beyond the critical angle
}

}  // namespace
}  // namespace kestrel
