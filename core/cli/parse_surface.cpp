// SPDX-License-Identifier: GPL-3.0-or-later
// Textures and materials (the paper's Table 1).
#include <climits>

#include "cli/parse.h"
#include "cli/scene_data.h"
#include "scene/scene_file_words.h"

namespace kestrel::cli {
namespace {

void copy(const std::vector<float>& from, float* to) {
  std::copy(from.begin(), from.end(), to);
}

/// Squares of two colours, `texels` to a side of a square.
TexturePixels checker(const JsonNode& node) {
  node.expect_keys({"squares", "texels", "colors"});
  const auto squares_node = node.find("squares");
  const auto texels_node = node.find("texels");
  const int squares = squares_node ? squares_node->integer(1, 1024) : 8;
  const int texels = texels_node ? texels_node->integer(1, 64) : 16;
  if (squares * texels > 8192) node.fail("'squares' times 'texels' must not exceed 8192");
  float colors[2][4] = {{0.8f, 0.8f, 0.8f, 1.0f}, {0.2f, 0.2f, 0.2f, 1.0f}};
  if (const auto colors_node = node.find("colors")) {
    const std::vector<JsonNode> both = colors_node->items(2);
    if (both.size() != 2) colors_node->fail("expected 2 colours");
    for (int i = 0; i < 2; ++i) copy(both[i].numbers(3, 4, 0, kMaximumRadiance), colors[i]);
  }
  TexturePixels pixels;
  pixels.width = pixels.height = squares * texels;
  pixels.rgba.reserve(static_cast<size_t>(pixels.width) * pixels.height * 4);
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x) {
      const float* color = colors[(x / texels + y / texels) % 2];
      pixels.rgba.insert(pixels.rgba.end(), color, color + 4);
    }
  }
  return pixels;
}

TexturePixels parse_pixels(const JsonNode& node, const SceneBuffer& buffer) {
  node.expect_keys({"width", "height", "bytes", "floats"});
  const auto bytes = node.find("bytes");
  const auto floats = node.find("floats");
  if (bytes.has_value() == floats.has_value()) node.fail("expected either 'bytes' or 'floats'");
  TexturePixels pixels;
  pixels.width = node.require("width").integer(1, 32768);
  pixels.height = node.require("height").integer(1, 32768);
  if (bytes) pixels.bytes = buffer.bytes(*bytes);
  if (floats) pixels.rgba = buffer.floats(*floats, -kMaximumRadiance, kMaximumRadiance);
  const size_t expected = 4 * static_cast<size_t>(pixels.width) * pixels.height;
  const size_t found = bytes ? pixels.bytes.size() : pixels.rgba.size();
  if (found != expected) {
    (bytes ? *bytes : *floats).fail("expected {} values, 4 a pixel, found {}", expected, found);
  }
  return pixels;
}

/// Refers to a texture by name; 0 where the key is missing.
uint64_t parse_reference(const JsonNode& node, const std::string& key, const Names& textures) {
  const auto reference = node.find(key);
  return reference ? static_cast<uint64_t>(textures.find(*reference)) + 1 : 0;
}

/// RGB, and A within 0…1 where it is given. Colours beyond that are no error: scenes hold them.
void parse_rgba(const JsonNode& node, float* out) {
  const std::vector<float> values = node.numbers(3, 4, -kMaximumRadiance, kMaximumRadiance);
  if (values.size() == 4 && !(values[3] >= 0.0f && values[3] <= 1.0f)) {
    node.fail("the fourth number must lie from 0 to 1, found {}", values[3]);
  }
  copy(values, out);
}

void parse_colors(const JsonNode& node, KestrelMaterial& m) {
  if (const auto n = node.find("emission"))
    copy(n->numbers(3, 3, -kMaximumRadiance, kMaximumRadiance), m.emission);
  if (const auto n = node.find("diffuse")) parse_rgba(*n, m.diffuse);
  if (const auto n = node.find("specular")) parse_rgba(*n, m.specular);
  if (const auto n = node.find("reflection_color"))
    copy(n->numbers(3, 3, -kMaximumRadiance, kMaximumRadiance), m.reflection_color);
  if (const auto n = node.find("transmission_color")) {
    copy(n->numbers(3, 3, -kMaximumRadiance, kMaximumRadiance), m.transmission_color);
  }
  // A surface whose ambient colour is not given reflects ambient light as it does any other.
  std::copy(m.diffuse, m.diffuse + 3, m.ambient);
  if (const auto n = node.find("ambient"))
    copy(n->numbers(3, 3, -kMaximumRadiance, kMaximumRadiance), m.ambient);
  if (const auto n = node.find("reflectivity")) m.optical[0] = n->number(0, 1);
  if (const auto n = node.find("ior")) m.optical[1] = n->number(0.1, 10);
  if (const auto n = node.find("opacity")) m.optical[2] = n->number(0, 1);
}

void parse_texture_use(const JsonNode& node, const Names& textures, KestrelMaterial& m) {
  m.emission_texture = parse_reference(node, "emission_texture", textures);
  m.diffuse_texture = parse_reference(node, "diffuse_texture", textures);
  m.ambient_texture = parse_reference(node, "ambient_texture", textures);
  m.specular_texture = parse_reference(node, "specular_texture", textures);
  m.normal_texture = parse_reference(node, "normal_texture", textures);
  m.optical_texture = parse_reference(node, "optical_texture", textures);
  if (!node.has("ambient_texture") && !node.has("ambient")) m.ambient_texture = m.diffuse_texture;
  if (const auto n = node.find("normal_strength"))
    m.normal_strength = n->number(-kMaximumLength, kMaximumLength);
  if (const auto n = node.find("tiling"))
    copy(n->numbers(2, 2, -kMaximumLength, kMaximumLength), m.tiling);
  if (const auto n = node.find("offset"))
    copy(n->numbers(2, 2, -kMaximumLength, kMaximumLength), m.offset);
}

/// What the material takes from the mesh, by id.
void parse_attribute_use(const JsonNode& node, KestrelMaterial& m) {
  if (const auto maps = node.find("uv_maps")) {
    const std::vector<JsonNode> ids = maps->items(6);
    if (ids.size() != 6) maps->fail("expected 6 ids, one for each texture");
    for (size_t i = 0; i < ids.size(); ++i) m.uv_maps[i] = ids[i].whole();
  }
  if (const auto n = node.find("tangent_map")) m.tangent_map = n->whole();
  if (const auto n = node.find("emission_attribute")) m.emission_attribute = n->whole();
  if (const auto n = node.find("ambient_attribute")) m.ambient_attribute = n->whole();
  if (const auto n = node.find("diffuse_attribute")) m.diffuse_attribute = n->whole();
}

}  // namespace

TextureDescription parse_texture(const JsonNode& node, Names& names, int index,
                                 const SceneBuffer& buffer) {
  node.expect_keys({"name", "label", "file", "checker", "pixels", "srgb", "nearest", "extension"});
  TextureDescription texture;
  texture.name = parse_label(node, names.add(node, index));
  const auto file = node.find("file");
  const auto generated = node.find("checker");
  const auto pixels = node.find("pixels");
  if (file.has_value() + generated.has_value() + pixels.has_value() != 1) {
    node.fail("expected one of 'file', 'checker' and 'pixels'");
  }
  if (file) texture.source = TextureFile{resolve_file(*file)};
  if (generated) texture.source = checker(*generated);
  if (pixels) texture.source = parse_pixels(*pixels, buffer);
  if (const auto n = node.find("srgb")) texture.srgb = n->boolean();
  if (const auto n = node.find("nearest")) texture.nearest = n->boolean();
  if (const auto n = node.find("extension")) {
    texture.extension = static_cast<KestrelExtension>(n->choice(kExtensionWords));
  }
  return texture;
}

MaterialDescription parse_material(const JsonNode& node, const Names& textures, Names& names,
                                   int index, std::vector<bool>& holds_data) {
  node.expect_keys({"name",
                    "label",
                    "emission",
                    "ambient",
                    "diffuse",
                    "specular",
                    "reflectivity",
                    "ior",
                    "opacity",
                    "reflection_color",
                    "transmission_color",
                    "emission_texture",
                    "ambient_texture",
                    "diffuse_texture",
                    "specular_texture",
                    "normal_texture",
                    "optical_texture",
                    "normal_strength",
                    "tiling",
                    "offset",
                    "casts_shadow",
                    "alpha_mode",
                    "alpha_cutoff",
                    "pass_index",
                    "uv_maps",
                    "tangent_map",
                    "emission_attribute",
                    "ambient_attribute",
                    "diffuse_attribute"});
  MaterialDescription material;
  material.name = parse_label(node, names.add(node, index));
  KestrelMaterial& m = material.values;
  kestrelDefaultMaterial(&m);
  parse_colors(node, m);
  parse_texture_use(node, textures, m);
  for (const uint64_t id : {m.normal_texture, m.optical_texture}) {
    if (id) holds_data[id - 1] = true;
  }
  if (const auto n = node.find("casts_shadow")) m.casts_shadow = n->boolean();
  if (const auto n = node.find("alpha_mode")) {
    m.alpha_mode = n->choice(kAlphaModeWords);
  }
  if (const auto n = node.find("alpha_cutoff")) m.alpha_cutoff = n->number(0, 1);
  if (const auto n = node.find("pass_index")) m.pass_index = n->integer(INT_MIN, INT_MAX);
  parse_attribute_use(node, m);
  return material;
}

}  // namespace kestrel::cli
