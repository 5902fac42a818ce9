// SPDX-License-Identifier: GPL-3.0-or-later
// kestrel.h: rendering.
#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "api/errors.h"
#include "api/handles.h"
#include "images/images.h"

using namespace kestrel;
using namespace kestrel::api;

namespace {

constexpr int kMaxSide = 65536;  // pixels

[[noreturn]] void refuse_while_rendering() {
  fail(ErrorCode::invalid_operation,
       "The renderer is busy with a frame. Wait for it, or stop it with kestrelCancel().");
}

/// Has the renderer to itself while it lives. Refused where another frame is under way.
class RenderScope {
 public:
  explicit RenderScope(RendererState& state) : state_(state) {
    std::unique_lock lock(state.mutex);
    if (state.rendering) refuse_while_rendering();
    state.rendering = true;
    state.cancelled = false;
    state.readers_left.wait(lock, [&] { return state.readers == 0; });
  }
  ~RenderScope() {
    const std::lock_guard lock(state_.mutex);
    state_.rendering = false;
  }
  RenderScope(const RenderScope&) = delete;
  RenderScope& operator=(const RenderScope&) = delete;

 private:
  RendererState& state_;
};

/// The last frame stays as it is while this lives. Refused while a frame is under way, and before
/// the first one.
class ReadScope {
 public:
  explicit ReadScope(RendererState& state) : state_(state) {
    const std::lock_guard lock(state.mutex);
    if (state.rendering) refuse_while_rendering();
    if (film().width() == 0) {
      fail(ErrorCode::invalid_operation,
           "There is no frame yet. Call kestrelRender() first, and check that it succeeds.");
    }
    ++state.readers;
  }
  ~ReadScope() {
    const std::lock_guard lock(state_.mutex);
    --state_.readers;
    state_.readers_left.notify_all();
  }
  ReadScope(const ReadScope&) = delete;
  ReadScope& operator=(const ReadScope&) = delete;

  const Film& film() const { return state_.renderer.film(); }
  const std::string& stats_json() const { return state_.renderer.stats_json(); }

 private:
  RendererState& state_;
};

bool is_cancelled(RendererState& state) {
  const std::lock_guard lock(state.mutex);
  return state.cancelled;
}

std::shared_ptr<const Scene> published_scene(SceneState& state) {
  const std::lock_guard lock(state.published_mutex);
  if (!state.published) {
    fail(ErrorCode::invalid_operation,
         "The scene was never committed. Call kestrelCommitScene() before kestrelRender().");
  }
  return state.published;
}

const PassInfo& find_pass(std::string_view name) {
  std::string known;
  for (const PassInfo& pass : pass_table()) {
    if (name == pass.name) return pass;
    known += (known.empty() ? "" : ", ") + std::string(pass.name);
  }
  fail(ErrorCode::invalid_argument, "There is no pass '{}'. Passes are: {}.", name, known);
}

/// "Combined,Depth" or "all", each at most once.
std::vector<const PassInfo*> parse_passes(std::string_view text) {
  std::vector<const PassInfo*> passes;
  if (text == "all") {
    for (const PassInfo& pass : pass_table()) {
      if (in_all(pass)) passes.push_back(&pass);
    }
    return passes;
  }
  while (true) {
    const size_t comma = std::min(text.find(','), text.size());
    const PassInfo* pass = &find_pass(text.substr(0, comma));
    if (std::find(passes.begin(), passes.end(), pass) == passes.end()) passes.push_back(pass);
    if (comma == text.size()) return passes;
    text.remove_prefix(comma + 1);
  }
}

MatteKind matte_kind(std::string_view layer) {
  for (const MatteKind kind : {MatteKind::object, MatteKind::material, MatteKind::asset}) {
    if (layer == matte_layer(kind)) return kind;
  }
  fail(ErrorCode::invalid_argument,
       "'{}' is no layer of Cryptomatte. There are CryptoObject, CryptoMaterial and CryptoAsset.",
       layer);
}

}  // namespace

KestrelRenderer kestrelNewRenderer(KestrelScene scene) {
  return guarded_or(KestrelRenderer{nullptr}, [&] {
    return renderers().insert(std::make_shared<RendererState>(scenes().get(scene)));
  });
}

void kestrelRetainRenderer(KestrelRenderer renderer) {
  guarded([&] { renderers().retain(renderer); });
}

void kestrelReleaseRenderer(KestrelRenderer renderer) {
  guarded([&] { renderers().release(renderer); });
}

KestrelError kestrelRender(KestrelRenderer renderer, int width, int height,
                           KestrelProgressCallback progress, void* user) {
  return guarded([&] {
    const auto state = renderers().get(renderer);
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
      fail(ErrorCode::invalid_argument,
           "A picture of {} x {} pixels is not supported. Use 1 to {} on each side.", width, height,
           kMaxSide);
    }
    const auto scene = published_scene(*state->scene);
    const RenderScope scope(*state);
    // Also tells a renderer that had not begun yet when kestrelCancel() was called.
    const Progress report = [&](float fraction, std::string_view status) {
      if (is_cancelled(*state)) return false;
      return !progress || progress(user, fraction, std::string(status).c_str());
    };
    state->renderer.render_frame(scene, width, height, report);
  });
}

void kestrelCancel(KestrelRenderer renderer) {
  guarded([&] {
    const auto state = renderers().get(renderer);
    const std::lock_guard lock(state->mutex);
    if (!state->rendering) return;
    state->cancelled = true;
    state->renderer.cancel();
  });
}

KestrelError kestrelReadPassSoFar(KestrelRenderer renderer, const char* name, float* pixels,
                                  size_t float_count) {
  return guarded([&] {
    const auto state = renderers().get(renderer);
    const PassInfo& pass = find_pass(require(name, "name"));
    state->renderer.copy_so_far(pass.name, require(pixels, "pixels"), float_count);
  });
}

KestrelError kestrelGetFrameSize(KestrelRenderer renderer, int* width, int* height) {
  return guarded([&] {
    const auto state = renderers().get(renderer);
    require(width, "width");
    require(height, "height");
    const ReadScope frame(*state);
    const Film& film = frame.film();
    *width = film.width();
    *height = film.height();
  });
}

size_t kestrelGetPassCount(KestrelRenderer renderer) {
  return guarded_or(size_t{0}, [&] {
    renderers().get(renderer);
    return pass_table().size();
  });
}

const char* kestrelGetPassName(KestrelRenderer renderer, size_t index) {
  return guarded_or(static_cast<const char*>(nullptr), [&] {
    renderers().get(renderer);
    if (index >= pass_table().size()) {
      fail(ErrorCode::invalid_argument, "There is no pass number {}; there are {}, from 0 on.",
           index, pass_table().size());
    }
    return pass_table()[index].name;
  });
}

const char* kestrelGetPassChannels(KestrelRenderer renderer, const char* name) {
  return guarded_or(static_cast<const char*>(nullptr), [&] {
    renderers().get(renderer);
    return find_pass(require(name, "name")).channels;
  });
}

KestrelError kestrelSetPasses(KestrelRenderer renderer, const char* passes) {
  return guarded([&] {
    const auto state = renderers().get(renderer);
    std::vector<std::string> names;
    for (const PassInfo* pass : parse_passes(require(passes, "passes"))) {
      names.emplace_back(pass->name);
    }
    const std::lock_guard lock(state->mutex);
    if (state->rendering) refuse_while_rendering();
    state->renderer.set_passes(names);
  });
}

KestrelError kestrelReadPass(KestrelRenderer renderer, const char* name, float* pixels,
                             size_t float_count) {
  return guarded([&] {
    const auto state = renderers().get(renderer);
    const PassInfo& pass = find_pass(require(name, "name"));
    require(pixels, "pixels");
    const ReadScope frame(*state);
    const Film& film = frame.film();
    const size_t channels = std::strlen(pass.channels);
    const size_t expected =
        channels * static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
    if (float_count != expected) {
      fail(ErrorCode::invalid_argument,
           "Pass '{}' has {} x {} pixels with {} channels: {} floats, not {}.", name, film.width(),
           film.height(), channels, expected, float_count);
    }
    std::copy_n(film.data(pass.name), expected, pixels);
  });
}

const float* kestrelGetPassPixels(KestrelRenderer renderer, const char* name) {
  return guarded_or(static_cast<const float*>(nullptr), [&] {
    const auto state = renderers().get(renderer);
    const PassInfo& pass = find_pass(require(name, "name"));
    const ReadScope frame(*state);
    return frame.film().data(pass.name);
  });
}

uint32_t kestrelGetCryptomatteHash(const char* name) {
  return guarded_or(uint32_t{0}, [&] { return murmur_hash3(require(name, "name")); });
}

const char* kestrelGetCryptomatteManifest(KestrelRenderer renderer, const char* layer) {
  return guarded_or(static_cast<const char*>(nullptr), [&] {
    thread_local std::string manifest;
    const auto state = renderers().get(renderer);
    const MatteKind kind = matte_kind(require(layer, "layer"));
    const ReadScope frame(*state);
    const std::string* found = frame.film().manifest(kind);
    if (!found) {
      fail(ErrorCode::invalid_operation,
           "The last frame kept no pass of '{}'. Ask for '{}00' with kestrelSetPasses().", layer,
           layer);
    }
    manifest = *found;
    return manifest.c_str();
  });
}

const char* kestrelGetStats(KestrelRenderer renderer) {
  return guarded_or(static_cast<const char*>(nullptr), [&] {
    thread_local std::string stats;
    const auto state = renderers().get(renderer);
    const ReadScope frame(*state);
    stats = frame.stats_json();
    return stats.c_str();
  });
}

KestrelError kestrelWriteImage(KestrelRenderer renderer, const char* path, const char* passes) {
  return guarded([&] {
    const auto state = renderers().get(renderer);
    require(path, "path");
    const auto chosen = parse_passes(require(passes, "passes"));
    const ReadScope frame(*state);
    const Film& film = frame.film();
    std::vector<images::Layer> layers;
    for (const PassInfo* pass : chosen) {
      if (std::string_view(passes) == "all" && !film.has(pass->name)) continue;
      layers.push_back({pass->name, pass->channels, film.data(pass->name)});
    }
    images::write_file(path, film.width(), film.height(), layers, film.matte_attributes());
  });
}
