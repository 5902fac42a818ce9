// SPDX-License-Identifier: GPL-3.0-or-later
// The command's subcommands. They return the exit status: 0 done, 1 the user's data is wrong or the
// machine cannot, 2 the command line is wrong, 130 interrupted.
#pragma once

#include <string>
#include <vector>

namespace kestrel::cli {

inline constexpr int kStatusData = 1;
inline constexpr int kStatusUsage = 2;
inline constexpr int kStatusInterrupted = 130;

struct RenderOptions {
  std::string scene;
  std::string output;                 // .exr or .png; #### becomes the frame's number, from 1
  std::string size;                   // empty: the scene's, else 1280x720
  std::vector<std::string> settings;  // NAME=VALUE
  std::string passes = "Combined";
  std::string stats;  // empty: none
  int frames = 1;
};

int run_render(const RenderOptions& options);

/// The machine, or the parameter table, as JSON on standard output.
int run_info(bool settings);

}  // namespace kestrel::cli
