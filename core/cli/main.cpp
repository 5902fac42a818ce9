// SPDX-License-Identifier: GPL-3.0-or-later
// The kestrel command: renders scene files, and tells about the machine and the settings.
#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "kestrel/kestrel.h"

namespace {

void add_render(CLI::App& app, kestrel::cli::RenderOptions& options) {
  CLI::App* render = app.add_subcommand("render", "Render a scene file into a picture");
  render->add_option("scene", options.scene, "The scene file (*.kscene)")->required();
  render
      ->add_option("-o,--output", options.output,
                   "The picture: .exr (linear, one layer a pass) or .png (sRGB); #### becomes the "
                   "frame's number")
      ->required();
  render->add_option("--size", options.size,
                     "Width and height in pixels; where left out, the scene's own, or 1280x720");
  render
      ->add_option("--set", options.settings,
                   "A setting, NAME=VALUE; may be repeated (kestrel info --settings lists them)")
      ->expected(1)
      ->take_all();
  render->add_option("--passes", options.passes, "Passes to write, separated by commas, or all")
      ->capture_default_str();
  render->add_option("--stats", options.stats, "Write times, rays and selections as JSON");
  render
      ->add_option("--frames", options.frames,
                   "Render so many frames, along the camera's path where the scene has one")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Kestrel: rasterises everything and ray traces what matters most");
  app.set_version_flag("--version", std::string("kestrel ") + kestrelGetVersion());
  app.require_subcommand(1);
  kestrel::cli::RenderOptions render_options;
  add_render(app, render_options);
  CLI::App* info = app.add_subcommand("info", "Print versions and the OpenGL device as JSON");
  bool settings = false;
  info->add_flag("--settings", settings, "Print the table of all settings instead");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kestrel::cli::kStatusUsage;
  }
  if (kestrelGetAbiVersion() != KESTREL_ABI_VERSION) {
    std::cerr << "kestrel: libkestrel.so has ABI " << kestrelGetAbiVersion()
              << ", the command needs " << KESTREL_ABI_VERSION << "; install both from one build\n";
    return kestrel::cli::kStatusData;
  }
  return info->parsed() ? kestrel::cli::run_info(settings)
                        : kestrel::cli::run_render(render_options);
}
