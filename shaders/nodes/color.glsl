// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of nodes: linear Rec. 709 unless said; components may exceed 1.

const uint kNodeBlendTypes = 19u;

NODE_FUNCTION float color_luminance(vec3 color) {
  return dot(color, vec3(0.2126729f, 0.7151522f, 0.0721750f));
}

// ---- hue ---------------------------------------------------------------------------------------

// Hue of 0 to 1 from the components, their largest and what that is above the smallest (not 0).
NODE_FUNCTION float color_hue(vec3 rgb, float largest, float chroma) {
  float hue = rgb.x == largest   ? (rgb.y - rgb.z) / chroma
              : rgb.y == largest ? (rgb.z - rgb.x) / chroma + 2.0f
                                 : (rgb.x - rgb.y) / chroma + 4.0f;
  return (hue < 0.0f ? hue + 6.0f : hue) * (1.0f / 6.0f);
}

NODE_FUNCTION vec3 hsv_from_rgb(vec3 rgb) {
  float largest = max(rgb.x, max(rgb.y, rgb.z));
  float chroma = largest - min(rgb.x, min(rgb.y, rgb.z));
  if (chroma == 0.0f || largest == 0.0f) return vec3(0.0f, 0.0f, largest);
  return vec3(color_hue(rgb, largest, chroma), chroma / largest, largest);
}

NODE_FUNCTION vec3 rgb_from_hsv(vec3 hsv) {
  if (hsv.y == 0.0f) return vec3(hsv.z);
  float place = hsv.x == 1.0f ? 0.0f : hsv.x * 6.0f;
  float sextant = floor(place);
  float within = place - sextant;
  float low = hsv.z * (1.0f - hsv.y);
  float falling = hsv.z * (1.0f - hsv.y * within);
  float rising = hsv.z * (1.0f - hsv.y * (1.0f - within));
  if (sextant == 0.0f) return vec3(hsv.z, rising, low);
  if (sextant == 1.0f) return vec3(falling, hsv.z, low);
  if (sextant == 2.0f) return vec3(low, hsv.z, rising);
  if (sextant == 3.0f) return vec3(low, falling, hsv.z);
  if (sextant == 4.0f) return vec3(rising, low, hsv.z);
  return vec3(hsv.z, low, falling);
}

NODE_FUNCTION vec3 hsl_from_rgb(vec3 rgb) {
  float largest = max(rgb.x, max(rgb.y, rgb.z));
  float smallest = min(rgb.x, min(rgb.y, rgb.z));
  float sum = largest + smallest;
  float lightness = min(sum * 0.5f, 1.0f);
  if (largest == smallest) return vec3(0.0f, 0.0f, lightness);
  float chroma = largest - smallest;
  return vec3(color_hue(rgb, largest, chroma),
              chroma / (lightness > 0.5f ? 2.0f - largest - smallest : sum), lightness);
}

NODE_FUNCTION vec3 rgb_from_hsl(vec3 hsl) {
  float place = hsl.x * 6.0f;
  vec3 pure = clamp(vec3(abs(place - 3.0f) - 1.0f, 2.0f - abs(place - 2.0f),
                         2.0f - abs(place - 4.0f)),
                    vec3(0.0f), vec3(1.0f));
  float chroma = (1.0f - abs(2.0f * hsl.z - 1.0f)) * hsl.y;
  return (pure - vec3(0.5f)) * chroma + vec3(hsl.z);
}

// Separate Color and Combine Color; `conversion`: 0 RGB to HSV, 1 HSV to RGB, 2 RGB to HSL,
// 3 HSL to RGB.
NODE_FUNCTION vec3 node_color_space(uint conversion, vec3 color) {
  switch (conversion) {
    case 0u: return hsv_from_rgb(color);
    case 1u: return rgb_from_hsv(color);
    case 2u: return hsl_from_rgb(color);
    default: return rgb_from_hsl(color);
  }
}

// ---- Mix Color ---------------------------------------------------------------------------------

// The component-wise blends; `share` is the factor, of any size.
NODE_FUNCTION float node_blend_component(uint type, float share, float a, float b) {
  float rest = 1.0f - share;
  switch (type) {
    case 0u: return mix(a, b, share);                // mix
    case 1u: return mix(a, min(a, b), share);        // darken
    case 2u: return mix(a, a * b, share);            // multiply
    case 3u: {                                       // burn
      float divisor = rest + share * b;
      if (divisor <= 0.0f) return 0.0f;
      return clamp(1.0f - (1.0f - a) / divisor, 0.0f, 1.0f);
    }
    case 4u: return mix(a, max(a, b), share);                        // lighten
    case 5u: return 1.0f - (rest + share * (1.0f - b)) * (1.0f - a);  // screen
    case 6u: {                                                       // dodge
      if (a == 0.0f) return 0.0f;
      float divisor = 1.0f - share * b;
      return divisor <= 0.0f ? 1.0f : min(a / divisor, 1.0f);
    }
    case 7u: return mix(a, a + b, share);  // add
    case 8u:                               // overlay
      if (a < 0.5f) return a * (rest + 2.0f * share * b);
      return 1.0f - (rest + 2.0f * share * (1.0f - b)) * (1.0f - a);
    case 9u: {  // soft light
      float screen = 1.0f - (1.0f - b) * (1.0f - a);
      return rest * a + share * ((1.0f - a) * b * a + a * screen);
    }
    case 10u: return a + share * (2.0f * b - 1.0f);                         // linear light
    case 11u: return mix(a, abs(a - b), share);                            // difference
    case 12u: return max(mix(a, a + b - 2.0f * a * b, share), 0.0f);       // exclusion
    case 13u: return mix(a, a - b, share);                                 // subtract
    case 14u: return b != 0.0f ? rest * a + share * a / b : a;             // divide
    default: return a;
  }
}

// `type`: 0 mix, darken, multiply, burn, lighten, screen, dodge, add, overlay, soft light, linear
// light, difference, exclusion, subtract, divide, 15 hue, saturation, colour, 18 value.
NODE_FUNCTION vec3 node_blend(uint type, float share, vec3 a, vec3 b) {
  if (type < 15u) {
    return vec3(node_blend_component(type, share, a.x, b.x),
                node_blend_component(type, share, a.y, b.y),
                node_blend_component(type, share, a.z, b.z));
  }
  vec3 hsv = hsv_from_rgb(a);
  vec3 other = hsv_from_rgb(b);
  if (type == 16u) {
    return hsv.y != 0.0f ? rgb_from_hsv(vec3(hsv.x, mix(hsv.y, other.y, share), hsv.z)) : a;
  }
  if (type == 18u) return rgb_from_hsv(vec3(hsv.x, hsv.y, mix(hsv.z, other.z, share)));
  if (other.y == 0.0f) return a;
  return mix(a, rgb_from_hsv(vec3(other.x, type == 17u ? other.y : hsv.y, hsv.z)), share);
}

// ---- adjustments -------------------------------------------------------------------------------

// Hue/Saturation/Value with a factor of 1; neutral at hue 0.5, saturation 1, value 1.
NODE_FUNCTION vec3 node_hue_saturation(vec3 color, float hue, float saturation, float value) {
  vec3 hsv = hsv_from_rgb(color);
  vec3 changed = vec3(fract(hsv.x + hue + 0.5f), clamp(hsv.y * saturation, 0.0f, 1.0f),
                      hsv.z * value);
  return max(rgb_from_hsv(changed), vec3(0.0f));
}

NODE_FUNCTION vec3 node_bright_contrast(vec3 color, float bright, float contrast) {
  return max((1.0f + contrast) * color + vec3(bright - contrast * 0.5f), vec3(0.0f));
}

NODE_FUNCTION vec3 node_gamma(vec3 color, float gamma) {
  if (gamma == 0.0f) return vec3(1.0f);
  return vec3(color.x > 0.0f ? pow(color.x, gamma) : color.x,
              color.y > 0.0f ? pow(color.y, gamma) : color.y,
              color.z > 0.0f ? pow(color.z, gamma) : color.z);
}

NODE_FUNCTION vec3 node_invert(vec3 color, float share) {
  return share * (vec3(1.0f) - color) + (1.0f - share) * color;
}

// ---- light -------------------------------------------------------------------------------------

// Blackbody: the colour at luminance 1 of a body of so many kelvin, held outside 800 to 12000.
NODE_FUNCTION vec3 node_blackbody(float temperature) {
  // Fits by interval of temperature, as Blender has them: red and green a/t + bt + c, blue a cubic
  // polynomial.
  const float red[21] = {
      1.61919106e+03f, -2.05010916e-03f, 5.02995757e+00f,
      2.48845471e+03f, -1.11330907e-03f, 3.22621544e+00f,
      3.34143193e+03f, -4.86551192e-04f, 1.76486769e+00f,
      4.09461742e+03f, -1.27446582e-04f, 7.25731635e-01f,
      4.67028036e+03f, 2.91258199e-05f, 1.26703442e-01f,
      4.59509185e+03f, 2.87495649e-05f, 1.50345020e-01f,
      3.78717450e+03f, 9.35907826e-06f, 3.99075871e-01f};
  const float green[21] = {
      -4.88999748e+02f, 6.04330754e-04f, -7.55807526e-02f,
      -7.55994277e+02f, 3.16730098e-04f, 4.78306139e-01f,
      -1.02363977e+03f, 1.20223470e-04f, 9.36662319e-01f,
      -1.26571316e+03f, 4.87340896e-06f, 1.27054498e+00f,
      -1.42529332e+03f, -4.01150431e-05f, 1.43972784e+00f,
      -1.17554822e+03f, -2.16378048e-05f, 1.30408023e+00f,
      -5.00799571e+02f, -4.59832026e-06f, 1.09098763e+00f};
  const float blue[28] = {
      5.96945309e-11f, -4.85742887e-08f, -9.70622247e-05f, -4.07936148e-03f,
      2.40430366e-11f, 5.55021075e-08f, -1.98503712e-04f, 2.89312858e-02f,
      -1.40949732e-11f, 1.89878968e-07f, -3.56632824e-04f, 9.10767778e-02f,
      -3.61460868e-11f, 2.84822009e-07f, -4.93211319e-04f, 1.56723440e-01f,
      -1.97075738e-11f, 1.75359352e-07f, -2.50542825e-04f, -2.22783266e-02f,
      -1.61997957e-13f, -1.64216008e-08f, 3.86216271e-04f, -7.38077418e-01f,
      6.72650283e-13f, -2.73078809e-08f, 4.24098264e-04f, -7.52335691e-01f};
  if (temperature >= 12000.0f) return vec3(0.8262954810f, 0.9945080502f, 1.5663077103f);
  if (!(temperature >= 800.0f)) return vec3(5.4132944902f, 0.0f, 0.0f);
  float t = temperature;
  int interval = t >= 6365.0f   ? 6
                 : t >= 3315.0f ? 5
                 : t >= 1902.0f ? 4
                 : t >= 1449.0f ? 3
                 : t >= 1167.0f ? 2
                 : t >= 965.0f  ? 1
                                : 0;
  int i = 3 * interval;
  int j = 4 * interval;
  vec3 color = vec3(red[i] / t + red[i + 1] * t + red[i + 2],
                    green[i] / t + green[i + 1] * t + green[i + 2],
                    ((blue[j] * t + blue[j + 1]) * t + blue[j + 2]) * t + blue[j + 3]);
  return max(color, vec3(0.0f));
}

// Wavelength: the colour of light of so many nanometres, black outside 380 to 780.
NODE_FUNCTION vec3 node_wavelength(float wavelength) {
  // The CIE 1931 standard observer, X Y Z at every fifth nanometre from 380.
  const float observer[243] = {
      0.0014f, 0.0000f, 0.0065f, 0.0022f, 0.0001f, 0.0105f, 0.0042f, 0.0001f, 0.0201f,
      0.0076f, 0.0002f, 0.0362f, 0.0143f, 0.0004f, 0.0679f, 0.0232f, 0.0006f, 0.1102f,
      0.0435f, 0.0012f, 0.2074f, 0.0776f, 0.0022f, 0.3713f, 0.1344f, 0.0040f, 0.6456f,
      0.2148f, 0.0073f, 1.0391f, 0.2839f, 0.0116f, 1.3856f, 0.3285f, 0.0168f, 1.6230f,
      0.3483f, 0.0230f, 1.7471f, 0.3481f, 0.0298f, 1.7826f, 0.3362f, 0.0380f, 1.7721f,
      0.3187f, 0.0480f, 1.7441f, 0.2908f, 0.0600f, 1.6692f, 0.2511f, 0.0739f, 1.5281f,
      0.1954f, 0.0910f, 1.2876f, 0.1421f, 0.1126f, 1.0419f, 0.0956f, 0.1390f, 0.8130f,
      0.0580f, 0.1693f, 0.6162f, 0.0320f, 0.2080f, 0.4652f, 0.0147f, 0.2586f, 0.3533f,
      0.0049f, 0.3230f, 0.2720f, 0.0024f, 0.4073f, 0.2123f, 0.0093f, 0.5030f, 0.1582f,
      0.0291f, 0.6082f, 0.1117f, 0.0633f, 0.7100f, 0.0782f, 0.1096f, 0.7932f, 0.0573f,
      0.1655f, 0.8620f, 0.0422f, 0.2257f, 0.9149f, 0.0298f, 0.2904f, 0.9540f, 0.0203f,
      0.3597f, 0.9803f, 0.0134f, 0.4334f, 0.9950f, 0.0087f, 0.5121f, 1.0000f, 0.0057f,
      0.5945f, 0.9950f, 0.0039f, 0.6784f, 0.9786f, 0.0027f, 0.7621f, 0.9520f, 0.0021f,
      0.8425f, 0.9154f, 0.0018f, 0.9163f, 0.8700f, 0.0017f, 0.9786f, 0.8163f, 0.0014f,
      1.0263f, 0.7570f, 0.0011f, 1.0567f, 0.6949f, 0.0010f, 1.0622f, 0.6310f, 0.0008f,
      1.0456f, 0.5668f, 0.0006f, 1.0026f, 0.5030f, 0.0003f, 0.9384f, 0.4412f, 0.0002f,
      0.8544f, 0.3810f, 0.0002f, 0.7514f, 0.3210f, 0.0001f, 0.6424f, 0.2650f, 0.0000f,
      0.5419f, 0.2170f, 0.0000f, 0.4479f, 0.1750f, 0.0000f, 0.3608f, 0.1382f, 0.0000f,
      0.2835f, 0.1070f, 0.0000f, 0.2187f, 0.0816f, 0.0000f, 0.1649f, 0.0610f, 0.0000f,
      0.1212f, 0.0446f, 0.0000f, 0.0874f, 0.0320f, 0.0000f, 0.0636f, 0.0232f, 0.0000f,
      0.0468f, 0.0170f, 0.0000f, 0.0329f, 0.0119f, 0.0000f, 0.0227f, 0.0082f, 0.0000f,
      0.0158f, 0.0057f, 0.0000f, 0.0114f, 0.0041f, 0.0000f, 0.0081f, 0.0029f, 0.0000f,
      0.0058f, 0.0021f, 0.0000f, 0.0041f, 0.0015f, 0.0000f, 0.0029f, 0.0010f, 0.0000f,
      0.0020f, 0.0007f, 0.0000f, 0.0014f, 0.0005f, 0.0000f, 0.0010f, 0.0004f, 0.0000f,
      0.0007f, 0.0002f, 0.0000f, 0.0005f, 0.0002f, 0.0000f, 0.0003f, 0.0001f, 0.0000f,
      0.0002f, 0.0001f, 0.0000f, 0.0002f, 0.0001f, 0.0000f, 0.0001f, 0.0000f, 0.0000f,
      0.0001f, 0.0000f, 0.0000f, 0.0001f, 0.0000f, 0.0000f, 0.0000f, 0.0000f, 0.0000f};
  float place = (wavelength - 380.0f) * 0.2f;
  if (!(place > -1.0f && place < 80.0f)) return vec3(0.0f);
  int i = int(place);
  float within = place - float(i);
  vec3 below = vec3(observer[3 * i], observer[3 * i + 1], observer[3 * i + 2]);
  vec3 above = vec3(observer[3 * i + 3], observer[3 * i + 4], observer[3 * i + 5]);
  vec3 xyz = mix(below, above, within);
  vec3 rgb = vec3(dot(vec3(3.2404542f, -1.5371385f, -0.4985314f), xyz),
                  dot(vec3(-0.9692660f, 1.8760108f, 0.0415560f), xyz),
                  dot(vec3(0.0556434f, -0.2040259f, 1.0572252f), xyz));
  return max(rgb * (1.0f / 2.52f), vec3(0.0f));
}
