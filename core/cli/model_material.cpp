// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/model_material.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace kestrel::cli {
namespace {

constexpr int kGlNearest = 0x2600;  // glTF sampler: NEAREST
constexpr float kGlassIor = 1.5f;   // KHR_materials_ior's default

/// Adds each image once for each way in which it is used.
class Textures {
 public:
  Textures(const aiScene& source, std::string folder, Model& model)
      : source_(source), folder_(std::move(folder)), model_(model) {}

  /// Id (index + 1) of a material's texture of this type, 0 where it has none.
  uint64_t add(const aiMaterial& material, aiTextureType type, bool srgb) {
    aiString path;
    if (material.GetTexture(type, 0, &path) != aiReturn_SUCCESS || path.length == 0) return 0;
    TextureDescription texture;
    texture.name = path.C_Str();
    texture.srgb = srgb;
    texture.extension = extension_of(material, type);
    int filter = 0;
    material.Get(AI_MATKEY_GLTF_MAPPINGFILTER_MAG(type, 0), filter);
    texture.nearest = filter == kGlNearest;
    const auto [it, is_new] =
        known_.try_emplace({texture.name, srgb, texture.nearest, texture.extension}, 0);
    if (is_new) {
      if (!set_source(path, texture)) return 0;
      model_.textures.push_back(std::move(texture));
      it->second = model_.textures.size();
    }
    return it->second;
  }

 private:
  using Key = std::tuple<std::string, bool, bool, KestrelExtension>;

  static KestrelExtension extension_of(const aiMaterial& material, aiTextureType type) {
    int mode = aiTextureMapMode_Wrap;
    material.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), mode);
    return mode == aiTextureMapMode_Clamp ? KESTREL_EXTENSION_CLAMP : KESTREL_EXTENSION_REPEAT;
  }

  bool set_source(const aiString& path, TextureDescription& texture) const {
    const aiTexture* embedded = source_.GetEmbeddedTexture(path.C_Str());
    if (!embedded) {
      std::string name = path.C_Str();
      std::replace(name.begin(), name.end(), '\\', '/');
      texture.source = TextureFile{(std::filesystem::path(folder_) / name).string()};
      return true;
    }
    if (embedded->mHeight != 0) return false;  // bare texels: no importer in use makes them
    const auto* bytes = reinterpret_cast<const uint8_t*>(embedded->pcData);
    texture.source = TextureBytes{{bytes, bytes + embedded->mWidth}};
    return true;
  }

  const aiScene& source_;
  std::string folder_;
  Model& model_;
  std::map<Key, uint64_t> known_;
};

void read_color(const aiMaterial& material, const char* key, unsigned type, unsigned index,
                float* out, int count) {
  aiColor4D color;
  if (material.Get(key, type, index, color) != aiReturn_SUCCESS) return;
  for (int i = 0; i < count; ++i) {
    if (std::isfinite(color[i])) out[i] = std::max(color[i], 0.0f);
  }
}

/// glTF's alpha mode, or an OBJ's opacity image, which is taken as the base image's alpha.
void read_alpha(const aiMaterial& material, KestrelMaterial& out) {
  aiString mode;
  if (material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
    const std::string_view name = mode.C_Str();
    out.alpha_mode = name == "MASK"    ? KESTREL_ALPHA_MASK
                     : name == "BLEND" ? KESTREL_ALPHA_BLEND
                                       : KESTREL_ALPHA_OPAQUE;
    float cutoff = 0.5f;
    material.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff);
    out.alpha_cutoff = std::clamp(cutoff, 0.0f, 1.0f);
    return;
  }
  float opacity = 1.0f;
  material.Get(AI_MATKEY_OPACITY, opacity);
  out.diffuse[3] = std::clamp(opacity, 0.0f, 1.0f);
  if (material.GetTextureCount(aiTextureType_OPACITY) > 0) {
    out.alpha_mode = KESTREL_ALPHA_MASK;
  } else if (out.diffuse[3] < 1.0f) {
    out.alpha_mode = KESTREL_ALPHA_BLEND;
  }
}

/// KHR_materials_transmission: what is not transmitted is the opacity.
void read_transmission(const aiMaterial& material, KestrelMaterial& out) {
  float transmission = 0.0f;
  material.Get(AI_MATKEY_TRANSMISSION_FACTOR, transmission);
  if (!(transmission > 0.0f)) return;
  float ior = kGlassIor;
  material.Get(AI_MATKEY_REFRACTI, ior);
  out.optical[1] = std::clamp(ior, 1.0f, 5.0f);
  out.optical[2] = 1.0f - std::min(transmission, 1.0f);
  std::copy(out.diffuse, out.diffuse + 3, out.transmission_color);
}

/// KHR_texture_transform's scale and offset, which assimp gives with V up; rotations are left out.
void read_tiling(const aiMaterial& material, aiTextureType type, KestrelMaterial& out) {
  aiUVTransform t;
  if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), t) != aiReturn_SUCCESS) return;
  const float scale[2] = {t.mScaling.x, t.mScaling.y};
  const float move[2] = {t.mTranslation.x, t.mTranslation.y};
  for (int i = 0; i < 2; ++i) {
    if (!std::isfinite(scale[i]) || !std::isfinite(move[i])) continue;
    out.tiling[i] = scale[i];
    out.offset[i] = move[i];
  }
}

MaterialDescription read_material(const aiMaterial& material, Textures& textures) {
  MaterialDescription out;
  out.name = material.GetName().C_Str();
  KestrelMaterial& m = out.values;
  kestrelDefaultMaterial(&m);
  const bool is_pbr = material.GetTextureCount(aiTextureType_BASE_COLOR) > 0;
  const aiTextureType base = is_pbr ? aiTextureType_BASE_COLOR : aiTextureType_DIFFUSE;
  m.diffuse_texture = textures.add(material, base, true);
  // An image without a colour beside it is shown as it is.
  if (m.diffuse_texture) std::fill(m.diffuse, m.diffuse + 3, 1.0f);
  read_color(material, AI_MATKEY_COLOR_DIFFUSE, m.diffuse, 3);
  read_color(material, AI_MATKEY_BASE_COLOR, m.diffuse, 4);
  read_alpha(material, m);
  m.ambient_texture = m.diffuse_texture;
  std::copy(m.diffuse, m.diffuse + 3, m.ambient);
  std::fill(m.specular, m.specular + 4, 0.0f);
  m.emission_texture = textures.add(material, aiTextureType_EMISSIVE, true);
  read_color(material, AI_MATKEY_COLOR_EMISSIVE, m.emission, 3);
  m.normal_texture = textures.add(material, aiTextureType_NORMALS, false);
  if (m.normal_texture) {
    float strength = 1.0f;
    material.Get(AI_MATKEY_GLTF_TEXTURE_SCALE(aiTextureType_NORMALS, 0), strength);
    m.normal_strength = std::isfinite(strength) ? std::clamp(strength, 0.0f, 10.0f) : 1.0f;
  }
  read_transmission(material, m);
  read_tiling(material, base, m);
  return out;
}

}  // namespace

void read_model_materials(const aiScene& source, const std::string& folder, Model& model) {
  Textures textures(source, folder, model);
  for (unsigned i = 0; i < source.mNumMaterials; ++i) {
    model.materials.push_back(read_material(*source.mMaterials[i], textures));
  }
}

}  // namespace kestrel::cli
