// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/stereo/match.hpp>
#include <cmath>

#include "support/synthetic_scene.hpp"

namespace {

using namespace cairn;

Image<Gray> picture(std::initializer_list<std::initializer_list<int>> rows) {
  Image<Gray> image({static_cast<int>(rows.begin()->size()), static_cast<int>(rows.size())});
  int y = 0;
  for (const auto& row : rows) {
    std::transform(row.begin(), row.end(), image.row(y++), [](int grey) { return static_cast<Gray>(grey); });
  }
  return image;
}

TEST(Match, ComparesTheWindowWithTheOneDisparityPixelsToTheLeft) {
  // The bright pixel is at x = 3 on the left, at x = 1 on the right: disparity 2.
  const auto left = picture({{0, 0, 0, 90, 0, 0}, {0, 0, 0, 90, 0, 0}, {0, 0, 0, 90, 0, 0}});
  const auto right = picture({{0, 90, 0, 0, 0, 0}, {0, 90, 0, 0, 0, 0}, {0, 90, 0, 0, 0, 0}});
  const Matches matches = match_windows(StereoPair::from(left, right),
                                        {.cost = Cost::sad, .window_size = 3, .num_disparities = 4}, {});
  EXPECT_EQ(matches.best(3, 1), 2);
  EXPECT_EQ(matches.cost(3, 1), 0.0F);
  // At d = 1 and 3 each bright column of three meets a dark one; at d = 0 the right one is outside the
  // window.
  EXPECT_EQ(matches.cost_before(3, 1), 540.0F);
  EXPECT_EQ(matches.cost_after(3, 1), 540.0F);
  EXPECT_EQ(matches.runner_up(3, 1), 270.0F);  // d = 0, the only one more than 1 away
  EXPECT_EQ(matches.mean_cost(3, 1), (270.0F + 540.0F + 0.0F + 540.0F) / 4);
  EXPECT_EQ(matches.best_right(1, 1), 2);
}

TEST(Match, CutsTheWindowAtTheBorder) {
  const auto left = picture({{10, 20}, {30, 40}});
  const auto right = picture({{11, 22}, {33, 44}});
  const Matches matches = match_windows(StereoPair::from(left, right),
                                        {.cost = Cost::sad, .window_size = 3, .num_disparities = 1}, {});
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) EXPECT_EQ(matches.cost(x, y), 1 + 2 + 3 + 4);
  }
}

TEST(Match, MarksPixelsWithoutCandidates) {
  const auto dots = synthetic::random_dots({8, 4}, 1);
  const Matches matches =
      match_windows(StereoPair::from(dots, dots),
                    {.window_size = 3, .min_disparity = 5, .num_disparities = 2, .row_band = 1}, {});
  EXPECT_EQ(matches.best(4, 1), kNoMatch);
  EXPECT_EQ(matches.cost(4, 1), kNoCost);
  EXPECT_EQ(matches.mean_cost(4, 1), kNoCost);
  EXPECT_EQ(matches.runner_up(4, 1), kNoCost);
  EXPECT_EQ(matches.cost_before(4, 1), kNoCost);
  EXPECT_EQ(matches.cost_after(4, 1), kNoCost);
  EXPECT_EQ(matches.row_offset(4, 1), 0);
  EXPECT_EQ(matches.best(5, 1), 5);
  EXPECT_EQ(matches.best_right(2, 1) == kNoMatch, false);
  EXPECT_EQ(matches.best_right(3, 1), kNoMatch);  // its left pixels would be 8 and 9
}

TEST(Match, GivesTiesToTheSmallestDisparity) {
  Image<Gray> grey({40, 6}, Gray{77}, Pool{});
  for (const auto& [name, cost] : kCosts) {
    const Matches matches =
        match_windows(StereoPair::from(grey, grey),
                      {.cost = cost, .window_size = 5, .min_disparity = -3, .num_disparities = 20}, {});
    for (int x = 0; x < 40; ++x) {
      EXPECT_EQ(matches.best(x, 3), std::max(-3, x - 39)) << name << " at " << x;
      EXPECT_EQ(matches.best_right(x, 3), std::max(-3, -x)) << name << " at " << x;
    }
  }
}

TEST(Match, ZeroVarianceIsNoSimilarityAndZeroEnergyTheWorst) {
  Image<Gray> black({9, 9}, Gray{0}, Pool{});
  const auto pair = StereoPair::from(black, black);
  const MatchConfig config{.window_size = 3, .num_disparities = 3};
  auto nssd = config;
  nssd.cost = Cost::nssd;
  EXPECT_EQ(match_windows(pair, config, {}).cost(4, 4), 1.0F);
  EXPECT_EQ(match_windows(pair, nssd, {}).cost(4, 4), 65536.0F);
}

TEST(Match, ComputesOnlyTheRequestedMaps) {
  const auto dots = synthetic::random_dots({12, 5}, 1);
  const Matches matches = match_windows(StereoPair::from(dots, dots), {.maps = MatchMaps::winner}, {});
  EXPECT_EQ(matches.best.size(), (Size{12, 5}));
  EXPECT_EQ(matches.cost.size(), (Size{12, 5}));
  EXPECT_TRUE(matches.best_right.empty());
  EXPECT_TRUE(matches.row_offset.empty());
  EXPECT_TRUE(matches.runner_up.empty());
  EXPECT_TRUE(matches.mean_cost.empty());
  EXPECT_TRUE(matches.cost_before.empty());
  EXPECT_TRUE(matches.cost_after.empty());
}

TEST(Match, FindsTheRowIfTheRightImageIsShifted) {
  const auto dots = synthetic::random_dots({60, 40}, 3);
  Image<Gray> shaken({60, 40});
  for (int y = 0; y < 40; ++y) std::copy_n(dots.row(std::max(0, y - 2)), 60, shaken.row(y));
  const Matches matches = match_windows(StereoPair::from(dots, shaken),
                                        {.window_size = 5, .num_disparities = 8, .row_band = 3}, {});
  for (int y = 5; y < 35; ++y) {
    for (int x = 10; x < 50; ++x) {
      ASSERT_EQ(matches.best(x, y), 0);
      ASSERT_EQ(matches.row_offset(x, y), 2);
    }
  }
}

TEST(Match, SurvivesTheSmallestImages) {
  for (const auto& [name, cost] : kCosts) {
    for (const Size size : {Size{1, 1}, Size{1, 7}, Size{7, 1}, Size{2, 2}}) {
      const auto dots = synthetic::random_dots(size, 1);
      const Matches matches = match_windows(
          StereoPair::from(dots, dots),
          {.cost = cost, .window_size = 31, .min_disparity = -8, .num_disparities = 1024, .row_band = 8}, {});
      EXPECT_NE(matches.best(0, 0), kNoMatch) << name << " " << text(size);
      EXPECT_TRUE(std::isfinite(matches.mean_cost(0, 0))) << name << " " << text(size);
    }
  }
}

TEST(Targets, ScalarIsAlwaysAvailableAndNamesRoundTrip) {
  const auto supported = supported_targets();
  ASSERT_FALSE(supported.empty());
  EXPECT_EQ(supported.front(), Target::scalar);
  for (const Target target : compiled_targets()) EXPECT_EQ(target_named(name(target)), target);
  EXPECT_EQ(target_named("best"), Target::best);
  EXPECT_EQ(target_named("mmx"), std::nullopt);
  EXPECT_EQ(active_target({}), supported.back());
  EXPECT_EQ(active_target(Exec::with_threads(1, Target::scalar)), Target::scalar);
}

}  // namespace
