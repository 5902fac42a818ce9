// SPDX-License-Identifier: GPL-3.0-or-later
// Broken scene files: each gives an error that names the file, the place and what was expected.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenefile_fixture.h"

namespace kestrel::cli {
namespace {

/// A whole file, or (where it starts with a quote) what follows the version and a camera.
struct Broken {
  const char* text;
  const char* pointer;  // "" for the file as a whole
  const char* message;  // a part of it
};

std::string whole(const std::string& text) {
  if (text.empty() || text[0] != '"') return text;
  return std::string(R"({"kestrel_scene": 1, )") + kCamera + ", " + text + "}";
}

void PrintTo(const Broken& broken, std::ostream* out) {
  *out << broken.text;
}

class BrokenScene : public testing::TestWithParam<Broken> {};

TEST_P(BrokenScene, IsAnErrorThatNamesFilePlaceAndReason) {
  const Broken& broken = GetParam();
  try {
    read_scene_text(whole(broken.text), "folder/broken.kscene");
    FAIL() << "was accepted";
  } catch (const SceneFileError& error) {
    const std::string what = error.what();
    EXPECT_EQ(error.pointer(), broken.pointer) << what;
    EXPECT_EQ(what.rfind("folder/broken.kscene: " + std::string(broken.pointer), 0), 0u) << what;
    EXPECT_NE(what.find(broken.message), std::string::npos) << what;
  }
}

const Broken kJson[] = {
    {"", "", "not valid JSON"},
    {"{", "", "not valid JSON"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 5)", "", "not valid JSON"},
    {R"({"kestrel_scene": 1,})", "", "line 1"},
    {"{\"kestrel_scene\": 1, \"camera\": {\"fov\": NaN}}", "", "not valid JSON"},
    {"{\"kestrel_scene\": 1, \"camera\": {\"fov\": 1e999}}", "", "number overflow"},
    {"{\"kestrel_scene\": 1, \"camera\": \"\xff\xfe\"}", "", "not valid JSON"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 5, "fov": 6}})", "", "'fov' stands twice"},
    {"[1, 2]", "", "expected an object, found an array"},
    {"null", "", "expected an object, found null"},
};
INSTANTIATE_TEST_SUITE_P(Json, BrokenScene, testing::ValuesIn(kJson));

const Broken kTop[] = {
    {"{}", "", "'kestrel_scene'"},
    {R"({"kestrel_scene": 2})", "/kestrel_scene", "version 2"},
    {R"({"kestrel_scene": "1"})", "/kestrel_scene", "expected a whole number"},
    {R"({"kestrel_scene": 1.5})", "/kestrel_scene", "expected a whole number"},
    {R"({"kestrel_scene": 1})", "/camera", "missing"},
    {R"("object": [])", "/object", "did you mean 'objects'?"},
    {R"("a/b~c": 1)", "/a~1b~0c", "unknown key"},
    {R"("objects": {})", "/objects", "expected an array, found an object"},
    {R"("objects": 7)", "/objects", "expected an array, found the number 7"},
    {R"("settings": {"budgetms": 5})", "/settings/budgetms", "did you mean 'budget_ms'?"},
    {R"("settings": {"budget_ms": -1})", "/settings/budget_ms", "from 0 to"},
    {R"("settings": {"samples": 2.5})", "/settings/samples", "a whole number from 1"},
    {R"("settings": {"primary": "gpu"})", "/settings/primary", "auto, raster, rays"},
    {R"("settings": {"ambient": [1, 1]})", "/settings/ambient", "3 numbers"},
    {R"("settings": {"validate_areas": 1})", "/settings/validate_areas", "true or false"},
    {R"("settings": {"relevance": 1})", "/settings/relevance", "unknown key"},
};
INSTANTIATE_TEST_SUITE_P(Top, BrokenScene, testing::ValuesIn(kTop));

const Broken kCameras[] = {
    {R"({"kestrel_scene": 1, "camera": {}})", "/camera", "'fov'"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "fov_x": 50}})", "/camera", "one of 'fov'"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 180}})", "/camera/fov", "from 0.01 to 179"},
    {R"({"kestrel_scene": 1, "camera": {"fov": "50"}})", "/camera/fov", "found a text"},
    {R"({"kestrel_scene": 1, "camera": {"type": "fisheye"}})", "/camera/type", "orthographic"},
    {R"({"kestrel_scene": 1, "camera": {"type": "orthographic"}})", "/camera/scale", "missing"},
    {R"({"kestrel_scene": 1, "camera": {"type": "orthographic", "scale": 1, "fov": 50}})",
     "/camera/fov", "'scale' instead"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "near": 0}})", "/camera/near", "from 1e-06"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "near": 5, "far": 2}})", "/camera",
     "below 'far'"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "position": [0, 1]}})", "/camera/position",
     "an array of 3 numbers, found 2"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "position": [0, 1e39, 0]}})",
     "/camera/position/1", "from -1e+09 to 1e+09"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "position": [0, null, 0]}})",
     "/camera/position/1", "found null"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "look_at": [0, 0, 0]}})", "/camera/look_at",
     "must differ"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "up": [0, 0, 0]}})", "/camera/up", "zero"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "matrix": [2,0,0, 0,2,0, 0,0,2, 0,0,0]}})",
     "/camera/matrix", "must not scale"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "matrix": [-1,0,0, 0,1,0, 0,0,1, 0,0,0]}})",
     "/camera/matrix", "mirror"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "path": []}})", "/camera/path", "2 keys"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "path": [
      {"time": 1, "position": [0,0,0], "look_at": [1,0,0]},
      {"time": 1, "position": [0,0,1], "look_at": [1,0,0]}]}})",
     "/camera/path/1/time", "after 1 s"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50, "window": [-1, 1, -1, 1]}})", "/camera",
     "both 'window' and 'fov'"},
    {R"({"kestrel_scene": 1, "camera": {"window": [-1, 1]}})", "/camera/window", "4 numbers"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50}, "camera_motion": [{"fov": 50}]})",
     "/camera_motion", "at least 2"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50},
      "camera_motion": [{"fov": 50}, {"type": "orthographic", "scale": 1}]})",
     "/camera_motion/1", "projection of 'camera'"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50}, "size": [640]})", "/size", "width and height"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50}, "size": [640, 0]})", "/size/1", "from 1"},
    {R"({"kestrel_scene": 1, "camera": {"fov": 50}, "buffer": {"bytes": 4, "hash": "0"}})",
     "/buffer", "keep both files together"},
};
INSTANTIATE_TEST_SUITE_P(Camera, BrokenScene, testing::ValuesIn(kCameras));

const Broken kLightsAndWorlds[] = {
    {R"("lights": [{}])", "/lights/0/type", "missing"},
    {R"("lights": [{"type": "area"}])", "/lights/0/type", "directional, point, spot"},
    {R"("lights": [{"type": "point", "direction": [0,0,1]}])", "/lights/0/direction",
     "unknown key"},
    {R"("lights": [{"type": "spot", "spot_angel": 5}])", "/lights/0/spot_angel", "'spot_angle'"},
    {R"("lights": [{"type": "spot", "spot_angle": 270}])", "/lights/0/spot_angle", "to 180"},
    {R"("lights": [{"type": "directional", "direction": [0,0,0]}])", "/lights/0/direction", "zero"},
    {R"("lights": [{"type": "point", "attenuation": [0,0,0]}])", "/lights/0/attenuation",
     "above 0"},
    {R"("lights": [{"type": "point", "color": [1, -1, 0]}])", "/lights/0/color/1", "from 0"},
    {R"("lights": [null])", "/lights/0", "found null"},
    {R"("world": {"image": "no/such.hdr"})", "/world/image", "does not exist"},
    {R"("world": {"image": "/"})", "/world/image", "not a readable file"},
    {R"("world": {"image": "${HOME}/x"})", "/world/image", "only ${KESTREL_SCENE_DATA}"},
    {R"("world": {"cube": ["a"]})", "/world/cube", "6 images"},
    {R"("world": {"flip": true})", "/world/flip", "'cube' only"},
    {R"("world": {"up": "x"})", "/world/up", "y, z"},
    {R"("world": {"textures": ["sky"]})", "/world/textures/0", "there is no texture 'sky'"},
    {R"("world": {"textures": []})", "/world/textures", "1 texture, or 6"},
    {R"("world": {"matrix": [1,0,0, 0,1,0, 0,0,1], "rotation": 5})", "/world", "both 'matrix'"},
};
INSTANTIATE_TEST_SUITE_P(LightsAndWorlds, BrokenScene, testing::ValuesIn(kLightsAndWorlds));

const Broken kSurfaces[] = {
    {R"("textures": [{"name": "t"}])", "/textures/0", "'file', 'checker' and 'pixels'"},
    {R"("textures": [{"name": "t", "file": "missing.png"}])", "/textures/0/file", "does not exist"},
    {R"("textures": [{"name": "t", "checker": {"squares": 1024, "texels": 64}}])",
     "/textures/0/checker", "8192"},
    {R"("textures": [{"checker": {}}])", "/textures/0/name", "missing"},
    {R"("textures": [{"name": "t", "pixels": {"width": 1, "height": 1}}])", "/textures/0/pixels",
     "either 'bytes' or 'floats'"},
    {R"("textures": [{"name": "t", "pixels": {"width": 1, "height": 2, "floats": [1, 1, 1, 1]}}])",
     "/textures/0/pixels/floats", "8 values"},
    {R"("materials": [{"name": "m", "uv_maps": [1, 2]}])", "/materials/0/uv_maps", "6 ids"},
    {R"("materials": [{"name": "m", "tangent_map": -1}])", "/materials/0/tangent_map",
     "a whole number"},
    {R"("materials": [{"name": "m"}, {"name": "m"}])", "/materials/1/name", "must differ"},
    {R"("materials": [{"name": ""}])", "/materials/0/name", "not empty"},
    {R"("materials": [{"name": "m", "difuse": [1,1,1]}])", "/materials/0/difuse", "'diffuse'"},
    {R"("materials": [{"name": "m", "diffuse": 1}])", "/materials/0/diffuse", "3 to 4 numbers"},
    {R"("materials": [{"name": "m", "diffuse": [1,1,1,2]}])", "/materials/0/diffuse", "0 to 1"},
    {R"("materials": [{"name": "m", "reflectivity": 1.5}])", "/materials/0/reflectivity", "0 to 1"},
    {R"("materials": [{"name": "m", "diffuse_texture": "t"}])", "/materials/0/diffuse_texture",
     "there is no texture 't'"},
    {R"("materials": [{"name": "m", "alpha_mode": "CLIP"}])", "/materials/0/alpha_mode", "mask"},
};
INSTANTIATE_TEST_SUITE_P(Surfaces, BrokenScene, testing::ValuesIn(kSurfaces));

const Broken kGeometry[] = {
    {R"("meshes": [{"name": "m"}])", "/meshes/0", "'primitive', 'file' and 'positions'"},
    {R"("meshes": [{"name": "m", "primitive": "torus"}])", "/meshes/0/primitive", "plane, cube"},
    {R"("meshes": [{"name": "m", "primitive": "sphere", "slices": 1000000000}])",
     "/meshes/0/slices", "from 3 to 4096"},
    {R"("meshes": [{"name": "m", "primitive": "sphere", "stacks": 1}])", "/meshes/0/stacks",
     "from 2"},
    {R"("meshes": [{"name": "m", "primitive": "cube", "slices": 4}])", "/meshes/0/slices",
     "unknown"},
    {R"("meshes": [{"name": "m", "file": "gone.obj"}])", "/meshes/0/file", "does not exist"},
    {R"("meshes": [{"name": "m", "file": ""}])", "/meshes/0/file", "not empty"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,3]}])",
     "/meshes/0/triangles/2", "from 0 to 2"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,-1]}])",
     "/meshes/0/triangles/2", "from 0 to 2"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,1.5]}])",
     "/meshes/0/triangles/2", "whole number"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0], "triangles": [0,1,1]}])",
     "/meshes/0/positions", "found 5"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2],
        "uvs": [0,0]}])",
     "/meshes/0/uvs", "6 numbers"},
    {R"("meshes": [{"name": "m", "positions": {"offset": 0, "count": 9}, "triangles": [0,1,2]}])",
     "/meshes/0/positions", "after the 0 bytes"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2],
        "attributes": [{"id": 1}]}])",
     "/meshes/0/attributes/0", "either 'uvs' or 'colors'"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2],
        "motion": [{"positions": [0,0,0, 1,0,0, 0,1,0]}]}])",
     "/meshes/0/motion", "at least 2"},
    {R"("meshes": [{"name": "m", "positions": [0,0,0, 1,0,0, 0,1,0], "triangles": [0,1,2],
        "motion": [{"positions": [0,0,0]}]}])",
     "/meshes/0/motion/0/positions", "9 numbers: 3 for each of the 3 vertices"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c", "motion": [[1,0,0, 0,1,0, 0,0,1, 0,0,0]]}])",
     "/objects/0/motion", "at least 2"},
    {R"("objects": [{}])", "/objects/0/mesh", "missing"},
    {R"("objects": [{"mesh": "Cuhe"}], "meshes": [{"name": "Cube", "primitive": "cube"}])",
     "/objects/0/mesh", "did you mean 'Cube'?"},
    {R"("objects": [{"mesh": 0}], "meshes": [{"name": "Cube", "primitive": "cube"}])",
     "/objects/0/mesh", "expected a text"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c"}, {"mesh": "c", "material": "gone"}])",
     "/objects/1/material", "there is no material"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c", "relevance": "high"}])",
     "/objects/0/relevance", "a number"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c", "shadows": "sometimes"}])",
     "/objects/0/shadows", "auto, always"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c", "matrix": [1], "scale": 2}])",
     "/objects/0", "both 'matrix'"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c", "instances": [[1, 2]]}])",
     "/objects/0/instances/0", "3 to 12"},
    {R"("meshes": [{"name": "c", "primitive": "cube"}],
        "objects": [{"mesh": "c", "instances": []}])",
     "/objects/0/instances", "at least one"},
    {R"("objects": [{"import": "gone.gltf"}])", "/objects/0/import", "does not exist"},
    {R"("objects": [{"import": "${KESTREL_SCENE_DATA}/gone.gltf"}])", "/objects/0/import",
     "set the environment variable KESTREL_SCENE_DATA"},
};
INSTANTIATE_TEST_SUITE_P(Geometry, BrokenScene, testing::ValuesIn(kGeometry));

TEST(BrokenSceneFile, DeepNestingIsRefused) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_THROW(read_scene_text(deep, "deep.kscene"), SceneFileError);
  EXPECT_THROW(read_scene_text("{\"camera\": " + deep + "}", "deep.kscene"), SceneFileError);
}

TEST(BrokenSceneFile, IsMissingOrAFolder) {
  EXPECT_THROW(read_scene_file("/nowhere/at/all.kscene"), SceneFileError);
  EXPECT_THROW(read_scene_file("/"), SceneFileError);
}

TEST(BrokenSceneFile, EveryTruncationIsRefused) {
  const std::string text = whole(R"("meshes": [{"name": "c", "primitive": "cube"}],
    "objects": [{"mesh": "c", "instances": [[1, 2, 3], [4, 5, 6, 90, 0.5]]}])");
  ASSERT_NO_THROW(read_scene_text(text, "whole.kscene"));
  for (size_t length = 0; length < text.size(); ++length) {
    EXPECT_THROW(read_scene_text(text.substr(0, length), "cut.kscene"), SceneFileError) << length;
  }
}

TEST_F(SceneFiles, BrokenModelFilesAreErrorsThatNameThem) {
  const std::vector<std::pair<const char*, std::string>> models = {
      {"empty.obj", ""},
      {"points.obj", "v 0 0 0\nv 1 1 1\nl 1 2\n"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"},
      {"text.gltf", "this is no glTF"},
      {"buffer.gltf",
       R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "gone.bin", "byteLength": 36}]})"},
      {"short.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"},
      {"count.ply",
       "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty "
       "float y\nproperty float z\nend_header\n1 2 3\n"},
      {"face.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
       "end_header\n1 2 3\n3 0 0 1\n"},
      {"list.ply",
       "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int "
       "vertex_indices\nend_header\n-3 0 0 0\n"},
      {"picture.png", "x"},
      {"noextension", "x"},
  };
  for (const auto& [name, text] : models) {
    write(name, text);
    for (const char* use :
         {R"("meshes": [{{"name": "m", "file": "{}"}}])", R"("objects": [{{"import": "{}"}}])"}) {
      try {
        read(fmt::format(fmt::runtime(use), name), scene_path());
        ADD_FAILURE() << name << " was accepted";
      } catch (const SceneFileError& error) {
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        EXPECT_NE(error.pointer(), "") << error.what();
      }
    }
  }
}

TEST_F(SceneFiles, UnknownPartsAndMaterialsOfAModelAreErrors) {
  write("a.obj", "o Left\nv 0 0 0\nv 1 0 0\nv 0 5 0\nf 1 2 3\n");
  const auto message = [&](const std::string& text) -> std::string {
    try {
      read(text, scene_path());
    } catch (const SceneFileError& error) {
      return error.what();
    }
    return "was accepted";
  };
  const std::string part =
      message(R"("meshes": [{"name": "m", "file": "a.obj", "part": "Right"}])");
  EXPECT_NE(part.find("/meshes/0/part"), std::string::npos) << part;
  EXPECT_NE(part.find("Left"), std::string::npos) << "lists what there is: " << part;
  const std::string material = message(R"("materials": [{"name": "gold"}], "objects": [
      {"import": "a.obj", "replace": [{"material": "wood", "with": "gold"}]}])");
  EXPECT_NE(material.find("/objects/0/replace/0/material"), std::string::npos) << material;
}

}  // namespace
}  // namespace kestrel::cli
