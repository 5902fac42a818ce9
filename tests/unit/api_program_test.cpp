// SPDX-License-Identifier: GPL-3.0-or-later
// What node programs make of surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "kestrel/kestrel.h"
#include "scene/node_types.h"

namespace kestrel {
namespace {

const nlohmann::json& op_named(std::string_view name) {
  static const nlohmann::json table = nlohmann::json::parse(kestrelGetNodeTable());
  for (const nlohmann::json& op : table["ops"]) {
    if (op["name"] == name) return op;
  }
  throw std::runtime_error("no such op");
}

uint32_t number_of(std::string_view name) {
  static const nlohmann::json table = nlohmann::json::parse(kestrelGetNodeTable());
  const auto& ops = table["ops"];
  const auto found =
      std::find_if(ops.begin(), ops.end(), [&](const auto& op) { return op["name"] == name; });
  return static_cast<uint32_t>(found - ops.begin());
}

uint32_t mode_named(std::string_view op, std::initializer_list<std::string_view> values) {
  uint32_t mode = 0, digit = 1;
  size_t place = 0;
  for (const std::string_view value : values) {
    const auto names = op_named(op)["modes"].at(place++).get<std::vector<std::string>>();
    const auto found = std::find(names.begin(), names.end(), value);
    EXPECT_NE(found, names.end()) << op << " has no mode " << value;
    mode += digit * static_cast<uint32_t>(found - names.begin());
    digit *= static_cast<uint32_t>(names.size());
  }
  return mode;
}

constexpr float kPositions[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
constexpr uint32_t kTriangles[] = {0, 1, 2, 0, 2, 3};
constexpr float kUvs[] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1};
constexpr float kIdentity[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

/// Builds a program by names.
struct Builder {
  std::vector<KestrelNodeInstruction> steps;
  std::vector<float> constants;
  std::vector<uint64_t> attributes;
  KestrelNodeProgram program{};

  Builder() { std::fill_n(program.outputs, KESTREL_NODE_OUTPUTS, KESTREL_NODE_UNSET); }
  int constant(float x, float y, float z, float w = 1) {
    constants.insert(constants.end(), {x, y, z, w});
    return -static_cast<int>(constants.size() / 4);
  }
  int constant(float x) { return constant(x, x, x); }
  int add(std::string_view op, std::initializer_list<std::string_view> modes,
          std::initializer_list<int> operands, int data = 0) {
    KestrelNodeInstruction step{};
    step.op = number_of(op);
    step.mode = mode_named(op, modes);
    step.result = static_cast<int>(steps.size());
    step.data = data;
    std::copy(operands.begin(), operands.end(), step.operands);
    steps.push_back(step);
    return step.result;
  }
  const KestrelNodeProgram* finish() {
    program.instructions = steps.data();
    program.instruction_count = steps.size();
    program.constants = constants.data();
    program.constant_count = constants.size() / 4;
    program.attributes = attributes.data();
    program.attribute_count = attributes.size();
    return &program;
  }
};

/// A square from -1 to 1 in the plane z = 0, seen from above by an orthographic camera.
class NodeProgramTest : public testing::Test {
 protected:
  void SetUp() override {
    device = kestrelNewDevice();
    scene = kestrelNewScene(device);
    renderer = kestrelNewRenderer(scene);
    KestrelMesh mesh = {.name = "square",
                        .vertex_count = 4,
                        .positions = kPositions,
                        .triangle_count = 2,
                        .triangles = kTriangles};
    mesh.corner_uvs = kUvs;
    ok(kestrelSetMesh(scene, 1, &mesh));
    KestrelCamera camera = {.projection = KESTREL_ORTHOGRAPHIC,
                            .world_from_camera = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 5},
                            .left = -1,
                            .right = 1,
                            .bottom = -1,
                            .top = 1,
                            .near_clip = 0.1f,
                            .far_clip = 10};
    ok(kestrelSetCamera(scene, &camera));
    for (const auto& [name, value] : std::map<std::string, std::string>{
             {"samples", "1"}, {"pixel_filter", "box"}, {"primary", "rays"}}) {
      ok(kestrelSetSetting(scene, name.c_str(), value.c_str()));
    }
    put_object(1, 1, kIdentity);
  }
  void TearDown() override {
    kestrelReleaseRenderer(renderer);
    kestrelReleaseScene(scene);
    kestrelReleaseDevice(device);
  }
  static void ok(KestrelError code) {
    const char* text = nullptr;
    if (code != KESTREL_ERROR_NONE) kestrelGetError(&text);
    ASSERT_EQ(code, KESTREL_ERROR_NONE) << (text ? text : "");
  }
  void put_object(uint64_t id, uint64_t material, const float* matrix) {
    KestrelObject object = {
        .name = "object", .mesh = 1, .materials = &material, .material_count = 1};
    std::memcpy(object.world_from_object, matrix, sizeof(kIdentity));
    ok(kestrelSetObject(scene, id, &object));
  }
  KestrelError put_program(Builder& builder, int32_t alpha_mode = KESTREL_ALPHA_OPAQUE,
                           uint64_t id = 1) {
    KestrelMaterial material;
    kestrelDefaultMaterial(&material);
    material.name = "programmed";
    material.alpha_mode = alpha_mode;
    material.program = builder.finish();
    return kestrelSetMaterial(scene, id, &material);
  }
  /// RGBA of 4 x 4 pixels, the first at the lower left.
  std::vector<vec4> render() {
    ok(kestrelCommitScene(scene));
    ok(kestrelRender(renderer, 4, 4, nullptr, nullptr));
    std::vector<vec4> pixels(16);
    ok(kestrelReadPass(renderer, "Combined", &pixels[0].x, 64));
    return pixels;
  }

  KestrelDevice device = nullptr;
  KestrelScene scene = nullptr;
  KestrelRenderer renderer = nullptr;
};

TEST_F(NodeProgramTest, ComputesFromPositionAndUv) {
  Builder b;
  b.attributes = {0};
  const int uv = b.add("attribute", {"HERE"}, {}, 0);
  const int position = b.add("input", {"POSITION"}, {}, 0);
  const int x = b.add("component", {"X"}, {position});
  const int doubled = b.add("math", {"MULTIPLY_ADD", "NO"}, {x, b.constant(2), b.constant(3)});
  b.program.outputs[nodes::kNodeEmission] =
      b.add("combine", {}, {doubled, b.add("component", {"Y"}, {uv}), b.constant(0.25f)});
  b.program.outputs[nodes::kNodeDiffuse] = b.constant(0);
  ok(put_program(b));
  const std::vector<vec4> pixels = render();
  for (int i = 0; i < 16; ++i) {
    const float px = -0.75f + 0.5f * static_cast<float>(i % 4);
    const float v = 0.125f + 0.25f * static_cast<float>(i / 4);
    EXPECT_NEAR(pixels[i].x, 2 * px + 3, 1e-5f);
    EXPECT_NEAR(pixels[i].y, v, 1e-5f);
    EXPECT_NEAR(pixels[i].z, 0.25f, 1e-6f);
  }
}

TEST_F(NodeProgramTest, AMirrorReflectsByColour) {
  KestrelWorld world = {.color = {1, 2, 4}};
  ok(kestrelSetWorld(scene, &world));
  Builder b;
  b.program.outputs[nodes::kNodeDiffuse] = b.constant(0);
  b.program.outputs[nodes::kNodeReflection] = b.constant(0.5f, 0.25f, 0.125f);
  ok(put_program(b));
  for (const vec4& p : render()) {
    EXPECT_NEAR(p.x, 0.5f, 1e-5f);
    EXPECT_NEAR(p.y, 0.5f, 1e-5f);
    EXPECT_NEAR(p.z, 0.5f, 1e-5f);
  }
}

TEST_F(NodeProgramTest, SharesAddUpToTheirSum) {
  KestrelWorld world = {.color = {1, 1, 1}};
  ok(kestrelSetWorld(scene, &world));
  Builder b;
  b.program.outputs[nodes::kNodeEmission] = b.constant(0.1f);
  b.program.outputs[nodes::kNodeDiffuse] = b.constant(0);
  b.program.outputs[nodes::kNodeReflection] = b.constant(0.3f, 0.2f, 0.1f);
  b.program.outputs[nodes::kNodeTransmission] = b.constant(0.4f, 0.5f, 0.2f);
  b.program.outputs[nodes::kNodeIor] = b.constant(1);
  ok(put_program(b));
  for (const vec4& p : render()) {
    EXPECT_NEAR(p.x, 0.8f, 1e-5f);
    EXPECT_NEAR(p.y, 0.8f, 1e-5f);
    EXPECT_NEAR(p.z, 0.4f, 1e-5f);
  }
}

TEST_F(NodeProgramTest, AlphaCutsHolesAndBlends) {
  KestrelWorld world = {.color = {0, 1, 0}};
  ok(kestrelSetWorld(scene, &world));
  Builder b;
  const int position = b.add("input", {"POSITION"}, {}, 0);
  const int right =
      b.add("math", {"GREATER_THAN", "NO"}, {b.add("component", {"X"}, {position}), b.constant(0)});
  b.program.outputs[nodes::kNodeAlpha] =
      b.add("math", {"MULTIPLY_ADD", "NO"}, {right, b.constant(0.5f), b.constant(0.25f)});
  b.program.outputs[nodes::kNodeEmission] = b.constant(1, 0, 0);
  b.program.outputs[nodes::kNodeDiffuse] = b.constant(0);
  ok(put_program(b, KESTREL_ALPHA_BLEND));
  std::vector<vec4> pixels = render();
  for (int i = 0; i < 16; ++i) {
    const float alpha = i % 4 < 2 ? 0.25f : 0.75f;
    EXPECT_NEAR(pixels[i].x, alpha, 1e-5f);
    EXPECT_NEAR(pixels[i].y, 1 - alpha, 1e-5f);
  }
  ok(put_program(b, KESTREL_ALPHA_MASK));
  pixels = render();
  for (int i = 0; i < 16; ++i) {
    EXPECT_EQ(pixels[i].x, i % 4 < 2 ? 0.0f : 1.0f);
    EXPECT_EQ(pixels[i].y, i % 4 < 2 ? 1.0f : 0.0f);
  }
}

TEST_F(NodeProgramTest, ShadowsAreWhatTheProgramLetsThrough) {
  const float above[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 7};  // behind the camera
  put_object(2, 2, above);
  KestrelLight light;
  kestrelDefaultLight(&light);
  light.type = KESTREL_LIGHT_DIRECTIONAL;
  ok(kestrelSetLight(scene, 1, &light));
  Builder floor;
  floor.program.outputs[nodes::kNodeDiffuse] = floor.constant(1);
  ok(put_program(floor));
  Builder b;
  b.program.outputs[nodes::kNodeTransmission] = b.constant(0.5f, 0.25f, 0);
  b.program.outputs[nodes::kNodeDiffuse] = b.constant(0);
  ok(put_program(b, KESTREL_ALPHA_OPAQUE, 2));
  for (const vec4& p : render()) {
    EXPECT_NEAR(p.x, 0.5f, 1e-5f);
    EXPECT_NEAR(p.y, 0.25f, 1e-5f);
    EXPECT_NEAR(p.z, 0, 1e-5f);
  }
}

TEST_F(NodeProgramTest, BumpBendsTheNormalTowardsTheSlope) {
  Builder b;
  b.attributes = {0};
  const auto height = [&](const char* where) {
    return b.add("component", {"X"}, {b.add("attribute", {where}, {}, 0)});
  };
  const int here = height("HERE"), x = height("BESIDE_X"), y = height("BESIDE_Y");
  const int normal = b.add("input", {"NORMAL"}, {}, 0);
  const int bent = b.add("bump", {"NO"}, {here, x, y, normal, b.constant(1), b.constant(1)});
  b.program.outputs[nodes::kNodeNormal] = bent;
  b.program.outputs[nodes::kNodeEmission] =
      b.add("vector_math", {"ABSOLUTE"}, {bent, bent, bent, bent});
  b.program.outputs[nodes::kNodeDiffuse] = b.constant(0);
  ok(put_program(b));
  // The height is u = (x + 1) / 2, so the normal is that of z = x / 2.
  const float length = std::sqrt(1.25f);
  for (const vec4& p : render()) {
    EXPECT_NEAR(p.x, 0.5f / length, 2e-3f);
    EXPECT_NEAR(p.y, 0.0f, 2e-3f);
    EXPECT_NEAR(p.z, 1.0f / length, 2e-3f);
  }
}

TEST_F(NodeProgramTest, BadProgramsAreErrors) {
  const auto refuses = [&](Builder& b, const char* part) {
    EXPECT_EQ(put_program(b), KESTREL_ERROR_INVALID_ARGUMENT);
    const char* text = nullptr;
    kestrelGetError(&text);
    EXPECT_NE(std::string(text).find(part), std::string::npos) << text;
    EXPECT_NE(std::string(text).find("programmed"), std::string::npos) << text;
  };
  Builder op;
  op.add("gamma", {}, {0, 0});
  op.steps[0].op = 1000;
  refuses(op, "op 1000");
  Builder mode;
  mode.add("math", {"ADD", "NO"}, {0, 0, 0});
  mode.steps[0].mode = 82;
  refuses(mode, "mode 82");
  Builder constant;
  constant.add("gamma", {}, {-1, 0});
  refuses(constant, "constant 0");
  Builder result;
  result.add("gamma", {}, {0, 0});
  result.steps[0].result = nodes::kNodeRegisters;
  refuses(result, "register");
  Builder texture;
  texture.add("image", {"FLAT"}, {0, 0}, 0);
  refuses(texture, "data 0");
  Builder table;
  table.add("table", {"LINEAR"}, {0}, 0);
  table.constant(1);
  refuses(table, "data 0");
  Builder output;
  output.program.outputs[0] = 99;
  refuses(output, "emission");
  Builder nan;
  nan.constant(std::nanf(""));
  refuses(nan, "finite");
}

}  // namespace
}  // namespace kestrel
