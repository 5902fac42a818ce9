// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "cli/commands.h"
#include "cli/handles.h"

namespace kestrel::cli {

int run_info(bool settings) {
  try {
    const auto print = [](const char* text) {
      fmt::print("{}\n", nlohmann::ordered_json::parse(text).dump(2));
    };
    if (settings) {
      print(kestrelGetParameterTable());
      return 0;
    }
    const auto device = owned<DevicePtr>(kestrelNewDevice());
    const char* info = kestrelGetDeviceInfo(device.get());
    if (!info) check(KESTREL_ERROR_UNKNOWN);
    print(info);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "kestrel: {}\n", error.what());
    return kStatusData;
  }
}

}  // namespace kestrel::cli
