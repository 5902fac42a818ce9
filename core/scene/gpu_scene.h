// SPDX-License-Identifier: GPL-3.0-or-later
// The scene in GL memory. What did not change between snapshots is not sent again.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "gl/objects.h"
#include "scene/gpu_mesh.h"
#include "scene/gpu_texture.h"
#include "scene/scene.h"

namespace kestrel {

/// GL thread only.
class GpuScene {
 public:
  GpuScene();

  /// Uploads what differs from the last scene: meshes and textures by identity, the rest by value.
  /// Drops what the new scene no longer uses. Where it throws, there is no scene until it succeeds.
  void update(std::shared_ptr<const Scene> scene);

  /// The scene last uploaded; null where there is none.
  const std::shared_ptr<const Scene>& scene() const { return scene_; }

  const GpuMesh& mesh(int index) const { return *meshes_.at(scene_->meshes[index].get()).item; }
  const gl::Texture2D& texture(int index) const {
    return *textures_.at(scene_->textures[index].get()).item;
  }

  /// Material at a slot; slots that the object lacks take its last one.
  int material_of(const Object& object, uint32_t slot) const;

  /// The object's part of the uniform block at `binding`.
  void bind_object(GLuint binding, size_t object) const;
  /// Materials and lights, as the storage buffers 0 and 1.
  void bind_materials_and_lights() const;
  /// The textures that a material has, on their units of 0 … 5.
  void bind_material_textures(const Material& material) const;
  /// The world's textures on units `first_unit` … + 5; white for none.
  void bind_world_textures(GLuint first_unit) const;

 private:
  template <typename Source, typename Item>
  struct Cached {
    std::shared_ptr<const Source> source;  // keeps the identity from being used again
    std::shared_ptr<const Item> item;
  };
  template <typename Source, typename Item>
  using Cache = std::unordered_map<const Source*, Cached<Source, Item>>;

  std::shared_ptr<const Scene> scene_;
  Cache<Mesh, GpuMesh> meshes_;
  Cache<Texture, gl::Texture2D> textures_;
  gl::MirroredBuffer objects_{"objects"};
  gl::MirroredBuffer materials_{"materials"};
  gl::MirroredBuffer lights_{"lights"};
  TextureSamplers samplers_;
  gl::Texture2D white_;
};

/// The inverse transpose of a transform up to a positive factor: defined for flat ones too, and of
/// ordinary size for tiny and huge ones.
mat3 normal_matrix(const mat4x3& world_from_object);

}  // namespace kestrel
