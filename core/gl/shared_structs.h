// SPDX-License-Identifier: GPL-3.0-or-later
// The structs of shaders/common/gpu_structs.glsl in C++, and proof that the layouts agree.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/math.h"
#include "scene/scene.h"

namespace kestrel::gpu {

using glm::mat4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = uint32_t;

#include "../../shaders/common/gpu_structs.glsl"

static_assert(sizeof(GpuFrame) == 272);
static_assert(offsetof(GpuFrame, window) == 192);
static_assert(offsetof(GpuFrame, subpixel) == 216);
static_assert(offsetof(GpuFrame, ambient) == 224);
static_assert(offsetof(GpuFrame, environment_ior) == 236);
static_assert(offsetof(GpuFrame, world_color) == 240);
static_assert(offsetof(GpuFrame, world_kind) == 252);
static_assert(offsetof(GpuFrame, light_count) == 260);

static_assert(sizeof(GpuObject) == 144);
static_assert(offsetof(GpuObject, normal_from_object) == 64);
static_assert(offsetof(GpuObject, id) == 128);
static_assert(offsetof(GpuObject, bitangent_sign) == 132);

static_assert(sizeof(GpuMaterial) == 112);
static_assert(offsetof(GpuMaterial, normal_strength) == 12);
static_assert(offsetof(GpuMaterial, ambient) == 16);
static_assert(offsetof(GpuMaterial, alpha_cutoff) == 28);
static_assert(offsetof(GpuMaterial, diffuse) == 32);
static_assert(offsetof(GpuMaterial, specular) == 48);
static_assert(offsetof(GpuMaterial, optical) == 64);
static_assert(offsetof(GpuMaterial, alpha_mode) == 76);
static_assert(offsetof(GpuMaterial, tiling) == 80);
static_assert(offsetof(GpuMaterial, offset) == 88);
static_assert(offsetof(GpuMaterial, textures) == 96);

static_assert(sizeof(GpuLight) == 80);
static_assert(offsetof(GpuLight, cos_outer) == 12);
static_assert(offsetof(GpuLight, position) == 16);
static_assert(offsetof(GpuLight, direction) == 32);
static_assert(offsetof(GpuLight, attenuation) == 48);
static_assert(offsetof(GpuLight, type) == 60);
static_assert(offsetof(GpuLight, exponent) == 64);

// Values the shaders compare with.
static_assert(static_cast<int>(AlphaMode::mask) == 1 && static_cast<int>(AlphaMode::blend) == 2);
static_assert(static_cast<int>(LightType::directional) == 0 &&
              static_cast<int>(LightType::spot) == 2);
static_assert(static_cast<int>(WorldKind::color) == 0 &&
              static_cast<int>(WorldKind::equirectangular) == 1 &&
              static_cast<int>(WorldKind::cube) == 2);

}  // namespace kestrel::gpu
