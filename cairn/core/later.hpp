// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/parallel.hpp>
#include <utility>

namespace cairn {

/// A value that is worked out beside the caller's own work, on another thread of `exec`; where there is none,
/// when it is asked for. What the work reads must stay as it is meanwhile. `work` is called with an Exec to
/// go by: unobserved, and with a pool of its own. Two at the same time need one each: give the second
/// exec.beside().
template <class T>
class Later {
 public:
  template <class Work>
  Later(const Exec& exec, Work work)
      : work_(exec, [this, work = std::move(work), beside = exec.beside()] { value_ = work(beside); }) {}
  /// Once. Throws what the work has thrown.
  T get() {
    work_.wait();
    return std::move(value_);
  }

 private:
  T value_{};
  SideWork work_;  // the last, so that it is over before what it writes to is gone
};

}  // namespace cairn
