// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C and a polite kill stop the render, not the process in the middle of a file.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>

#include "kestrel/kestrel.h"

namespace kestrel::cli {

/// While it lives SIGINT and SIGTERM call kestrelCancel() on the renderer that is set. Where none
/// is set, and on the second signal, they end the process at once with status 130. Construct it
/// before any other thread is started, so that all threads inherit the blocked signals.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// NULL: no render is under way.
  void set_renderer(KestrelRenderer renderer);
  bool requested() const { return requested_; }

 private:
  void wait_for_signals();

  std::atomic<bool> requested_{false};
  std::atomic<bool> ends_{false};
  std::mutex mutex_;
  KestrelRenderer renderer_ = nullptr;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace kestrel::cli
