// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <functional>
#include <memory>

namespace cairn {

/// Calls body(first, last) for consecutive ranges that together cover [0, count), on the threads of `exec`.
/// Every range but the last holds at least `grain` elements. Results must not depend on the split.
void parallel_for(const Exec& exec, int count, int grain,
                  const std::function<void(int first, int last)>& body);

/// Work done concurrently with the caller's own, on another thread of `exec`; on a single thread, done by
/// wait(). It must not allocate from the pool that the caller allocates from: the number of buffers per frame
/// would depend on timing. See Pool::beside().
class SideWork {
 public:
  SideWork(const Exec& exec, std::function<void()> work);
  /// Waits unless wait() was called. Work that has not begun by then is dropped.
  ~SideWork();
  SideWork(const SideWork&) = delete;
  SideWork& operator=(const SideWork&) = delete;
  /// To be called once. Rethrows the exception of the work.
  void wait();

 private:
  class Running;
  std::function<void()> work_;        // not yet begun
  std::unique_ptr<Running> running_;  // null on a single thread
};

}  // namespace cairn
