// SPDX-License-Identifier: GPL-3.0-or-later
#include "renderer.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "frame/lens.h"
#include "frame/region_loops.h"
#include "frame/sampling.h"
#include "frame/stats.h"
#include "scene/motion.h"
#include "scene/rt_scene.h"
#include "stages/blend.h"
#include "stages/heuristic.h"
#include "stages/motion_vectors.h"
#include "stages/raster.h"
#include "stages/trace.h"
#include "tracers/embree/embree_tracer.h"
#include "tracers/embree/layer_rays.h"
#include "tracers/embree/primary_rays.h"

namespace kestrel {
namespace {

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

/// What the stages hand on of one region, and what they took for all regions that used it.
struct Workspace {
  GBuffer gbuffer;
  EffectBuffers effects;
  Plane<vec4> combined;
  Areas areas;
  StageTimes times;
  uint64_t primary_rays = 0;
  TraceCounts counts;

  /// Before a frame. The memory of the planes stays.
  void reset() {
    areas.clear();
    times = {};
    primary_rays = 0;
    counts = {};
  }
};

}  // namespace

struct Renderer::Impl {
  explicit Impl(std::shared_ptr<Device> d) : device(std::move(d)) {
    for (const PassInfo& pass : pass_table()) {
      if (in_all(pass)) passes.emplace_back(pass.name);
    }
  }

  void render(const Progress& progress);
  void choose_primary();
  void begin_film();
  void prepare();
  void show_moment(int sample);
  bool use_raster();
  bool limited() const;
  bool lens_open() const;
  bool whole_picture() const;
  void render_sample(int sample);
  void render_tiles(const FrameInputs& picture, int sample);
  void render_region(const FrameInputs& inputs, int sample, Workspace& work);
  void rasterize(const FrameInputs& inputs, Workspace& work);
  void select(const FrameInputs& inputs, int sample, Workspace& work);
  void probe(const FrameInputs& inputs, Workspace& work);
  void trace(const FrameInputs& inputs, Workspace& work);
  void blend(const FrameInputs& inputs, Workspace& work);
  void report(float sample_share);
  void tell(float share, const std::string& status);
  void check_cancelled() const;
  void finish();

  std::shared_ptr<Device> device;
  RtScene rt_scene{device->embree()};
  std::unique_ptr<RasterStage> raster;  // while OpenGL is in use
  PrimaryRays primary_rays{rt_scene};
  LayerRays layer_rays{rt_scene};
  EmbreeTracer embree_tracer{rt_scene};
  HeuristicStage heuristic;
  MotionVectors motion_vectors{rt_scene};
  TraceStage trace_stage{embree_tracer};
  BlendStage blend_stage;
  std::vector<std::string> passes;
  Region wanted_region;
  std::atomic<bool> cancel_requested = false;

  // The frame under way.
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Scene> moment;  // the scene while a sample is taken
  bool moving = false;                  // every sample has a moment of its own
  int width = 0;                        // of the picture
  int height = 0;
  Region region;  // of it that is rendered
  bool rasterises = false;
  tbb::enumerable_thread_specific<Workspace> workspaces;
  Selection selection;
  mutable std::mutex film_mutex;  // held while `film` or `finished` is replaced or copied
  Film film;
  FrameStats stats;
  const Progress* progress = nullptr;
  int samples_done = 0;
  std::atomic<std::chrono::steady_clock::rep> last_report = 0;

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

void Renderer::copy_so_far(std::string_view pass, float* out, size_t float_count) const {
  const std::lock_guard lock(impl_->film_mutex);
  const Film& film = impl_->film.width() > 0 ? impl_->film : impl_->finished;
  if (film.width() == 0) {
    fail(ErrorCode::invalid_operation,
         "There is no frame yet. Call kestrelRender() first, on another thread or before.");
  }
  if (float_count != film.float_count(pass)) {
    fail(ErrorCode::invalid_argument, "Pass '{}' of {} x {} pixels has {} floats, not {}.", pass,
         film.width(), film.height(), film.float_count(pass), float_count);
  }
  film.copy_so_far(pass, out);
}

void Renderer::render_frame(std::shared_ptr<const Scene> scene, int width, int height,
                            const Progress& progress) {
  if (width < 1 || height < 1 || int64_t{width} * height > int64_t{1} << 30) {
    fail(ErrorCode::invalid_argument,
         "A picture of {} x {} pixels cannot be made. Choose from 1 x 1 to 2^30 pixels.", width,
         height);
  }
  Impl& r = *impl_;
  const Region whole{0, 0, width, height};
  const Region region = r.wanted_region.width > 0 ? r.wanted_region : whole;
  if (region.x < 0 || region.y < 0 || region.height < 1 || region.width > width - region.x ||
      region.height > height - region.y) {
    fail(ErrorCode::invalid_argument,
         "The region of {} x {} pixels at ({}, {}) does not lie in the picture of {} x {}. Choose "
         "one that does.",
         region.width, region.height, region.x, region.y, width, height);
  }
  r.cancel_requested = false;
  r.scene = std::move(scene);
  r.width = width;
  r.height = height;
  r.region = region;
  const int threads = r.scene->settings.threads;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] { r.render(progress); });
}

void Renderer::set_region(const Region& region) {
  impl_->wanted_region = region;
}

void Renderer::set_passes(const std::vector<std::string>& names) {
  for (const std::string& name : names) find_pass_row(name);
  impl_->passes = names;
}

void Renderer::Impl::render(const Progress& report_to) {
  stats = {};
  progress = &report_to;
  last_report = 0;
  samples_done = 0;
  for (Workspace& work : workspaces) work.reset();
  {
    const Stopwatch watch(stats.frame_ms);
    choose_primary();
    begin_film();
    prepare();
    for (samples_done = 0; samples_done < scene->settings.samples; ++samples_done) {
      render_sample(samples_done);
    }
  }
  finish();
}

/// The rasteriser draws a part of the picture as a whole one, through a smaller window.
void Renderer::Impl::choose_primary() {
  rasterises = use_raster();
  if (!rasterises || (region.width == width && region.height == height)) return;
  const auto cropped = std::make_shared<Scene>(*scene);
  const auto crop = [this](Camera& camera) {
    const float x = (camera.right - camera.left) / static_cast<float>(width);
    const float y = (camera.top - camera.bottom) / static_cast<float>(height);
    camera.right = camera.left + x * static_cast<float>(region.x + region.width);
    camera.left += x * static_cast<float>(region.x);
    camera.top = camera.bottom + y * static_cast<float>(region.y + region.height);
    camera.bottom += y * static_cast<float>(region.y);
  };
  crop(cropped->camera);
  for (Camera& camera : cropped->camera_motion) crop(camera);
  scene = cropped;
  width = region.width;
  height = region.height;
  region = {0, 0, width, height};
}

void Renderer::Impl::begin_film() {
  Film empty(region, passes, *scene);
  const std::lock_guard lock(film_mutex);
  film = std::move(empty);
}

void Renderer::Impl::render_sample(int sample) {
  const Settings& settings = scene->settings;
  show_moment(sample);
  FrameInputs inputs{*moment,
                     width,
                     height,
                     subpixel_offset(settings, settings.first_sample + sample),
                     settings.budget_ms / static_cast<float>(settings.samples),
                     region};
  inputs.lens = {lens_open(), lens_position(settings.first_sample + sample), !raster};
  inputs.keep_uv = film.has("UV");
  inputs.keep_behind = film.wants_layers();
  if (sample == 0 && !limited()) {
    // Nothing has to be seen for it: as if every object were visible.
    selection = heuristic.select(inputs, Areas(scene->objects.size() + 1, 1));
  }
  if (whole_picture()) {
    Workspace& work = workspaces.local();
    render_region(inputs, sample, work);
    stats.stages += std::exchange(work.times, {});
  } else {
    render_tiles(inputs, sample);
  }
}

void Renderer::Impl::render_tiles(const FrameInputs& picture, int sample) {
  double wall_ms = 0.0;
  {
    const Stopwatch watch(wall_ms);
    std::atomic<int> done = 0;
    const float tiles = static_cast<float>(tile_count(picture.region));
    for_tiles(picture.region, [&](const Region& tile) {
      FrameInputs inputs = picture;
      inputs.region = tile;
      render_region(inputs, sample, workspaces.local());
      report(static_cast<float>(++done) / tiles);
    });
  }
  // The stages ran side by side: each gets its share of the wall time.
  StageTimes threads;
  for (Workspace& work : workspaces) threads += std::exchange(work.times, {});
  stats.stages += threads * (wall_ms / std::max(threads.sum(), 1e-9));
}

/// The four stages, and what becomes of their results.
void Renderer::Impl::render_region(const FrameInputs& inputs, int sample, Workspace& work) {
  rasterize(inputs, work);
  check_cancelled();
  select(inputs, sample, work);
  if (sample == 0 && film.has("Vector")) motion_vectors.run(inputs, work.gbuffer);
  trace(inputs, work);
  blend(inputs, work);
  film.add(inputs, sample, work.gbuffer, work.effects, work.combined);
}

/// Whether the graph decides; else every visible object is traced, or none.
bool Renderer::Impl::limited() const {
  return scene->settings.selection == SelectionPolicy::graph && scene->settings.budget_ms > 0.0f;
}

/// The graph needs to see the whole picture, and so does the rasteriser. Else every thread takes
/// tiles through all stages, so that their data stays in its cache.
bool Renderer::Impl::whole_picture() const {
  return limited() || raster;
}

/// Decides how the frame is made.
void Renderer::Impl::prepare() {
  const Stopwatch watch(stats.stages.update);
  moving = scene->settings.motion_blur && anything_moves(*scene);
  if (!rasterises) {
    raster.reset();
  } else if (!raster) {
    raster = std::make_unique<RasterStage>(device->gl());
  }
  stats.primary = raster ? "raster" : "rays";
  stats.samples = scene->settings.samples;
}

/// Brings what the stages read up to date with the scene as it is when a sample is taken.
void Renderer::Impl::show_moment(int sample) {
  if (sample > 0 && !moving) return;
  const Stopwatch watch(stats.stages.update);
  moment = moving ? scene_at(*scene, shutter_time(scene->settings.first_sample + sample)) : scene;
  rt_scene.update(moment, [this] {
    tell(0.0f, "Building");
    return !cancel_requested;
  });
  if (raster) raster->update(moment);
}

/// One sample cannot show what is out of focus: within a budget it keeps everything sharp.
bool Renderer::Impl::lens_open() const {
  const Settings& settings = scene->settings;
  return has_aperture(scene->camera) && !(settings.samples == 1 && settings.budget_ms > 0.0f);
}

/// On a GPU rasterising is faster; where OpenGL itself runs on the processor, rays are.
bool Renderer::Impl::use_raster() {
  const Primary primary = scene->settings.primary;
  if (primary == Primary::rays) return false;
  if (primary == Primary::automatic && !gl::hardware_available()) return false;
  if (scene->has_programs) {
    log::warning_once(
        "Materials with node programs are not rasterised yet: rays are used instead.");
    return false;
  }
  try {
    return primary == Primary::raster || !device->gl()->info().software;
  } catch (const Error& error) {
    log::warning_once("Rasterising is not possible, rays are used instead: {}", error.what());
    return false;
  }
}

void Renderer::Impl::rasterize(const FrameInputs& inputs, Workspace& work) {
  const Stopwatch watch(work.times.raster);
  if (raster) {
    raster->run(inputs, work.gbuffer);
  } else {
    work.primary_rays += primary_rays.run(inputs, work.gbuffer);
  }
  if (inputs.keep_behind) work.primary_rays += layer_rays.run(inputs, work.gbuffer);
}

/// Decides who is traced, where there is a budget to keep.
void Renderer::Impl::select(const FrameInputs& inputs, int sample, Workspace& work) {
  if (sample > 0) return;
  const Stopwatch watch(work.times.heuristic);
  count_areas(inputs, work.gbuffer, work.areas);
  if (limited()) {
    selection = heuristic.select(inputs, work.areas);
    if (!heuristic.calibrated()) {
      probe(inputs, work);
      selection = heuristic.select(inputs, work.areas);
    }
  }
  write_heuristic_mask(inputs, selection, work.gbuffer);
  if (scene->settings.validate_areas && raster) {
    stats.occlusion_areas = raster->occlusion_areas(inputs);
  }
}

/// Measures what tracing costs here, on few pixels of everything in view.
void Renderer::Impl::probe(const FrameInputs& inputs, Workspace& work) {
  const double pixels = static_cast<double>(inputs.region.pixels());
  const int stride = std::max(1, static_cast<int>(std::sqrt(pixels / kProbePixels)));
  double ms = 0.0;
  TraceCounts counts;
  counts.reset(scene->units.size());
  {
    const Stopwatch watch(ms);
    trace_stage.run({inputs, work.gbuffer, selection, stride, {}, {}}, work.effects, counts);
  }
  heuristic.learn(inputs, selection, counts, ms, 1.0 / (stride * stride));
}

void Renderer::Impl::trace(const FrameInputs& inputs, Workspace& work) {
  const Stopwatch watch(work.times.trace);
  const auto cancelled = [this] { return cancel_requested.load(); };
  TraceRequest request{inputs, work.gbuffer, selection, 1, cancelled, {}};
  if (whole_picture()) request.progress = [this](float share) { report(share); };
  trace_stage.run(request, work.effects, work.counts);
}

void Renderer::Impl::blend(const FrameInputs& inputs, Workspace& work) {
  const Stopwatch watch(work.times.blend);
  blend_stage.run(inputs, work.gbuffer, selection, work.effects, work.combined);
}

/// `sample_share` of the sample under way is done.
void Renderer::Impl::report(float sample_share) {
  const int samples = scene->settings.samples;
  const float share =
      (static_cast<float>(samples_done) + sample_share) / static_cast<float>(samples);
  tell(share, fmt::format("Sample {}/{}", samples_done + 1, samples));
}

/// Tells how far the frame is, now and then.
void Renderer::Impl::tell(float share, const std::string& status) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  auto last = last_report.load();
  if (!*progress || now - decltype(now)(last) < kReportInterval ||
      !last_report.compare_exchange_strong(last, now.count())) {
    return;
  }
  if (!(*progress)(share, status)) cancel_requested = true;
}

void Renderer::Impl::check_cancelled() const {
  if (cancel_requested) fail(ErrorCode::cancelled, "The render was cancelled.");
}

/// Publishes the frame, and lets the heuristic learn from it.
void Renderer::Impl::finish() {
  const FrameInputs inputs{*scene, width, height};
  TraceCounts counts;
  counts.reset(scene->units.size());
  Areas areas(scene->objects.size() + 1, 0);
  for (const Workspace& work : workspaces) {
    counts += work.counts;
    stats.rays.primary += work.primary_rays;
    for (size_t i = 0; i < work.areas.size(); ++i) areas[i] += work.areas[i];
  }
  stats.selection = limited() ? selection : heuristic.select(inputs, areas);
  heuristic.remember(stats.selection);
  heuristic.learn(inputs, stats.selection, counts, stats.stages.trace, stats.samples);
  stats.rays += counts.rays;
  stats.trace_calls_ms = counts.trace_calls_ms;
  {
    const std::lock_guard lock(film_mutex);
    film.finish(stats.samples);
    finished = std::move(film);
    film = {};
  }
  stats_json = to_json(stats, *scene);
  log::info(
      "{}x{}, {} samples, primary {}: {:.1f} ms (update {:.1f}, raster {:.1f}, heuristic "
      "{:.1f}, trace {:.1f}, blend {:.1f})",
      region.width, region.height, stats.samples, stats.primary, stats.frame_ms,
      stats.stages.update, stats.stages.raster, stats.stages.heuristic, stats.stages.trace,
      stats.stages.blend);
}

}  // namespace kestrel
