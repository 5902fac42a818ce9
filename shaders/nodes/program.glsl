// SPDX-License-Identifier: GPL-3.0-or-later
// What node programs are made of. For the shaders and for C++ (core/shading/node_maths.h); the names
// stand in core/shading/node_table.cpp.

const uint kNodeInput = 0u;
const uint kNodeAttribute = 1u;
const uint kNodeImage = 2u;
const uint kNodeComponent = 3u;
const uint kNodeScalar = 4u;
const uint kNodeCombine = 5u;
const uint kNodeColorSpace = 6u;
const uint kNodeMath = 7u;
const uint kNodeVectorMath = 8u;
const uint kNodeMix = 9u;
const uint kNodeMixColor = 10u;
const uint kNodeTable = 11u;
const uint kNodeHueSaturation = 12u;
const uint kNodeBrightContrast = 13u;
const uint kNodeGamma = 14u;
const uint kNodeBlackbody = 15u;
const uint kNodeWavelength = 16u;
const uint kNodeMapping = 17u;
const uint kNodeVectorRotate = 18u;
const uint kNodeVectorTransform = 19u;
const uint kNodeNormalMap = 20u;
const uint kNodeBump = 21u;
const uint kNodeFresnel = 22u;
const uint kNodeLayerWeight = 23u;
const uint kNodeChecker = 24u;
const uint kNodeGradient = 25u;
const uint kNodeMagic = 26u;
const uint kNodeWave = 27u;
const uint kNodeBrick = 28u;
const uint kNodeWhiteNoise = 29u;
const uint kNodeNoise = 30u;
const uint kNodeMusgrave = 31u;
const uint kNodeVoronoi = 32u;

// What kNodeInput reads, by its first mode.
const uint kInputPosition = 0u;        // world space
const uint kInputObject = 1u;          // object space
const uint kInputGenerated = 2u;       // 0 ... 1 in the mesh's texture space
const uint kInputCamera = 3u;          // camera space, +Z ahead
const uint kInputWindow = 4u;          // 0 ... 1 over the picture
const uint kInputReflection = 5u;      // mirror direction of the view, world space
const uint kInputNormal = 6u;          // shading normal on the viewer's side, world space
const uint kInputObjectNormal = 7u;    // the same in object space
const uint kInputTrueNormal = 8u;      // the triangle's
const uint kInputTangent = 9u;         // along the UV map, world space
const uint kInputIncoming = 10u;       // to the viewer, world space
const uint kInputParametric = 11u;     // barycentric coordinates
const uint kInputBackfacing = 12u;     // 0 or 1, as all below that is a question
const uint kInputObjectLocation = 13u; // world space
const uint kInputObjectIndex = 14u;
const uint kInputObjectRandom = 15u;   // 0 ... 1
const uint kInputMaterialIndex = 16u;
const uint kInputIsCamera = 17u;
const uint kInputIsShadow = 18u;
const uint kInputIsReflection = 19u;
const uint kInputIsTransmission = 20u;
const uint kInputRayLength = 21u;
const uint kInputRayDepth = 22u;
const uint kInputViewVector = 23u;     // from the camera, camera space, unit
const uint kInputViewDepth = 24u;      // along the camera's axis
const uint kInputViewDistance = 25u;

const uint kCameraRay = 1u;
const uint kShadowRay = 2u;
const uint kReflectionRay = 4u;
const uint kRefractionRay = 8u;

// What a program computes of a surface.
const int kNodeEmission = 0;
const int kNodeAmbient = 1;
const int kNodeDiffuse = 2;
const int kNodeAlpha = 3;
const int kNodeSpecular = 4;      // colour of the highlight at normal incidence
const int kNodeRoughness = 5;     // of the highlight
const int kNodeReflection = 6;    // share of mirrored light by colour
const int kNodeTransmission = 7;  // share of light that goes through by colour
const int kNodeIor = 8;
const int kNodeNormal = 9;        // world space, on the viewer's side
const int kNodeOutputs = 10;

const int kNodeRegisters = 48;
const int kNodeInputs = 8;
const int kNodeTableSize = 256;   // entries of kNodeTable

// Operands: a register, or -1 - n: constant n.
struct NodeInstruction {
  uint op;
  uint mode;  // its modes in mixed radix, the first of the table being the lowest digit
  int result; // register
  int data;   // index of a texture, an attribute or a constant; of kNodeInput, the place
  int operands[8];
};

// A point to evaluate at, on the viewer's side of the surface.
struct NodePoint {
  vec3 position;
  vec3 normal;
  vec3 true_normal;
  vec3 incoming;
  vec3 position_os;
  vec3 normal_os;
  vec3 texture_space_from;  // generated = (position_os - from) * scale
  vec3 texture_space_scale;
  vec3 position_camera;  // camera space, +Z ahead
  vec3 object_location;
  vec3 step_x;  // on the surface, world space: where a bump's height is taken beside here
  vec3 step_y;
  vec3 step_x_os;
  vec3 step_y_os;
  vec3 mesh_normal_os;  // on the mesh's own side, as interpolated: shorter than 1 between corners
  vec4 tangent_os;  // w: side of the bitangent; 0: there is none
  vec2 parametric;
  vec2 window;  // 0 ... 1 over the picture
  float ray_length;
  float object_index;
  float object_random;
  float material_index;
  uint ray;    // one of the kinds above
  int ray_depth;
  bool backfacing;
};
