// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient Texture.

// Factor of 0 to 1. `type`: 0 linear, 1 quadratic, 2 easing, 3 diagonal, 4 spherical, 5 quadratic
// sphere, 6 radial.
NODE_FUNCTION float node_gradient(uint type, vec3 p) {
  float ramp = clamp(p.x, 0.0f, 1.0f);
  // A little short of the unit sphere, so that its rounding does not show.
  float ball = clamp(0.999999f - length(p), 0.0f, 1.0f);
  switch (type) {
    case 0u: return ramp;
    case 1u: return ramp * ramp;
    case 2u: return ramp * ramp * (3.0f - 2.0f * ramp);
    case 3u: return clamp((p.x + p.y) * 0.5f, 0.0f, 1.0f);
    case 4u: return ball;
    case 5u: return ball * ball;
    default:
      if (p.x == 0.0f && p.y == 0.0f) return 0.5f;
      return clamp(atan(p.y, p.x) / 6.28318530718f + 0.5f, 0.0f, 1.0f);
  }
}
