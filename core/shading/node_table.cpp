// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/node_table.h"

#include <array>
#include <nlohmann/json.hpp>

#include "scene/node_types.h"

namespace kestrel {
namespace {

using Names = std::vector<std::string_view>;

const Names kDimensions = {"1D", "2D", "3D", "4D"};
const Names kBlenders = {"3", "4", "5"};  // major version whose results are wanted
const Names kNoYes = {"NO", "YES"};

/// In the order of the constants in shaders/nodes/program.glsl; modes in that of the switches and
/// constants there.
std::vector<NodeOp> make_table() {
  return {
      {"input",
       {{"POSITION",        "OBJECT",         "GENERATED",     "CAMERA",          "WINDOW",
         "REFLECTION",      "NORMAL",         "OBJECT_NORMAL", "TRUE_NORMAL",     "TANGENT",
         "INCOMING",        "PARAMETRIC",     "BACKFACING",    "OBJECT_LOCATION", "OBJECT_INDEX",
         "OBJECT_RANDOM",   "MATERIAL_INDEX", "IS_CAMERA",     "IS_SHADOW",       "IS_REFLECTION",
         "IS_TRANSMISSION", "RAY_LENGTH",     "RAY_DEPTH",     "VIEW_VECTOR",     "VIEW_DEPTH",
         "VIEW_DISTANCE"}},
       {},
       NodeData::place},
      {"attribute", {{"HERE", "BESIDE_X", "BESIDE_Y"}}, {}, NodeData::attribute},
      {"image",
       {{"FLAT", "BOX", "SPHERE", "TUBE", "EQUIRECTANGULAR", "MIRROR_BALL"}},
       {"vector", "blend"},
       NodeData::texture},
      {"component", {{"X", "Y", "Z", "ALPHA"}}, {"value"}},
      {"scalar", {{"LUMINANCE", "AVERAGE"}}, {"value"}},
      {"combine", {}, {"x", "y", "z"}},
      {"color_space", {{"RGB_TO_HSV", "HSV_TO_RGB", "RGB_TO_HSL", "HSL_TO_RGB"}}, {"color"}},
      {"math",
       {{"ADD",        "SUBTRACT",       "MULTIPLY",     "DIVIDE",    "MULTIPLY_ADD", "POWER",
         "LOGARITHM",  "SQRT",           "INVERSE_SQRT", "ABSOLUTE",  "EXPONENT",     "MINIMUM",
         "MAXIMUM",    "LESS_THAN",      "GREATER_THAN", "SIGN",      "COMPARE",      "SMOOTH_MIN",
         "SMOOTH_MAX", "ROUND",          "FLOOR",        "CEIL",      "TRUNC",        "FRACT",
         "MODULO",     "FLOORED_MODULO", "WRAP",         "SNAP",      "PINGPONG",     "SINE",
         "COSINE",     "TANGENT",        "ARCSINE",      "ARCCOSINE", "ARCTANGENT",   "ARCTAN2",
         "SINH",       "COSH",           "TANH",         "RADIANS",   "DEGREES"},
        kNoYes /* clamp */},
       {"a", "b", "c"}},
      {"vector_math",
       {{"ADD",     "SUBTRACT", "MULTIPLY",  "DIVIDE",      "MULTIPLY_ADD", "CROSS_PRODUCT",
         "PROJECT", "REFLECT",  "REFRACT",   "FACEFORWARD", "DOT_PRODUCT",  "DISTANCE",
         "LENGTH",  "SCALE",    "NORMALIZE", "ABSOLUTE",    "MINIMUM",      "MAXIMUM",
         "FLOOR",   "CEIL",     "FRACTION",  "MODULO",      "WRAP",         "SNAP",
         "SINE",    "COSINE",   "TANGENT",   "POWER",       "SIGN",         "ROUND"}},
       {"a", "b", "c", "scale"}},
      {"mix", {kNoYes /* clamp the factor */}, {"factor", "a", "b"}},
      {"mix_color",
       {{"MIX", "DARKEN", "MULTIPLY", "BURN", "LIGHTEN", "SCREEN", "DODGE", "ADD", "OVERLAY",
         "SOFT_LIGHT", "LINEAR_LIGHT", "DIFFERENCE", "EXCLUSION", "SUBTRACT", "DIVIDE", "HUE",
         "SATURATION", "COLOR", "VALUE"},
        kNoYes /* clamp the factor */,
        kNoYes /* clamp the result */},
       {"factor", "a", "b"}},
      {"table", {{"LINEAR", "CONSTANT", "CURVES"}}, {"x"}, NodeData::table},
      {"hue_saturation", {}, {"color", "hue", "saturation", "value"}},
      {"bright_contrast", {}, {"color", "bright", "contrast"}},
      {"gamma", {}, {"color", "gamma"}},
      {"blackbody", {}, {"temperature"}},
      {"wavelength", {}, {"wavelength"}},
      {"mapping",
       {{"POINT", "TEXTURE", "VECTOR", "NORMAL"}},
       {"vector", "location", "rotation", "scale"}},
      {"vector_rotate",
       {{"AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ"}, kNoYes /* invert */},
       {"vector", "center", "axis", "angle", "rotation"}},
      {"vector_transform",
       {{"VECTOR", "POINT", "NORMAL"},
        {"WORLD", "OBJECT", "CAMERA"},
        {"WORLD", "OBJECT", "CAMERA"}},
       {"vector"}},
      {"normal_map",
       {{"TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"}},
       {"color", "strength"}},
      {"bump",
       {kNoYes /* invert */},
       {"height", "height_x", "height_y", "normal", "strength", "distance"}},
      {"fresnel", {}, {"ior", "normal"}},
      {"layer_weight", {{"FRESNEL", "FACING"}}, {"blend", "normal"}},
      {"checker", {{"COLOR", "FAC"}}, {"vector", "color1", "color2", "scale"}},
      {"gradient",
       {{"LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL"}},
       {"vector"}},
      {"magic",
       {{"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10"}, kBlenders},
       {"vector", "scale", "distortion"}},
      {"wave",
       {{"BANDS", "RINGS"}, {"X", "Y", "Z", "DIAGONAL"}, {"SIN", "SAW", "TRI"}, kBlenders},
       {"vector", "scale", "distortion", "detail", "detail_scale", "detail_roughness", "phase"}},
      {"brick",  // the result's X is the tint, its Y the mortar's share
       {},
       {"vector", "scale", "mortar_size", "mortar_smooth", "bias", "brick_width", "row_height"},
       NodeData::constant},  // offset, its frequency, squash, its frequency
      {"white_noise", {kDimensions, {"VALUE", "COLOR"}}, {"vector", "w"}},
      {"noise",
       {kDimensions,
        {"FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN"},
        kNoYes /* normalize */,
        {"FAC", "COLOR"},
        kBlenders},
       {"vector", "w", "scale", "detail", "roughness", "lacunarity", "distortion", "offset_gain"}},
      {"musgrave",
       {kDimensions,
        {"FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN"}},
       {"vector", "w", "scale", "detail", "dimension", "lacunarity", "offset", "gain"}},
      {"voronoi",
       {kDimensions,
        {"EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI"},
        {"F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"},
        kNoYes /* normalize */,
        {"DISTANCE", "COLOR", "POSITION", "W"},
        kBlenders},
       {"vector", "w", "scale", "smoothness", "exponent", "randomness",
        "detail_roughness_lacunarity"}},
  };
}

constexpr std::array<std::string_view, nodes::kNodeOutputs> kOutputs = {
    "emission",  "ambient",    "diffuse",      "alpha", "specular",
    "roughness", "reflection", "transmission", "ior",   "normal"};

const char* name_of(NodeData data) {
  switch (data) {
    case NodeData::none:
      return "none";
    case NodeData::place:
      return "place";
    case NodeData::texture:
      return "texture";
    case NodeData::attribute:
      return "attribute";
    case NodeData::table:
      return "table";
    case NodeData::constant:
      return "constant";
  }
  return "";
}

}  // namespace

uint32_t NodeOp::mode_count() const {
  uint32_t count = 1;
  for (const auto& digit : modes) count *= static_cast<uint32_t>(digit.size());
  return count;
}

std::span<const NodeOp> node_table() {
  static const auto& table = *new std::vector<NodeOp>(make_table());
  return table;
}

std::span<const std::string_view> node_outputs() {
  return kOutputs;
}

std::string node_table_json() {
  nlohmann::ordered_json ops = nlohmann::json::array();
  for (const NodeOp& op : node_table()) {
    ops.push_back({{"name", op.name},
                   {"modes", op.modes},
                   {"operands", op.operands},
                   {"data", name_of(op.data)}});
  }
  return nlohmann::ordered_json{{"ops", ops},
                                {"outputs", kOutputs},
                                {"registers", nodes::kNodeRegisters},
                                {"table_size", nodes::kNodeTableSize}}
      .dump();
}

}  // namespace kestrel
