// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <chrono>
#include <string_view>

namespace cairn {

/// Reports the result of each stage to exec.observe: stage("match", match(...)) returns its argument. The
/// time of a stage runs from the end of the stage before. Does nothing without an observer.
class StageClock {
 public:
  explicit StageClock(const Exec& exec) : observe_(exec.observe) { restart(); }

  template <class T>
  T operator()(std::string_view stage, T value) {
    if (observe_) {
      const std::chrono::duration<double, std::milli> elapsed = Clock::now() - start_;
      observe_(stage, StageResult(value), elapsed.count());
      restart();  // excludes the time of the observer
    }
    return value;
  }

 private:
  using Clock = std::chrono::steady_clock;
  void restart() {
    if (observe_) start_ = Clock::now();
  }
  const Observer& observe_;
  Clock::time_point start_;
};

}  // namespace cairn
