// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <functional>
#include <memory>

namespace cairn {

/// Calls body(first, last) for consecutive ranges that together cover [0, count), on the threads of `exec`.
/// Ranges hold at least `grain` elements (but the last). How the split falls must not change a result.
void parallel_for(const Exec& exec, int count, int grain,
                  const std::function<void(int first, int last)>& body);

/// Work that is done beside the caller's own, on another thread of `exec`; where there is none, when it is
/// waited for. It must not take images from the pool that the caller takes some from meanwhile: how many a
/// frame needs would depend on who comes first. See Pool::beside().
class SideWork {
 public:
  SideWork(const Exec& exec, std::function<void()> work);
  /// Waits, too, if nobody has. What has not begun by then never does.
  ~SideWork();
  SideWork(const SideWork&) = delete;
  SideWork& operator=(const SideWork&) = delete;
  /// Once. Throws what the work has thrown.
  void wait();

 private:
  class Running;
  std::function<void()> work_;        // that nobody has begun
  std::unique_ptr<Running> running_;  // none where there is one thread
};

}  // namespace cairn
