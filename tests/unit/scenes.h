// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes built in code, with known answers.
#pragma once

#include <memory>
#include <string>

#include "scene/scene.h"

namespace kestrel::test {

/// A rectangle of two triangles: origin and two edges, normal = cross(edge_u, edge_v), UVs 0…1.
inline std::shared_ptr<Mesh> quad_mesh(const vec3& origin, const vec3& u, const vec3& v) {
  auto mesh = std::make_shared<Mesh>();
  mesh->name = "quad";
  mesh->positions = {origin, origin + u, origin + u + v, origin + v};
  mesh->positions.reserve(5);
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh->corner_uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  for (const vec3& p : mesh->positions) mesh->bounds.extend(p);
  return mesh;
}

/// A smooth unit sphere.
inline std::shared_ptr<Mesh> sphere_mesh(int slices = 128, int stacks = 64) {
  auto mesh = std::make_shared<Mesh>();
  mesh->name = "sphere";
  for (int j = 0; j <= stacks; ++j) {
    for (int i = 0; i < slices; ++i) {
      const float theta = kPi * static_cast<float>(j) / static_cast<float>(stacks);
      const float phi = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(slices);
      mesh->positions.push_back(
          {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  mesh->positions.reserve(mesh->positions.size() + 1);
  const auto at = [&](int j, int i) { return static_cast<uint32_t>(j * slices + i % slices); };
  for (int j = 0; j < stacks; ++j) {
    for (int i = 0; i < slices; ++i) {
      if (j + 1 < stacks) mesh->triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      if (j > 0) mesh->triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
  }
  for (const uvec3& t : mesh->triangles) {
    for (int c = 0; c < 3; ++c) mesh->corner_normals.push_back(mesh->positions[t[c]]);
  }
  for (const vec3& p : mesh->positions) mesh->bounds.extend(p);
  return mesh;
}

inline mat4x3 placed(const vec3& position, float scale = 1.0f) {
  mat4x3 m(scale);
  m[3] = position;
  return m;
}

/// A scene under construction: an orthographic camera 10 m above the origin that looks down on
/// 2 x 2 metres, a black world, one default material.
struct SceneMaker {
  std::shared_ptr<Scene> scene = std::make_shared<Scene>();

  SceneMaker() {
    scene->materials.emplace_back();
    Camera& camera = scene->camera;
    camera.projection = Projection::orthographic;
    camera.world_from_camera[3] = vec3(0.0f, 0.0f, 10.0f);
    camera.near_clip = 0.1f;
    camera.far_clip = 100.0f;
    scene->settings.samples = 1;
    scene->settings.primary = Primary::rays;
  }

  int material(const Material& m) {
    scene->materials.push_back(m);
    return static_cast<int>(scene->materials.size()) - 1;
  }

  int texture(const Texture& t) {
    scene->textures.push_back(std::make_shared<Texture>(t));
    return static_cast<int>(scene->textures.size()) - 1;
  }

  /// Every object is a unit of its own.
  int object(const std::string& name, std::shared_ptr<const Mesh> mesh, int material,
             const mat4x3& world_from_object = mat4x3(1.0f)) {
    scene->meshes.push_back(mesh);
    Object o;
    o.name = name;
    o.mesh = static_cast<int>(scene->meshes.size()) - 1;
    o.unit = static_cast<int>(scene->units.size());
    o.materials = {material};
    o.world_from_object = world_from_object;
    o.flips_orientation = glm::determinant(mat3(world_from_object)) < 0.0f;
    scene->objects.push_back(o);
    Unit unit;
    unit.name = name;
    unit.bounds = transformed(mesh->bounds, world_from_object);
    unit.reflective = scene->materials[material].reflective();
    unit.refractive = scene->materials[material].refractive();
    scene->units.push_back(unit);
    return o.unit;
  }

  Light& light(LightType type, const vec3& color, const vec3& position_or_direction) {
    Light l;
    l.type = type;
    l.color = color;
    (type == LightType::directional ? l.direction : l.position) =
        type == LightType::directional ? glm::normalize(position_or_direction)
                                       : position_or_direction;
    scene->lights.push_back(l);
    return scene->lights.back();
  }
};

}  // namespace kestrel::test
