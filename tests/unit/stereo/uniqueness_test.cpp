// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/stereo/uniqueness.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;

Matches costs(float cost, float runner_up) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0}});
  matches.cost = grid<float, float>({{cost}});
  matches.runner_up = grid<float, float>({{runner_up}});
  return matches;
}

bool rejected(float cost, float runner_up, float ratio) {
  return reject_ambiguous(costs(cost, runner_up), {ratio}, {})(0, 0) == Reject::not_unique;
}

TEST(Uniqueness, RejectsAWinnerWhoseRunnerUpIsNearlyAsCheap) {
  EXPECT_TRUE(rejected(90.5F, 100, 10));
  EXPECT_FALSE(rejected(89.5F, 100, 10));
}
TEST(Uniqueness, KeepsAWinnerThatBeatsItsRunnerUpByExactlyTheRatio) {
  EXPECT_FALSE(rejected(90, 100, 10));
}
TEST(Uniqueness, RatioZeroKeepsTies) {
  EXPECT_FALSE(rejected(7, 7, 0));
}
TEST(Uniqueness, ASingleCandidateIsUniqueWhateverTheRatio) {
  EXPECT_FALSE(rejected(5, kNoCost, 10));
  EXPECT_FALSE(rejected(5, kNoCost, 100));
}
TEST(Uniqueness, LeavesPixelsWithoutMatchAlone) {
  EXPECT_FALSE(rejected(kNoCost, kNoCost, 10));
}

TEST(Uniqueness, MinusOneSwitchesItOffAndNeedsNoEvidence) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 1}});
  EXPECT_EQ(numbers(reject_ambiguous(matches, {-1.0F}, {})),
            (std::vector<std::vector<std::int64_t>>{{0, 0}}));
}

}  // namespace
}  // namespace cairn
