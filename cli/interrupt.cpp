// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "interrupt.hpp"

#include <atomic>
#include <csignal>

namespace cairn::cli {
namespace {

volatile std::sig_atomic_t interrupted = 0;
std::atomic<void (*)()> also_done = nullptr;

extern "C" void on_interrupt(int signal) {
  interrupted = 1;
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
  return interrupted != 0;
}

}  // namespace cairn::cli
