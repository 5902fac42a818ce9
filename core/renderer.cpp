// SPDX-License-Identifier: GPL-3.0-or-later
#include "renderer.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

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

/// A frame that needs no budget is made in bands of about this many pixels: they stay in the
/// processor's cache, and no plane of the whole picture is needed but the passes.
constexpr int kBandPixels = 1 << 16;
constexpr int kBandRows = 32;  // bands have a multiple of this many rows, so that tiles are whole

/// How often progress is reported.
constexpr auto kReportInterval = std::chrono::milliseconds(50);

/// A probe of the cost traces about this many pixels, spread evenly.
constexpr double kProbePixels = 4096.0;

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
  explicit Impl(std::shared_ptr<Device> d) : device(std::move(d)) {
    for (const PassInfo& pass : pass_table()) passes.emplace_back(pass.name);
  }

  void render(const Progress& progress);
  void prepare();
  bool use_raster();
  bool limited() const;
  int band_rows() const;
  void rasterize(const FrameInputs& inputs);
  void select(const FrameInputs& inputs, int sample);
  void probe(const FrameInputs& inputs);
  void trace(const FrameInputs& inputs, const Progress& progress);
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
  std::vector<std::string> passes;
  std::atomic<bool> cancel_requested = false;

  // The frame under way.
  std::shared_ptr<const Scene> scene;
  int width = 0;
  int height = 0;
  GBuffer gbuffer;
  EffectBuffers effects;
  Plane<vec4> combined;
  Areas areas;
  Selection selection;
  EffectBuffers totals;        // rays and times so far
  double progress_done = 0.0;  // bands done, over all bands of all samples
  double progress_step = 1.0;
  std::atomic<std::chrono::steady_clock::rep> last_report = 0;
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

void Renderer::set_passes(const std::vector<std::string>& names) {
  Film(0, 0, names);  // checks them
  impl_->passes = names;
}

/// The four stages, for each sample and each band of rows.
void Renderer::Impl::render(const Progress& progress) {
  stats = {};
  totals = {};
  areas.clear();
  last_report = 0;
  film = Film(width, height, passes);
  {
    const Stopwatch watch(stats.frame_ms);
    prepare();
    const Settings& settings = scene->settings;
    const int rows = band_rows();
    progress_done = 0.0;
    progress_step = 1.0 / (settings.samples * ((height + rows - 1) / rows));
    for (int sample = 0; sample < settings.samples; ++sample) {
      for (int first_row = 0; first_row < height; first_row += rows) {
        const FrameInputs inputs{*scene,
                                 width,
                                 height,
                                 subpixel_offset(settings, sample),
                                 settings.budget_ms / static_cast<float>(settings.samples),
                                 first_row,
                                 std::min(rows, height - first_row)};
        rasterize(inputs);
        select(inputs, sample);
        trace(inputs, progress);
        blend(inputs);
        film.add(inputs, sample, gbuffer, effects, combined);
      }
    }
  }
  finish();
}

/// Whether the graph decides; else every visible object is traced, or none.
bool Renderer::Impl::limited() const {
  return scene->settings.selection == SelectionPolicy::graph && scene->settings.budget_ms > 0.0f;
}

/// The graph needs to see the whole picture, and so does the rasteriser.
int Renderer::Impl::band_rows() const {
  if (limited() || raster) return height;
  const int rows = (kBandPixels / width + kBandRows - 1) / kBandRows * kBandRows;
  return std::clamp(rows, kBandRows, std::max(height, kBandRows));
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

/// Decides who is traced: with a budget on the first sample's whole picture, else before anything
/// is seen, as if every object were visible.
void Renderer::Impl::select(const FrameInputs& inputs, int sample) {
  const Stopwatch watch(stats.stages.heuristic);
  if (sample == 0) count_areas(*scene, gbuffer, areas);
  const bool first = sample == 0 && inputs.first_row == 0;
  if (first && limited()) {
    selection = heuristic.select(inputs, areas);
    if (!heuristic.calibrated()) {
      probe(inputs);
      selection = heuristic.select(inputs, areas);
    }
  } else if (first) {
    selection = heuristic.select(inputs, Areas(scene->objects.size() + 1, 1));
  }
  if (sample == 0) write_heuristic_mask(*scene, selection, gbuffer);
  if (first && scene->settings.validate_areas && raster) {
    stats.occlusion_areas = raster->occlusion_areas(inputs);
  }
}

/// Measures what tracing costs here, on few pixels of everything in view.
void Renderer::Impl::probe(const FrameInputs& inputs) {
  const double pixels = static_cast<double>(inputs.pixels());
  const int stride = std::max(1, static_cast<int>(std::sqrt(pixels / kProbePixels)));
  double ms = 0.0;
  {
    const Stopwatch watch(ms);
    trace_stage.run({inputs, gbuffer, selection, stride, {}, {}}, effects);
  }
  heuristic.learn(inputs, selection, effects, ms, 1.0 / (stride * stride));
}

void Renderer::Impl::trace(const FrameInputs& inputs, const Progress& progress) {
  const Stopwatch watch(stats.stages.trace);
  const auto report = [&](float share) {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    auto last = last_report.load();
    if (!progress || now - decltype(now)(last) < kReportInterval ||
        !last_report.compare_exchange_strong(last, now.count())) {
      return;
    }
    const double done = progress_done + share * progress_step;
    const int sample = std::min(static_cast<int>(done * stats.samples) + 1, stats.samples);
    if (!progress(static_cast<float>(done), fmt::format("Sample {}/{}", sample, stats.samples))) {
      cancel_requested = true;
    }
  };
  report(0.0f);
  trace_stage.run(
      {inputs, gbuffer, selection, 1, [this] { return cancel_requested.load(); }, report}, effects);
  progress_done += progress_step;
  totals.rays += effects.rays;
  totals.trace_calls_ms += effects.trace_calls_ms;
  totals.rays_by_unit.resize(effects.rays_by_unit.size(), 0);
  for (size_t i = 0; i < effects.rays_by_unit.size(); ++i) {
    totals.rays_by_unit[i] += effects.rays_by_unit[i];
  }
}

void Renderer::Impl::blend(const FrameInputs& inputs) {
  const Stopwatch watch(stats.stages.blend);
  blend_stage.run(inputs, gbuffer, selection, effects, combined);
}

/// Publishes the frame, and lets the heuristic learn from it.
void Renderer::Impl::finish() {
  const FrameInputs inputs{*scene, width, height};
  stats.selection = limited() ? selection : heuristic.select(inputs, areas);
  heuristic.remember(stats.selection);
  heuristic.learn(inputs, stats.selection, totals, stats.stages.trace, stats.samples);
  stats.rays += totals.rays;
  stats.trace_calls_ms = totals.trace_calls_ms;
  film.finish();
  finished = std::move(film);
  stats_json = to_json(stats, *scene);
  log::info(
      "{}x{}, {} samples, primary {}: {:.1f} ms (update {:.1f}, raster {:.1f}, heuristic "
      "{:.1f}, trace {:.1f}, blend {:.1f})",
      width, height, stats.samples, stats.primary, stats.frame_ms, stats.stages.update,
      stats.stages.raster, stats.stages.heuristic, stats.stages.trace, stats.stages.blend);
}

}  // namespace kestrel
