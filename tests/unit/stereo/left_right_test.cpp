// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/stereo/left_right.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;

constexpr int kNone = kNoMatch;
constexpr int kRejected = static_cast<int>(Reject::left_right);

/// A box of disparity 3 in front of a wall of 1, in one row: left pixels 3 … 5 show the box, which hides what
/// left pixels 1 and 2 show from the right camera; their winners are wrong.
Matches box_before_wall() {
  Matches matches;
  matches.best = grid<std::int16_t>({{kNone, 1, 1, 3, 3, 3, 1, 1}});
  matches.best_right = grid<std::int16_t>({{3, 3, 3, 1, 1, 1, 1, 1}});
  matches.cost = grid<float>({{0, 9, 9, 1, 1, 1, 1, 1}});
  return matches;
}

TEST(LeftRight, RejectsPixelsHiddenFromTheRightCamera) {
  const auto rejected = reject_inconsistent(box_before_wall(), {1.0F, LeftRightMethod::right_winner}, {});
  EXPECT_EQ(numbers(rejected),
            (std::vector<std::vector<std::int64_t>>{{0, kRejected, kRejected, 0, 0, 0, 0, 0}}));
}

TEST(LeftRight, VotingGivesTheSame) {
  const auto rejected = reject_inconsistent(box_before_wall(), {1.0F, LeftRightMethod::vote}, {});
  EXPECT_EQ(numbers(rejected),
            (std::vector<std::vector<std::int64_t>>{{0, kRejected, kRejected, 0, 0, 0, 0, 0}}));
}

TEST(LeftRight, OfEquallyCheapVotesTheSmallestDisparityCounts) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 0, 2}});  // pixels 0 and 2 both claim the right pixel 0
  matches.cost = grid<float>({{1, 1, 1}});
  const auto rejected = reject_inconsistent(matches, {0.0F, LeftRightMethod::vote}, {});
  EXPECT_EQ(numbers(rejected), (std::vector<std::vector<std::int64_t>>{{0, 0, kRejected}}));
}

TEST(LeftRight, AllowsTheGivenDifferenceAndNoMore) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 0, 0}});
  matches.best_right = grid<std::int16_t>({{-1, 2, 0}});
  EXPECT_EQ(numbers(reject_inconsistent(matches, {1.9F, LeftRightMethod::right_winner}, {})),
            (std::vector<std::vector<std::int64_t>>{{0, kRejected, 0}}));
  EXPECT_EQ(numbers(reject_inconsistent(matches, {0.0F, LeftRightMethod::right_winner}, {})),
            (std::vector<std::vector<std::int64_t>>{{kRejected, kRejected, 0}}));
}

TEST(LeftRight, LooksInTheRowInWhichTheMatchWasFound) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 1}, {0, 0}});
  matches.best_right = grid<std::int16_t>({{5, 5}, {1, 0}});
  matches.row_offset = grid<std::int8_t>({{1, 1}, {-1, 0}});
  EXPECT_EQ(numbers(reject_inconsistent(matches, {0.0F, LeftRightMethod::right_winner}, {})),
            (std::vector<std::vector<std::int64_t>>{{kRejected, 0}, {kRejected, 0}}));
}

TEST(LeftRight, MinusOneSwitchesItOffAndNeedsNoEvidence) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 1}});
  EXPECT_EQ(numbers(reject_inconsistent(matches, {-1.0F, LeftRightMethod::right_winner}, {})),
            (std::vector<std::vector<std::int64_t>>{{0, 0}}));
}

}  // namespace
}  // namespace cairn
