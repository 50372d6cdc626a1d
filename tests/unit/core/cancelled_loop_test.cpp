// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Built with oneTBB only: behaviour inside a user's own oneTBB loops.
#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <cairn/core/parallel.hpp>

namespace cairn {
namespace {

TEST(ParallelFor, CompletesInsideACancelledLoopOfTheCaller) {
  const Exec exec = Exec::with_threads(2);
  std::atomic<int> visits = 0;
  std::atomic<int> beside = 0;
  oneapi::tbb::task_group_context users;
  oneapi::tbb::parallel_for(
      0, 1,
      [&](int) {
        users.cancel_group_execution();
        parallel_for(exec, 1000, 1, [&](int first, int last) { visits += last - first; });
        SideWork work(exec, [&] { ++beside; });
        work.wait();
      },
      users);
  EXPECT_EQ(visits, 1000);
  EXPECT_EQ(beside, 1);
}

}  // namespace
}  // namespace cairn
