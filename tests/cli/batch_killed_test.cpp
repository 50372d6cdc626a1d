// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "command.hpp"

namespace cairn::command {
namespace {

class BatchKilled : public CommandTest {
 protected:
  [[nodiscard]] pid_t begin() const {
    const std::string folder = path("run");
    const pid_t child = ::fork();
    if (child != 0) return child;
    const int nothing = ::open("/dev/null", O_RDWR);
    ::dup2(nothing, STDOUT_FILENO);
    ::execl(CAIRN_COMMAND, CAIRN_COMMAND, "batch", "work", folder.c_str(), "--threads", "1", nullptr);
    ::_exit(127);
  }
};

// A worker killed at any moment (SIGKILL, which cannot be handled) and restarted, fifty times.
TEST_F(BatchKilled, HasTheRowsOfAnUndisturbedRun) {
  constexpr int kFrames = 12;
  constexpr int kKills = 50;
  for (int i = 0; i < kFrames; ++i) pair_in("in/" + std::to_string(100 + i), {96 + i, 72});
  ASSERT_EQ(run({"batch", "plan", path("in"), "-o", path("alone")}).code, 0);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run({"batch", "work", path("alone"), "--threads", "1"}).code, 0);
  const auto whole = std::chrono::steady_clock::now() - start;
  ASSERT_EQ(run({"batch", "merge", path("alone"), "-o", path("expected")}).code, 0);
  const std::string expected = content(at("expected"));

  ASSERT_EQ(run({"batch", "plan", path("in"), "-o", path("run")}).code, 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 0.7);
  int killed = 0;
  int finished = 0;
  while (killed < kKills) {
    const pid_t child = begin();
    std::this_thread::sleep_for(whole * share(random));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      ++killed;
      continue;
    }
    // The shard was completed: start over.
    ASSERT_EQ(WEXITSTATUS(status), 0);
    ++finished;
    ASSERT_EQ(run({"batch", "merge", path("run"), "-o", path("rows")}).code, 0);
    EXPECT_EQ(content(at("rows")), expected) << "after " << killed << " kills";
    fs::remove_all(at("run/parts"));
  }
  ASSERT_EQ(run({"batch", "work", path("run")}).code, 0);
  ASSERT_EQ(run({"batch", "merge", path("run"), "-o", path("rows")}).code, 0);
  EXPECT_EQ(content(at("rows")), expected);
  EXPECT_GE(finished, 1) << "no worker was ever resumed to its end";
  EXPECT_EQ(std::distance(fs::directory_iterator(at("run/parts")), {}), 1);
}

}  // namespace
}  // namespace cairn::command
