// SPDX-License-Identifier: GPL-3.0-or-later
#include "renderer.h"

#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>

#include "base/error.h"
#include "base/log.h"
#include "frame/sampling.h"
#include "frame/stats.h"
#include "scene/rt_scene.h"
#include "stages/blend.h"
#include "stages/heuristic.h"
#include "stages/raster.h"
#include "stages/trace.h"
#include "tracers/embree/embree_tracer.h"
#include "tracers/embree/primary_rays.h"

namespace kestrel {
namespace {

/// A probe of the cost traces every n-th pixel in x and y.
constexpr int kProbeStride = 16;

/// Adds the wall time of its life to `sum`, milliseconds.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum) {}
  ~Stopwatch() {
    sum_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin_)
                .count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

struct Renderer::Impl {
  explicit Impl(std::shared_ptr<Device> d) : device(std::move(d)) {}

  void render(const Progress& progress);
  void prepare();
  bool use_raster();
  void rasterize(const FrameInputs& inputs);
  void select(const FrameInputs& inputs);
  void probe(const FrameInputs& inputs);
  void trace(const FrameInputs& inputs, int sample, const Progress& progress);
  void blend(const FrameInputs& inputs);
  void finish();

  std::shared_ptr<Device> device;
  RtScene rt_scene{device->embree()};
  std::unique_ptr<RasterStage> raster;  // while OpenGL is in use
  PrimaryRays primary_rays{rt_scene};
  EmbreeTracer embree_tracer{rt_scene};
  HeuristicStage heuristic;
  TraceStage trace_stage{embree_tracer};
  BlendStage blend_stage;
  std::atomic<bool> cancel_requested = false;

  // The frame under way.
  std::shared_ptr<const Scene> scene;
  int width = 0;
  int height = 0;
  GBuffer gbuffer;
  EffectBuffers effects;
  EffectBuffers totals;  // rays and times of all samples so far
  std::vector<vec4> combined;
  Film film;
  FrameStats stats;

  // The last whole frame.
  Film finished;
  std::string stats_json;
};

Renderer::Renderer(std::shared_ptr<Device> device)
    : impl_(std::make_unique<Impl>(std::move(device))) {}
Renderer::~Renderer() = default;

void Renderer::cancel() {
  impl_->cancel_requested = true;
}
const Film& Renderer::film() const {
  return impl_->finished;
}
const std::string& Renderer::stats_json() const {
  return impl_->stats_json;
}

void Renderer::render_frame(std::shared_ptr<const Scene> scene, int width, int height,
                            const Progress& progress) {
  if (width < 1 || height < 1 || int64_t{width} * height > int64_t{1} << 30) {
    fail(ErrorCode::invalid_argument,
         "A picture of {} x {} pixels cannot be made. Choose from 1 x 1 to 2^30 pixels.", width,
         height);
  }
  Impl& r = *impl_;
  r.cancel_requested = false;
  r.scene = std::move(scene);
  r.width = width;
  r.height = height;
  const int threads = r.scene->settings.threads;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] { r.render(progress); });
}

/// The four stages, once for each sample; who is selected is decided once a frame.
void Renderer::Impl::render(const Progress& progress) {
  stats = {};
  totals = {};
  film.clear();
  {
    const Stopwatch watch(stats.frame_ms);
    prepare();
    for (int sample = 0; sample < scene->settings.samples; ++sample) {
      const FrameInputs inputs{
          *scene, width, height, subpixel_offset(scene->settings, sample),
          scene->settings.budget_ms / static_cast<float>(scene->settings.samples)};
      rasterize(inputs);
      if (sample == 0) select(inputs);
      trace(inputs, sample, progress);
      blend(inputs);
      film.add_sample(inputs, gbuffer, effects, combined);
    }
  }
  finish();
}

/// Brings what the stages read up to date with the scene.
void Renderer::Impl::prepare() {
  const Stopwatch watch(stats.stages.update);
  rt_scene.update(scene);
  if (use_raster()) {
    if (!raster) raster = std::make_unique<RasterStage>(device->gl());
    raster->update(scene);
  } else {
    raster.reset();
  }
  stats.primary = raster ? "raster" : "rays";
  stats.samples = scene->settings.samples;
}

/// On a GPU rasterising is faster; where OpenGL itself runs on the processor, rays are.
bool Renderer::Impl::use_raster() {
  const Primary primary = scene->settings.primary;
  if (primary == Primary::rays) return false;
  if (primary == Primary::automatic && !gl::hardware_available()) return false;
  try {
    return primary == Primary::raster || !device->gl()->info().software;
  } catch (const Error& error) {
    log::warning_once("Rasterising is not possible, rays are used instead: {}", error.what());
    return false;
  }
}

void Renderer::Impl::rasterize(const FrameInputs& inputs) {
  const Stopwatch watch(stats.stages.raster);
  if (raster) {
    raster->run(inputs, gbuffer);
  } else {
    stats.rays.primary += primary_rays.run(inputs, gbuffer);
  }
}

void Renderer::Impl::select(const FrameInputs& inputs) {
  const Stopwatch watch(stats.stages.heuristic);
  stats.selection = heuristic.run(inputs, gbuffer);
  if (inputs.budget_ms > 0.0f && !heuristic.calibrated()) {
    probe(inputs);
    stats.selection = heuristic.run(inputs, gbuffer);
  }
  if (scene->settings.validate_areas && raster) {
    stats.occlusion_areas = raster->occlusion_areas(inputs);
  }
}

/// Measures what tracing costs here, on few pixels of everything in view.
void Renderer::Impl::probe(const FrameInputs& inputs) {
  double ms = 0.0;
  {
    const Stopwatch watch(ms);
    trace_stage.run({inputs, gbuffer, stats.selection, kProbeStride, {}, {}}, effects);
  }
  heuristic.learn(inputs, stats.selection, effects, ms,
                  1.0 / static_cast<double>(kProbeStride * kProbeStride));
}

void Renderer::Impl::trace(const FrameInputs& inputs, int sample, const Progress& progress) {
  const Stopwatch watch(stats.stages.trace);
  const auto report = [&](float share) {
    if (!progress) return;
    const float samples = static_cast<float>(scene->settings.samples);
    const auto status = fmt::format("Sample {}/{}", sample + 1, scene->settings.samples);
    if (!progress((static_cast<float>(sample) + share) / samples, status)) cancel_requested = true;
  };
  report(0.0f);
  const TraceRequest request{
      inputs, gbuffer, stats.selection, 1, [this] { return cancel_requested.load(); }, report};
  trace_stage.run(request, effects);
  totals.rays += effects.rays;
  totals.trace_calls_ms += effects.trace_calls_ms;
  totals.rays_by_unit.resize(effects.rays_by_unit.size(), 0);
  for (size_t i = 0; i < effects.rays_by_unit.size(); ++i) {
    totals.rays_by_unit[i] += effects.rays_by_unit[i];
  }
}

void Renderer::Impl::blend(const FrameInputs& inputs) {
  const Stopwatch watch(stats.stages.blend);
  blend_stage.run(inputs, gbuffer, stats.selection, effects, combined);
}

/// Publishes the frame, and lets the heuristic learn from it.
void Renderer::Impl::finish() {
  const FrameInputs inputs{*scene, width, height};
  heuristic.learn(inputs, stats.selection, totals, stats.stages.trace, stats.samples);
  stats.rays += totals.rays;
  stats.trace_calls_ms = totals.trace_calls_ms;
  std::swap(finished, film);
  stats_json = to_json(stats, *scene);
  log::info(
      "{}x{}, {} samples, primary {}: {:.1f} ms (update {:.1f}, raster {:.1f}, heuristic "
      "{:.1f}, trace {:.1f}, blend {:.1f})",
      width, height, stats.samples, stats.primary, stats.frame_ms, stats.stages.update,
      stats.stages.raster, stats.stages.heuristic, stats.stages.trace, stats.stages.blend);
}

}  // namespace kestrel
