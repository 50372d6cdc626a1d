// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/stereo/flatness.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;

bool rejected(float cost, float mean, float threshold) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0}});
  matches.cost = grid<float, float>({{cost}});
  matches.mean_cost = grid<float, float>({{mean}});
  return reject_flat(matches, {threshold}, {})(0, 0) == Reject::flat;
}

TEST(Flatness, RejectsABestCostThatBarelyDipsBelowTheMean) {
  EXPECT_TRUE(rejected(95, 100, 0.1F));
  EXPECT_FALSE(rejected(50, 100, 0.1F));
}
TEST(Flatness, ADipOfExactlyTheThresholdIsDeepEnough) {
  EXPECT_FALSE(rejected(50, 100, 0.5F));
}
TEST(Flatness, AllCandidatesPerfectIsFlat) {
  EXPECT_TRUE(rejected(0, 0, 0.1F));
}
TEST(Flatness, LeavesPixelsWithoutMatchAlone) {
  EXPECT_FALSE(rejected(kNoCost, kNoCost, 0.1F));
}

TEST(Flatness, MinusOneSwitchesItOffAndNeedsNoEvidence) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 1}});
  EXPECT_EQ(numbers(reject_flat(matches, {-1.0F}, {})), (std::vector<std::vector<std::int64_t>>{{0, 0}}));
}

}  // namespace
}  // namespace cairn
