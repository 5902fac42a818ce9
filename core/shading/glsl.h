// SPDX-License-Identifier: GPL-3.0-or-later
// What C++ needs to take shader sources for its own: GLSL's types, functions and parameters.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

#include "base/math.h"

#define NODE_FUNCTION inline
#define OUT(T) T&
#define INOUT(T) T&

namespace kestrel::nodes {

using uint = unsigned int;
using glm::ivec2;
using glm::ivec3;
using glm::ivec4;
using glm::mat3;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

using glm::abs;
using glm::acos;
using glm::asin;
using glm::atan;
using glm::ceil;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::exp2;
using glm::floatBitsToUint;
using glm::floor;
using glm::fract;
using glm::length;
using glm::log;
using glm::log2;
using glm::max;
using glm::min;
using glm::mix;
using glm::mod;
using glm::normalize;
using glm::pow;
using glm::round;
using glm::sign;
using glm::sin;
using glm::smoothstep;
using glm::sqrt;
using glm::step;
using glm::tan;
using glm::transpose;
using glm::uintBitsToFloat;

}  // namespace kestrel::nodes
