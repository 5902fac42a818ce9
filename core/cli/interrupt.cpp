// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

namespace kestrel::cli {
namespace {

constexpr int kInterruptedStatus = 130;            // 128 + SIGINT, as shells expect
constexpr timespec kPollInterval = {0, 50000000};  // how soon the watching thread ends

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { wait_for_signals(); });
}

Interrupt::~Interrupt() {
  ends_ = true;
  thread_.join();
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void Interrupt::set_renderer(KestrelRenderer renderer) {
  const std::lock_guard lock(mutex_);
  renderer_ = renderer;
}

void Interrupt::wait_for_signals() {
  const sigset_t set = watched_signals();
  while (!ends_) {
    if (sigtimedwait(&set, nullptr, &kPollInterval) < 0) continue;
    const std::lock_guard lock(mutex_);
    if (!renderer_ || requested_) _exit(kInterruptedStatus);
    requested_ = true;
    kestrelCancel(renderer_);
  }
}

}  // namespace kestrel::cli
