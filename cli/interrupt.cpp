// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "interrupt.hpp"

#include <atomic>
#include <csignal>

namespace cairn::cli {
namespace {

// Written by a signal handler, read by any thread: what is not atomic would be a race, what takes a lock could wait for
// itself.
std::atomic<bool> interrupted = false;
std::atomic<void (*)()> also_done = nullptr;
static_assert(decltype(interrupted)::is_always_lock_free && decltype(also_done)::is_always_lock_free);

extern "C" void on_interrupt(int signal) {
  interrupted = true;
  if (void (*const also)() = also_done) also();
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::signal(SIGPIPE, SIG_IGN);
}

void on_interrupt_also(void (*also)()) {
  also_done = also;
}

bool is_interrupted() {
  return interrupted;
}

}  // namespace cairn::cli
