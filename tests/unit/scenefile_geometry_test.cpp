// SPDX-License-Identifier: GPL-3.0-or-later
// What meshes, objects and imported models of a scene file mean.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "scenefile_fixture.h"

namespace kestrel::cli {
namespace {

// ---- meshes ------------------------------------------------------------------------------------

/// The volume that a closed mesh encloses; positive where its triangles face outwards.
double volume_of(const MeshDescription& mesh) {
  double sum = 0.0;
  for (const uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    sum += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return sum;
}

TEST(SceneMeshes, PrimitivesHaveBlendersSizesAndFaceOutwards) {
  const auto scene = read(R"("meshes": [{"name": "p", "primitive": "plane"},
    {"name": "c", "primitive": "cube"},
    {"name": "s", "primitive": "sphere", "slices": 64, "stacks": 32}])");
  const auto& plane = scene.meshes[0];
  ASSERT_EQ(plane.triangles.size(), 2u);
  const uvec3 t = plane.triangles[0];
  const vec3 normal = glm::cross(plane.positions[t.y] - plane.positions[t.x],
                                 plane.positions[t.z] - plane.positions[t.x]);
  EXPECT_GT(normal.z, 0.0f);
  EXPECT_EQ(scene.meshes[1].triangles.size(), 12u);
  EXPECT_NEAR(volume_of(scene.meshes[1]), 8.0, 1e-6);
  const auto& sphere = scene.meshes[2];
  EXPECT_EQ(sphere.triangles.size(), 2u * 64 * 31);
  EXPECT_EQ(sphere.positions.size(), 2u + 64 * 31);
  EXPECT_NEAR(volume_of(sphere), 4.0 / 3.0 * M_PI, 0.02);
  for (size_t c = 0; c < sphere.triangles.size() * 3; ++c) {
    expect_near(sphere.corner_normals[c], sphere.positions[sphere.triangles[c / 3][c % 3]]);
  }
}

TEST(SceneMeshes, SphereFacetsShowWhereItIsNotSmooth) {
  const auto scene = read(R"("meshes": [{"name": "s", "primitive": "sphere", "smooth": false}])");
  EXPECT_TRUE(scene.meshes[0].corner_normals.empty());
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u * 32 * 15);
}

TEST(SceneMeshes, InlineGeometryIsTakenAsItIs) {
  const auto scene = read(R"("meshes": [{"name": "t", "positions": [0,0,0, 1,0,0, 0,1,0, 0,0,1],
    "triangles": [0,1,2, 0,2,3], "uvs": [0,0, 1,0, 0,1, 0,0, 0.5,0.5, 1,1],
    "normals": [0,0,1, 0,0,1, 0,0,1, 1,0,0, 1,0,0, 1,0,0], "slots": [0, 1]}])");
  const MeshDescription& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.triangles[1], uvec3(0, 2, 3));
  EXPECT_EQ(mesh.corner_uvs[4], vec2(0.5f));
  EXPECT_EQ(mesh.corner_normals[3], vec3(1, 0, 0));
  EXPECT_EQ(mesh.triangle_slots, (std::vector<uint32_t>{0, 1}));
}

constexpr const char* kTwoMaterialObj = R"(mtllib two.mtl
v 0 0 0
v 2 0 0
v 2 0 2
v 0 0 2
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
usemtl red
f 1/1 2/2 3/3 4/1
usemtl leaf
f 1/1 2/2 5/3
)";
constexpr const char* kTwoMaterialMtl =
    "newmtl red\nKd 0.8 0.1 0.1\nnewmtl leaf\nKd 1 1 1\nmap_Kd leaf.png\nmap_d leaf.png\n";

TEST_F(SceneFiles, ModelFileBecomesOneMeshWithASlotForEachMaterial) {
  write("models/two.obj", kTwoMaterialObj);
  write("models/two.mtl", kTwoMaterialMtl);
  const auto scene = read(R"("meshes": [{"name": "m", "file": "models/two.obj"}])", scene_path());
  const MeshDescription& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.corner_uvs.size(), 9u);
  EXPECT_TRUE(mesh.corner_normals.empty()) << "the file has none: flat";
  ASSERT_EQ(mesh.triangle_slots.size(), 3u);
  EXPECT_EQ(mesh.triangle_slots[0], mesh.triangle_slots[1]);
  EXPECT_NE(mesh.triangle_slots[0], mesh.triangle_slots[2]);
}

TEST_F(SceneFiles, YUpModelsAreStoodUpright) {
  write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 5 0\nf 1 2 3\n");
  const auto scene = read(R"("meshes": [{"name": "y", "file": "a.obj", "up": "y"},
                                        {"name": "z", "file": "a.obj"}])",
                          scene_path());
  const auto highest = [](const MeshDescription& mesh) {
    float z = -INFINITY;
    for (const vec3& p : mesh.positions) z = std::max(z, p.z);
    return z;
  };
  EXPECT_NEAR(highest(scene.meshes[0]), 5.0f, 1e-5f);
  EXPECT_NEAR(highest(scene.meshes[1]), 0.0f, 1e-5f);
}

template <typename T>
std::string big_endian(T value) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  return {bytes.rbegin(), bytes.rend()};
}

TEST_F(SceneFiles, PlyIsReadInAllItsFormats) {
  const std::string header =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const float corners[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, -1.5f}};
  std::string ascii, little, big;
  for (const auto& corner : corners) {
    for (const float v : corner) {
      ascii += fmt::format("{} ", v);
      little.append(reinterpret_cast<const char*>(&v), 4);
      big += big_endian(v);
    }
    ascii += "7\n";
    little += '\7';
    big += '\7';
  }
  ascii += "4 0 1 2 3\n";
  little += '\4';
  big += '\4';
  for (const int32_t i : {0, 1, 2, 3}) {
    little.append(reinterpret_cast<const char*>(&i), 4);
    big += big_endian(i);
  }
  write("a.ply", "ply\nformat ascii 1.0\ncomment made by hand\n" + header + ascii);
  write("l.ply", "ply\nformat binary_little_endian 1.0\n" + header + little);
  write("b.ply", "ply\r\nformat binary_big_endian 1.0\n" + header + big);
  for (const char* name : {"a.ply", "l.ply", "b.ply"}) {
    const auto scene =
        read(fmt::format(R"("meshes": [{{"name": "m", "file": "{}"}}])", name), scene_path());
    const MeshDescription& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}})) << name;
    ASSERT_EQ(mesh.positions.size(), 4u) << name;
    EXPECT_EQ(mesh.positions[3], vec3(0, 3, -1.5f)) << name;
  }
}

TEST_F(SceneFiles, NormalsCanBeSmoothedAcrossAnEdge) {
  // A roof of two faces: smoothed, the ridge's normals point straight up.
  write("roof.obj", "v -1 0 0\nv 0 0 1\nv 0 2 1\nv 1 0 0\nf 1 2 3\nf 2 4 3\n");
  const auto scene =
      read(R"("meshes": [{"name": "r", "file": "roof.obj", "normals": "smooth"}])", scene_path());
  const MeshDescription& mesh = scene.meshes[0];
  int ridge_corners = 0;
  for (size_t c = 0; c < mesh.corner_normals.size(); ++c) {
    if (mesh.positions[mesh.triangles[c / 3][c % 3]] != vec3(0, 0, 1)) continue;
    ++ridge_corners;
    EXPECT_NEAR(std::abs(mesh.corner_normals[c].z), 1.0f, 0.2f);
    EXPECT_EQ(mesh.corner_normals[c], mesh.corner_normals[1]);
  }
  EXPECT_EQ(ridge_corners, 2);
}

/// A closed sphere as OBJ text, without normals.
std::string sphere_obj(int slices, int stacks) {
  const auto scene = read(fmt::format(
      R"("meshes": [{{"name": "s", "primitive": "sphere", "slices": {}, "stacks": {}}}])", slices,
      stacks));
  std::string text;
  for (const vec3& p : scene.meshes[0].positions)
    text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (const uvec3& t : scene.meshes[0].triangles) {
    text += fmt::format("f {} {} {}\n", t.x + 1, t.y + 1, t.z + 1);
  }
  return text;
}

TEST_F(SceneFiles, ModelsCanBeSimplifiedToANumberOfTriangles) {
  write("ball.obj", sphere_obj(64, 32));
  const auto scene = read(
      R"("meshes": [{"name": "b", "file": "ball.obj", "normals": "smooth", "triangles": 500}])",
      scene_path());
  const MeshDescription& mesh = scene.meshes[0];
  EXPECT_LE(mesh.triangles.size(), 500u);
  EXPECT_GE(mesh.triangles.size(), 498u);
  EXPECT_EQ(mesh.corner_normals.size(), mesh.triangles.size() * 3);
  EXPECT_NEAR(volume_of(mesh), 4.0 / 3.0 * M_PI, 0.15) << "the shape stays";
  // Still closed: each directed edge has its opposite exactly once.
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

// ---- objects -----------------------------------------------------------------------------------

constexpr const char* kOneMesh = R"("materials": [{"name": "red"}, {"name": "blue"}],
  "meshes": [{"name": "cube", "primitive": "cube"}], )";

TEST(SceneObjects, ArePlacedByScaleThenRotationThenPosition) {
  const auto scene = read(std::string(kOneMesh) + R"("objects": [
    {"name": "A", "mesh": "cube", "material": "red", "position": [10, 0, 0], "rotation": [0, 0, 90],
     "scale": [2, 3, 4]},
    {"mesh": "cube", "materials": ["blue", null], "rotation": [90, 0, 90], "scale": 0.5},
    {"mesh": "cube", "matrix": [1,0,0, 0,1,0, 0,0,1, 4,5,6], "unit": "Group"}])");
  ASSERT_EQ(scene.objects.size(), 3u);
  expect_near(placed(scene.objects[0], {1, 0, 0}), {10, 2, 0});
  expect_near(placed(scene.objects[0], {0, 1, 0}), {7, 0, 0});
  EXPECT_EQ(scene.objects[0].materials, (std::vector<int>{0}));
  // XYZ order: first about X, which takes Y to Z; then about Z, which leaves it there.
  expect_near(placed(scene.objects[1], {0, 1, 0}), {0, 0, 0.5f});
  EXPECT_EQ(scene.objects[1].materials, (std::vector<int>{1, kNoIndex}));
  EXPECT_EQ(scene.objects[1].name, "Object 1");
  expect_near(placed(scene.objects[2], {1, 1, 1}), {5, 6, 7});
  EXPECT_EQ(scene.objects[2].unit, "Group");
}

TEST(SceneObjects, CarryTheHeuristicsSettings) {
  const auto scene = read(std::string(kOneMesh) + R"("objects": [{"mesh": "cube", "relevance": 4,
    "cost": 2.5, "shadows": "never", "reflections": "always", "refractions": "auto"}])");
  const std::map<std::string, std::string> settings(scene.objects[0].settings.begin(),
                                                    scene.objects[0].settings.end());
  EXPECT_EQ(settings, (std::map<std::string, std::string>{{"relevance", "4"},
                                                          {"cost", "2.5"},
                                                          {"shadows", "never"},
                                                          {"reflections", "always"},
                                                          {"refractions", "auto"}}));
}

TEST(SceneObjects, InstancesShareAMeshAndAUnit) {
  const auto scene = read(std::string(kOneMesh) + R"("objects": [{"name": "Row", "mesh": "cube",
    "scale": 0.5, "instances": [[1, 2, 3], [4, 5, 6, 90], [7, 8, 9, 0, 10],
                                [1,0,0, 0,1,0, 0,0,1, 0,0,20]]}])");
  ASSERT_EQ(scene.objects.size(), 4u);
  expect_near(placed(scene.objects[0], {1, 0, 0}), {1.5f, 2, 3});
  expect_near(placed(scene.objects[1], {1, 0, 0}), {4, 5.5f, 6});
  expect_near(placed(scene.objects[2], {1, 0, 0}), {12, 8, 9});
  expect_near(placed(scene.objects[3], {1, 0, 0}), {0.5f, 0, 20});
  for (const ObjectDescription& object : scene.objects) {
    EXPECT_EQ(object.name, "Row");
    EXPECT_EQ(object.mesh, 0);
  }
}

TEST_F(SceneFiles, ImportTakesMaterialsMasksAndUnits) {
  write("two.obj", kTwoMaterialObj);
  write("two.mtl", kTwoMaterialMtl);
  const auto scene = read(R"("materials": [{"name": "gold"}], "objects": [
    {"import": "two.obj", "name": "Bush", "up": "y", "relevance": 2, "position": [0, 0, 1],
     "units": [{"unit": "Leaves", "match": ["lea*"]}], "instances": [[0, 0, 0], [5, 0, 0]]},
    {"import": "two.obj", "up": "y", "name": "Other", "replace": [{"material": "red", "with": "gold"}]}])",
                          scene_path());
  ASSERT_EQ(scene.objects.size(), 6u) << "two materials, three placements";
  EXPECT_EQ(scene.meshes.size(), 2u) << "read once, shared by all";
  std::multiset<std::string> units;
  for (const ObjectDescription& object : scene.objects) units.insert(object.unit);
  EXPECT_EQ(units,
            (std::multiset<std::string>{"Bush", "Bush", "Leaves", "Leaves", "Other", "Other"}));
  const auto material_of = [&](size_t object) {
    return scene.materials[scene.objects[object].materials.at(0)];
  };
  EXPECT_EQ(material_of(0).name, "red");
  EXPECT_NEAR(material_of(0).values.diffuse[0], 0.8f, 1e-6f);
  EXPECT_NEAR(material_of(0).values.ambient[0], 0.8f, 1e-6f);
  EXPECT_EQ(material_of(0).values.specular[0], 0.0f);
  EXPECT_EQ(material_of(0).values.alpha_mode, KESTREL_ALPHA_OPAQUE);
  EXPECT_EQ(material_of(1).name, "leaf");
  EXPECT_EQ(material_of(1).values.alpha_mode, KESTREL_ALPHA_MASK);
  const auto id = material_of(1).values.diffuse_texture;
  ASSERT_NE(id, 0u);
  EXPECT_EQ(std::get<TextureFile>(scene.textures[id - 1].source).path,
            (folder_ / "leaf.png").string());
  EXPECT_EQ(material_of(4).name, "gold");
  EXPECT_EQ(material_of(5).name, "leaf");
  // The leaf's tip is at y = 1 of the file, which is up.
  float highest = 0.0f;
  for (const vec3& p : scene.meshes[scene.objects[3].mesh].positions) {
    highest = std::max(highest, placed(scene.objects[3], p).z);
    EXPECT_GE(placed(scene.objects[3], p).x, 5.0f);
  }
  EXPECT_NEAR(highest, 2.0f, 1e-5f);
}

TEST_F(SceneFiles, JoinedImportsAreOneObjectForEachUnit) {
  write("two.obj", kTwoMaterialObj);
  write("two.mtl", kTwoMaterialMtl);
  const std::string import = R"("objects": [{"import": "two.obj", "name": "Bush", "up": "y",
    "position": [0, 0, 1], "instances": [[0, 0, 0], [5, 0, 0, 90, 2]])";
  const auto apart = read(import + "}]", scene_path());
  const auto scene = read(import + R"(, "join": true}])", scene_path());
  ASSERT_EQ(scene.objects.size(), 1u);
  const ObjectDescription& bush = scene.objects[0];
  const MeshDescription& mesh = scene.meshes[bush.mesh];
  EXPECT_EQ(bush.name, "Bush");
  ASSERT_EQ(mesh.triangles.size(), 6u);
  ASSERT_EQ(bush.materials.size(), 2u);
  EXPECT_EQ(std::set<uint32_t>(mesh.triangle_slots.begin(), mesh.triangle_slots.end()),
            (std::set<uint32_t>{0, 1}));
  // Every triangle corner stands where the instances put it, with the same image coordinates.
  std::multiset<std::vector<float>> expected, found;
  const auto add = [](const SceneDescription& from, const ObjectDescription& object, auto& to) {
    const MeshDescription& m = from.meshes[object.mesh];
    for (size_t c = 0; c < m.triangles.size() * 3; ++c) {
      const vec3 p = placed(object, m.positions[m.triangles[c / 3][c % 3]]);
      const vec2 uv = m.corner_uvs[c];
      const uint32_t slot = m.triangle_slots.empty() ? 0 : m.triangle_slots[c / 3];
      std::vector<float> row = {p.x, p.y, p.z, uv.x, uv.y};
      for (float& v : row) v = std::round(v * 1e4f) / 1e4f + 0.0f;
      row.push_back(from.materials[object.materials[slot]].values.diffuse[1]);
      to.insert(row);
    }
  };
  for (const ObjectDescription& object : apart.objects) add(apart, object, expected);
  add(scene, bush, found);
  EXPECT_EQ(found, expected);
}

/// One triangle (a file buffer of floats) below two nodes, one of which is moved and scaled.
constexpr const char* kGltf =
    R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
 "nodes": [{"name": "Left", "mesh": 0}, {"name": "Right", "mesh": 0, "translation": [0, 3, 0], "scale": [2, 2, 2]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
 "materials": [{"name": "Leaf", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
   "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1], "baseColorTexture": {"index": 0}},
   "normalTexture": {"index": 0, "scale": 0.5}}],
 "textures": [{"source": 0, "sampler": 0}], "images": [{"uri": "leaf.png"}],
 "samplers": [{"wrapS": 33071, "wrapT": 33071, "magFilter": 9728}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "buffers": [{"uri": "tri.bin", "byteLength": 36}]})";

TEST_F(SceneFiles, GltfIsYUpAndKeepsItsMaterials) {
  const float triangle[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  write("tri.bin", std::string(reinterpret_cast<const char*>(triangle), sizeof triangle));
  write("tri.gltf", kGltf);
  const auto scene = read(R"("objects": [{"import": "tri.gltf"}])", scene_path());
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.objects[0].unit, "Left");
  EXPECT_EQ(scene.objects[1].unit, "Right");
  expect_near(placed(scene.objects[1], {0, 1, 0}), {0, 0, 5});
  const KestrelMaterial& m = scene.materials[scene.objects[0].materials[0]].values;
  expect_near({m.diffuse[0], m.diffuse[1], m.diffuse[2]}, {0.5f, 0.25f, 1});
  EXPECT_EQ(m.alpha_mode, KESTREL_ALPHA_MASK);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_EQ(m.normal_strength, 0.5f);
  const TextureDescription& base = scene.textures[m.diffuse_texture - 1];
  const TextureDescription& normal = scene.textures[m.normal_texture - 1];
  EXPECT_TRUE(base.srgb);
  EXPECT_FALSE(normal.srgb) << "the same image, used twice, is decoded as each use needs";
  EXPECT_TRUE(base.nearest);
  EXPECT_EQ(base.extension, KESTREL_EXTENSION_CLAMP);
}

}  // namespace
}  // namespace kestrel::cli
