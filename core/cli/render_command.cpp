// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "cli/camera.h"
#include "cli/commands.h"
#include "cli/handles.h"
#include "cli/interrupt.h"

namespace kestrel::cli {
namespace {

/// The command line is wrong.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using Setting = std::pair<std::string, std::string>;

struct Size {
  int width = 0;   // pixels
  int height = 0;  // pixels
};

constexpr Size kDefaultSize{1280, 720};

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

Size parse_size(const std::string& text) {
  Size size;
  const char* end = text.data() + text.size();
  const auto [middle, error] = std::from_chars(text.data(), end, size.width);
  const bool has_height = error == std::errc() && middle != end && *middle == 'x';
  const auto last = has_height ? std::from_chars(middle + 1, end, size.height).ptr : nullptr;
  if (last != end || size.width < 1 || size.height < 1 || size.width > 65536 ||
      size.height > 65536) {
    throw UsageError(
        fmt::format("--size: '{}' is no size; write WIDTHxHEIGHT, each from 1 to "
                    "65536, like 1280x720",
                    text));
  }
  return size;
}

/// NAME=VALUE pairs, tried out on an empty scene so that a typing error shows at once.
std::vector<Setting> parse_set_options(const std::vector<std::string>& options,
                                       KestrelDevice device) {
  const auto scratch = owned<ScenePtr>(kestrelNewScene(device));
  std::vector<Setting> settings;
  for (const std::string& option : options) {
    const size_t equals = option.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError(fmt::format("--set: '{}' is not of the form NAME=VALUE", option));
    }
    settings.emplace_back(option.substr(0, equals), option.substr(equals + 1));
    try {
      check(kestrelSetSetting(scratch.get(), settings.back().first.c_str(),
                              settings.back().second.c_str()));
    } catch (const std::runtime_error& error) {
      throw UsageError(fmt::format("--set {}: {}", option, error.what()));
    }
  }
  return settings;
}

void expect_writable(const std::string& path, const char* option) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored) || access(folder.c_str(), W_OK) != 0) {
    throw UsageError(
        fmt::format("{}: the folder '{}' is missing or not writable", option, folder.string()));
  }
}

void expect_output(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".exr" && extension != ".png") {
    throw UsageError(fmt::format("-o: '{}' must end in .exr or .png", path));
  }
  expect_writable(path, "-o");
}

/// The longest run of # as the frame's number, padded with zeros to the run's length.
std::string output_name(const std::string& pattern, int frame) {
  const size_t first = pattern.find('#');
  if (first == std::string::npos) return pattern;
  size_t count = 0;
  while (first + count < pattern.size() && pattern[first + count] == '#') ++count;
  return pattern.substr(0, first) + fmt::format("{:0{}}", frame, count) +
         pattern.substr(first + count);
}

/// One line on a terminal, rewritten in place; nothing where standard error is a file or a pipe.
class ProgressLine {
 public:
  explicit ProgressLine(int frames) : frames_(frames), shown_(isatty(STDERR_FILENO)) {}
  ~ProgressLine() {
    if (shown_) std::fputs("\r\033[K", stderr);
  }
  void begin_frame(int frame) { frame_ = frame; }
  void show(float fraction, const char* status) const {
    if (!shown_) return;
    fmt::print(stderr, "\r\033[KFrame {}/{}  {:3.0f} %  {}", frame_, frames_, 100.0f * fraction,
               status ? status : "");
    std::fflush(stderr);
  }

 private:
  int frames_;
  int frame_ = 1;
  bool shown_;
};

struct Progress {
  const ProgressLine* line;
  const Interrupt* interrupt;
};

bool on_progress(void* user, float fraction, const char* status) {
  const auto* progress = static_cast<const Progress*>(user);
  progress->line->show(fraction, status);
  return !progress->interrupt->requested();
}

/// Renders all frames; returns their statistics.
nlohmann::ordered_json render_frames(const RenderOptions& options, const Size& size,
                                     const SceneDescription& description, KestrelScene scene,
                                     Interrupt& interrupt) {
  const auto renderer = owned<RendererPtr>(kestrelNewRenderer(scene));
  check(kestrelSetPasses(renderer.get(), options.passes.c_str()));
  check(kestrelSetPasses(renderer.get(), options.passes.c_str()));
  ProgressLine line(options.frames);
  Progress progress{&line, &interrupt};
  const bool moves = options.frames > 1 && !description.camera.path.empty();
  const bool every_frame = options.output.find('#') != std::string::npos;
  auto frames = nlohmann::ordered_json::array();
  for (int frame = 1; frame <= options.frames; ++frame) {
    if (moves) {
      const double fraction = static_cast<double>(frame - 1) / (options.frames - 1);
      const KestrelCamera camera =
          camera_on_path(description.camera, fraction, size.width, size.height);
      check(kestrelSetCamera(scene, &camera));
      check(kestrelCommitScene(scene));
    }
    line.begin_frame(frame);
    interrupt.set_renderer(renderer.get());
    const KestrelError error =
        kestrelRender(renderer.get(), size.width, size.height, on_progress, &progress);
    interrupt.set_renderer(nullptr);
    check(error);
    frames.push_back(nlohmann::ordered_json::parse(kestrelGetStats(renderer.get())));
    if (every_frame || frame == options.frames) {
      check(kestrelWriteImage(renderer.get(), output_name(options.output, frame).c_str(),
                              options.passes.c_str()));
    }
  }
  return frames;
}

void write_stats(const std::string& path, double load_ms, nlohmann::ordered_json frames) {
  const nlohmann::ordered_json stats = {{"load_ms", load_ms}, {"frames", std::move(frames)}};
  std::ofstream stream(path);
  stream << stats.dump(1) << '\n';
  stream.close();
  if (!stream) throw std::runtime_error(fmt::format("'{}' cannot be written", path));
}

void render(const RenderOptions& options, Interrupt& interrupt) {
  Size size;
  if (!options.size.empty()) size = parse_size(options.size);
  expect_output(options.output);
  if (!options.stats.empty()) expect_writable(options.stats, "--stats");
  const auto device = owned<DevicePtr>(kestrelNewDevice());
  const std::vector<Setting> overrides = parse_set_options(options.settings, device.get());
  const auto start = std::chrono::steady_clock::now();
  SceneDescription description = read_scene_file(options.scene);
  if (!size.width) size = {description.width, description.height};
  if (!size.width) size = kDefaultSize;
  description.settings.insert(description.settings.end(), overrides.begin(), overrides.end());
  const auto scene = owned<ScenePtr>(kestrelNewScene(device.get()));
  try {
    fill_scene(description, size.width, size.height, scene.get());
  } catch (const std::runtime_error& error) {
    throw SceneFileError(options.scene, "", error.what());
  }
  // Frames need the camera and its path only.
  description.meshes.clear();
  description.objects.clear();
  const double load_ms = milliseconds_since(start);
  auto frames = render_frames(options, size, description, scene.get(), interrupt);
  if (!options.stats.empty()) write_stats(options.stats, load_ms, std::move(frames));
}

}  // namespace

int run_render(const RenderOptions& options) {
  Interrupt interrupt;
  try {
    render(options, interrupt);
    return 0;
  } catch (const UsageError& error) {
    fmt::print(stderr, "kestrel: {}\n", error.what());
    return kStatusUsage;
  } catch (const std::exception& error) {
    if (interrupt.requested()) {
      fmt::print(stderr, "kestrel: interrupted\n");
      return kStatusInterrupted;
    }
    fmt::print(stderr, "kestrel: {}\n", error.what());
    return kStatusData;
  }
}

}  // namespace kestrel::cli
