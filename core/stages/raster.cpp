// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/raster.h"

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "frame/region_loops.h"
#include "gl/debug.h"
#include "gl/shader_library.h"
#include "scene/gpu_scene.h"
#include "stages/raster_targets.h"
#include "stages/raster_view.h"

namespace kestrel {
namespace {

constexpr GLuint kFrameBlock = 0, kObjectBlock = 1;
constexpr GLint kMaterialIndex = 0;  // uniform of shaders/raster/gbuffer_fragment.glsl
constexpr GLuint kFirstWorldUnit = 7;

/// Everything fixed that the passes rely on; the context is shared with other users.
void set_common_state() {
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  for (const GLenum off :
       {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_MULTISAMPLE, GL_DITHER, GL_DEPTH_CLAMP,
        GL_FRAMEBUFFER_SRGB, GL_STENCIL_TEST, GL_RASTERIZER_DISCARD, GL_POLYGON_OFFSET_FILL}) {
    glDisable(off);
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

/// Makes what was drawn of holdouts nothing.
void punch_holdouts(const FrameInputs& inputs, GBuffer& out) {
  const Scene& scene = inputs.scene;
  out.holdout.resize(scene.has_holdouts ? out.object.size() : 0);
  if (!scene.has_holdouts) return;
  const size_t width = static_cast<size_t>(out.width);
  for_rows(inputs.region, [&](int y) {
    for (size_t i = y * width; i < (y + 1) * width; ++i) {
      out.holdout[i] = out.object[i] != 0 && scene.objects[out.object[i] - 1].holdout;
      if (out.holdout[i]) out.set_nothing(i, vec3(0.0f));
    }
  });
}

}  // namespace

/// Lives and dies on the GL thread.
class RasterPasses {
 public:
  GpuScene gpu_scene;

  void run(const FrameInputs& inputs, GBuffer& out);
  std::vector<uint64_t> occlusion_areas(const FrameInputs& inputs);

 private:
  const Scene& scene() const;
  void begin_frame(const FrameInputs& inputs);
  std::vector<size_t> visible_objects(const FrameInputs& inputs) const;
  void fill_gbuffer(const FrameInputs& inputs);
  void light() const;
  GLuint program_for(const Material& material);
  void draw_with_materials(size_t object);
  void draw_shape(size_t object) const;

  gl::Program gbuffer_program_ = gl::build_program(
      "G-buffer",
      {{GL_VERTEX_SHADER, "raster/gbuffer.vert"}, {GL_FRAGMENT_SHADER, "raster/gbuffer.frag"}});
  gl::Program masked_program_ =
      gl::build_program("G-buffer, masked", {{GL_VERTEX_SHADER, "raster/gbuffer.vert"},
                                             {GL_FRAGMENT_SHADER, "raster/gbuffer_masked.frag"}});
  std::optional<gl::Program> attributes_program_;  // made for the first material that needs it
  gl::Program lighting_program_ = gl::build_program(
      "lighting",
      {{GL_VERTEX_SHADER, "raster/lighting.vert"}, {GL_FRAGMENT_SHADER, "raster/lighting.frag"}});
  gl::Program occlusion_program_ = gl::build_program(
      "occlusion",
      {{GL_VERTEX_SHADER, "raster/gbuffer.vert"}, {GL_FRAGMENT_SHADER, "raster/occlusion.frag"}});
  gl::VertexArray no_vertices_{"no vertices"};
  gl::MirroredBuffer frame_{"frame"};
  RasterTargets targets_;
  std::vector<gl::SampleQuery> queries_;  // by unit
};

const Scene& RasterPasses::scene() const {
  if (!gpu_scene.scene()) {
    fail(ErrorCode::invalid_operation, "The rasteriser has no scene: update() comes first.");
  }
  return *gpu_scene.scene();
}

void RasterPasses::begin_frame(const FrameInputs& inputs) {
  const gpu::GpuFrame frame = gpu_frame(scene(), inputs);
  frame_.assign(&frame, sizeof(frame));
  glBindBufferBase(GL_UNIFORM_BUFFER, kFrameBlock, frame_.name());
  set_common_state();
}

std::vector<size_t> RasterPasses::visible_objects(const FrameInputs& inputs) const {
  const glm::dmat4 view = clip_from_world(scene(), inputs);
  std::vector<size_t> out;
  for (size_t i = 0; i < scene().objects.size(); ++i) {
    const Object& object = scene().objects[i];
    if (object.mesh == kNone || object.hidden_from & kCameraRays) continue;
    const Bounds& bounds = gpu_scene.mesh(object.mesh).bounds();
    if (may_be_visible(transformed(bounds, object.world_from_object), view)) out.push_back(i);
  }
  return out;
}

GLuint RasterPasses::program_for(const Material& material) {
  if (!material.reads_attributes()) {
    return material.alpha_mode == AlphaMode::mask ? masked_program_.name()
                                                  : gbuffer_program_.name();
  }
  if (!attributes_program_) {
    attributes_program_ = gl::build_program(
        "G-buffer, attributes", {{GL_VERTEX_SHADER, "raster/gbuffer_attributes.vert"},
                                 {GL_FRAGMENT_SHADER, "raster/gbuffer_attributes.frag"}});
  }
  return attributes_program_->name();
}

void RasterPasses::draw_with_materials(size_t index) {
  const Object& object = scene().objects[index];
  const GpuMesh& mesh = gpu_scene.mesh(object.mesh);
  mesh.bind();
  gpu_scene.bind_object(kObjectBlock, index);
  for (const SlotRange& range : mesh.ranges()) {
    const int material_index = gpu_scene.material_of(object, range.slot);
    const Material& material = scene().materials[material_index];
    gpu_scene.bind_material_textures(material);
    mesh.bind_attributes(material);
    glUseProgram(program_for(material));
    glUniform1ui(kMaterialIndex, static_cast<GLuint>(material_index));
    glDrawArrays(GL_TRIANGLES, range.first_vertex, range.vertex_count);
  }
}

void RasterPasses::draw_shape(size_t index) const {
  const GpuMesh& mesh = gpu_scene.mesh(scene().objects[index].mesh);
  mesh.bind();
  gpu_scene.bind_object(kObjectBlock, index);
  for (const SlotRange& range : mesh.ranges()) {
    glDrawArrays(GL_TRIANGLES, range.first_vertex, range.vertex_count);
  }
}

void RasterPasses::fill_gbuffer(const FrameInputs& inputs) {
  const gl::DebugGroup group("G-buffer");
  targets_.begin_gbuffer();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  gpu_scene.bind_materials_and_lights();
  for (const size_t object : visible_objects(inputs)) draw_with_materials(object);
}

void RasterPasses::light() const {
  const gl::DebugGroup group("Lighting");
  targets_.begin_lighting();
  glDisable(GL_DEPTH_TEST);
  glUseProgram(lighting_program_.name());
  gpu_scene.bind_materials_and_lights();
  gpu_scene.bind_world_textures(kFirstWorldUnit);
  glBindVertexArray(no_vertices_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void RasterPasses::run(const FrameInputs& inputs, GBuffer& out) {
  begin_frame(inputs);
  if (!targets_.fits(inputs)) {
    targets_ = RasterTargets();
    targets_ = RasterTargets(inputs);
  }
  fill_gbuffer(inputs);
  light();
  gl::check_errors("rasterising");
  targets_.read(out);
}

std::vector<uint64_t> RasterPasses::occlusion_areas(const FrameInputs& inputs) {
  std::vector<std::vector<size_t>> objects_of(scene().units.size());
  if (!targets_.has_size(inputs.width, inputs.height)) {
    fail(ErrorCode::invalid_operation,
         "Occlusion areas need a rasterised picture of the same size first.");
  }
  begin_frame(inputs);
  for (const size_t i : visible_objects(inputs)) {
    const int unit = scene().objects[i].unit;
    if (unit != kNone && !scene().objects[i].holdout) objects_of[unit].push_back(i);
  }
  const gl::DebugGroup group("Occlusion queries");
  targets_.begin_occlusion();
  glUseProgram(occlusion_program_.name());
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_EQUAL);
  glDepthMask(GL_FALSE);
  // The first fragment in a pixel marks it, later ones (overlapping faces) fail.
  glEnable(GL_STENCIL_TEST);
  glStencilMask(0xff);
  glStencilFunc(GL_NOTEQUAL, 1, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  while (queries_.size() < objects_of.size()) queries_.emplace_back();
  for (size_t unit = 0; unit < objects_of.size(); ++unit) {
    queries_[unit].begin();
    for (const size_t object : objects_of[unit]) draw_shape(object);
    queries_[unit].end();
  }
  set_common_state();
  glDepthMask(GL_TRUE);
  gl::check_errors("counting visible pixels");
  std::vector<uint64_t> areas(objects_of.size());
  for (size_t unit = 0; unit < areas.size(); ++unit) areas[unit] = queries_[unit].result();
  return areas;
}

struct RasterStage::Impl {
  std::shared_ptr<gl::Context> context;
  std::optional<RasterPasses> passes;

  ~Impl() {
    context->run([this] { passes.reset(); });
  }
};

RasterStage::RasterStage(std::shared_ptr<gl::Context> context) : impl_(std::make_unique<Impl>()) {
  impl_->context = std::move(context);
  impl_->context->run([this] { impl_->passes.emplace(); });
}

RasterStage::~RasterStage() = default;

void RasterStage::update(const std::shared_ptr<const Scene>& scene) {
  impl_->context->run([&] { impl_->passes->gpu_scene.update(scene); });
}

void RasterStage::run(const FrameInputs& inputs, GBuffer& out) {
  out.resize(inputs);
  out.reflection_color.clear();
  out.transmission_color.clear();
  if (inputs.region.pixels() == 0) return;
  impl_->context->run([&] { impl_->passes->run(inputs, out); });
  punch_holdouts(inputs, out);
}

std::vector<uint64_t> RasterStage::occlusion_areas(const FrameInputs& inputs) {
  std::vector<uint64_t> areas;
  impl_->context->run([&] { areas = impl_->passes->occlusion_areas(inputs); });
  return areas;
}

}  // namespace kestrel
