// SPDX-License-Identifier: GPL-3.0-or-later
// The one table of passes: what each is called, and how it comes from a sample of the stages.
#pragma once

#include <string_view>
#include <vector>

#include "frame/camera_rays.h"
#include "frame/cryptomatte.h"
#include "frame/frame.h"

namespace kestrel {

/// A pass: its name and one letter for each channel.
struct PassInfo {
  const char* name;
  const char* channels;
};

/// Every pass, in the order in which hosts list them.
const std::vector<PassInfo>& pass_table();

/// Whether "all" includes a pass: Cryptomatte is as deep as it usually is, with six levels.
bool in_all(const PassInfo& pass);

/// Samples of a region, as the stages left them.
struct PassSource {
  const FrameInputs& inputs;
  const CameraRays& camera;
  const GBuffer& gbuffer;
  const EffectBuffers& effects;
  const Plane<vec4>& combined;
};

/// What becomes of a pixel's samples.
enum class Gathering : uint8_t {
  first,     // the first counts: it lies in the pixel's centre
  averaged,  // all count the same
  matte,     // each adds to the slot of its id
};

/// One line of the table; its place is the one in pass_table().
struct PassRow {
  PassInfo info;
  Gathering gathering;
  void (*get)(const PassSource& from, size_t i, float* out);  // null for Cryptomatte
  MatteKind matte = MatteKind::object;                        // for Cryptomatte
  int depth = 0;                                              // its passes before this one
};
const std::vector<PassRow>& pass_rows();

/// Index in the table. Throws Error(invalid_argument) for a name that is not there.
size_t find_pass_row(std::string_view name);

}  // namespace kestrel
