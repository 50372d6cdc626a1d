// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/parallel.hpp>
#include <utility>

namespace cairn {

/// A value computed concurrently with the caller's own work, on another thread of `exec`; on a single thread,
/// computed by get(). The inputs of `work` must not change meanwhile. `work` is called with an Exec of its
/// own: without an observer, and with its own pool. Of two concurrent Later values, pass exec.beside() to the
/// second.
template <class T>
class Future {
 public:
  template <class Work>
  Future(const Exec& exec, Work work)
      : work_(exec, [this, work = std::move(work), beside = exec.beside()] { value_ = work(beside); }) {}
  /// To be called once. Rethrows the exception of the work.
  T get() {
    work_.wait();
    return std::move(value_);
  }

 private:
  T value_{};
  SideWork work_;  // last member: destroyed first, so the work ends before value_ does
};

}  // namespace cairn
