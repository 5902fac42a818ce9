// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/gpu_scene.h"

#include <array>

#include "base/error.h"
#include "gl/debug.h"
#include "gl/shared_structs.h"

namespace kestrel {
namespace {

// A multiple of every driver's GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, which is at most 256.
constexpr size_t kObjectStride = 256;

struct alignas(kObjectStride) PaddedObject {
  gpu::GpuObject object;
};
static_assert(sizeof(PaddedObject) == kObjectStride);

mat4 square(const mat4x3& m) {
  return mat4(vec4(m[0], 0.0f), vec4(m[1], 0.0f), vec4(m[2], 0.0f), vec4(m[3], 1.0f));
}

std::vector<PaddedObject> pack_objects(const Scene& scene) {
  std::vector<PaddedObject> out(scene.objects.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const Object& object = scene.objects[i];
    gpu::GpuObject& packed = out[i].object;
    packed.world_from_object = square(object.world_from_object);
    packed.normal_from_object = mat4(normal_matrix(object.world_from_object));
    packed.id = static_cast<uint32_t>(i) + 1;
    packed.bitangent_sign = object.flips_orientation ? -1.0f : 1.0f;
  }
  return out;
}

/// A material's textures by texture unit, as shaders/raster/material.glsl binds them.
std::array<int, 6> textures_of(const Material& m) {
  return {m.emission_texture, m.ambient_texture, m.diffuse_texture,
          m.specular_texture, m.normal_texture,  m.optical_texture};
}

gpu::GpuMaterial pack(const Material& m) {
  gpu::GpuMaterial out{};
  out.emission = m.emission;
  out.normal_strength = m.normal_strength;
  out.ambient = m.ambient;
  out.alpha_cutoff = m.alpha_cutoff;
  out.diffuse = m.diffuse;
  out.specular = m.specular;
  out.optical = m.optical;
  out.alpha_mode = static_cast<uint32_t>(m.alpha_mode);
  out.tiling = m.tiling;
  out.offset = m.offset;
  const std::array<int, 6> textures = textures_of(m);
  for (size_t unit = 0; unit < textures.size(); ++unit) {
    if (textures[unit] != kNone) out.textures |= 1u << unit;
  }
  return out;
}

gpu::GpuLight pack(const Light& l) {
  gpu::GpuLight out{};
  out.color = l.color;
  out.cos_outer = l.cos_outer;
  out.position = l.position;
  out.blend = l.blend;
  out.exponent = l.exponent;
  out.direction = l.direction;
  out.specular_factor = l.specular_factor;
  out.attenuation = l.attenuation;
  out.type = static_cast<uint32_t>(l.type);
  return out;
}

template <typename Packed, typename Source>
std::vector<Packed> pack_all(const std::vector<Source>& sources) {
  std::vector<Packed> out;
  out.reserve(sources.size());
  for (const Source& source : sources) out.push_back(pack(source));
  return out;
}

/// The cache of a new scene: items of the old cache where the sources are the same.
template <typename Cache, typename Source, typename Make>
Cache renew(const Cache& old, const std::vector<std::shared_ptr<const Source>>& sources,
            const Make& make) {
  Cache out;
  for (const std::shared_ptr<const Source>& source : sources) {
    auto& entry = out[source.get()];
    if (entry.item) continue;
    const auto known = old.find(source.get());
    entry = known != old.end() ? known->second : typename Cache::mapped_type{source, make(*source)};
  }
  return out;
}

}  // namespace

mat3 normal_matrix(const mat4x3& world_from_object) {
  const glm::dvec3 x(world_from_object[0]), y(world_from_object[1]), z(world_from_object[2]);
  const glm::dmat3 cofactor(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  double largest = 0.0;
  for (int i = 0; i < 9; ++i) largest = glm::max(largest, glm::abs(cofactor[i / 3][i % 3]));
  if (!(largest > 0.0)) return mat3(1.0f);
  const double sign = glm::dot(x, cofactor[0]) < 0.0 ? -1.0 : 1.0;
  return mat3(cofactor * (sign / largest));
}

GpuScene::GpuScene() : white_(upload_texture(Texture{"white"})) {}

void GpuScene::update(std::shared_ptr<const Scene> scene) {
  if (scene == scene_) return;
  const gl::DebugGroup group("Upload scene");
  scene_.reset();
  auto meshes = renew(meshes_, scene->meshes,
                      [](const Mesh& m) { return std::make_shared<const GpuMesh>(m); });
  auto textures = renew(textures_, scene->textures, [](const Texture& t) {
    return std::make_shared<const gl::Texture2D>(upload_texture(t));
  });
  objects_.assign(pack_objects(*scene));
  materials_.assign(pack_all<gpu::GpuMaterial>(scene->materials));
  lights_.assign(pack_all<gpu::GpuLight>(scene->lights));
  gl::check_errors("uploading the scene");
  meshes_ = std::move(meshes);
  textures_ = std::move(textures);
  scene_ = std::move(scene);
}

int GpuScene::material_of(const Object& object, uint32_t slot) const {
  if (object.materials.empty()) return 0;
  return object.materials[glm::min<size_t>(slot, object.materials.size() - 1)];
}

void GpuScene::bind_object(GLuint binding, size_t object) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, binding, objects_.name(),
                    static_cast<GLintptr>(object * kObjectStride), sizeof(gpu::GpuObject));
}

void GpuScene::bind_materials_and_lights() const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, materials_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, lights_.name());
}

void GpuScene::bind_material_textures(const Material& material) const {
  const std::array<int, 6> textures = textures_of(material);
  for (GLuint unit = 0; unit < textures.size(); ++unit) {
    if (textures[unit] == kNone) continue;
    glBindTextureUnit(unit, texture(textures[unit]).name());
    glBindSampler(unit, samplers_.for_material(*scene_->textures[textures[unit]]));
  }
}

void GpuScene::bind_world_textures(GLuint first_unit) const {
  const World& world = scene_->world;
  for (GLuint face = 0; face < 6; ++face) {
    const int index = world.kind == WorldKind::color ? kNone : world.textures[face];
    if (index == kNone) {
      glBindTextureUnit(first_unit + face, white_.name());
      glBindSampler(first_unit + face, 0);
      continue;
    }
    const Texture& source = *scene_->textures[index];
    glBindTextureUnit(first_unit + face, texture(index).name());
    glBindSampler(first_unit + face, world.kind == WorldKind::cube
                                         ? samplers_.for_cube_face(source)
                                         : samplers_.for_equirectangular(source));
  }
}

}  // namespace kestrel
