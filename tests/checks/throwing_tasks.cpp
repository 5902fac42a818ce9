// SPDX-License-Identifier: GPL-3.0-or-later
// A library as libkestrel.so is, with exceptions that TBB carries from its tasks to the caller; for
// bundle_api.py, which bundles it and calls it.
#include <tbb/parallel_for.h>

#include <atomic>
#include <stdexcept>
#include <string>

/// How many of 100 exceptions thrown in tasks arrived with their type and text.
extern "C" __attribute__((visibility("default"))) int kestrel_test_throwing_tasks() {
  int arrived = 0;
  for (int round = 0; round < 100; ++round) {
    try {
      tbb::parallel_for(0, 1000, [&](int index) {
        if (index == round * 7) throw std::out_of_range("task " + std::to_string(index));
      });
    } catch (const std::out_of_range& error) {
      arrived += error.what() == "task " + std::to_string(round * 7) ? 1 : 0;
    }
  }
  return arrived;
}
