// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/stereo/semi_global.hpp>
#include <vector>

#include "support/grids.hpp"
#include "support/synthetic_scene.hpp"

namespace {

using namespace cairn;
using grids::numbers;

MatchConfig search(int first, int count) {
  return {.method = MatchMethod::semi_global, .min_disparity = first, .num_disparities = count};
}

Matches matched(const StereoPair& pair, int count, const SemiGlobalConfig& penalties = {}) {
  return match_semi_global(pair, search(0, count), penalties, {});
}

/// All results for comparison.
std::vector<std::vector<std::vector<std::int64_t>>> costs_and_winners(const Matches& m) {
  return {numbers(m.best), numbers(m.best_right), numbers(m.cost), numbers(m.mean_cost)};
}

TEST(SemiGlobal, SumsFourPathsAsComputedByHand) {
  // Two identical pixels; candidates 0 and 1. The partner of (0, d = 1) is outside: 12 bits. So C(0, 1) =
  // (3·12 + 3·12 + 0 + 2) / 4 = 18, C(1, 1) = (3·12 + 2) / 4 = 9, C(·, 0) = 0; P1 = 54·0.6 = 32. S(1, 1) = 9
  // down + 9 up + 9 leftward + 9 + min(18, P1) rightward.
  const Image<Gray> plain({2, 1}, 77, Pool{});
  const Matches m = matched(StereoPair::from(plain, plain), 2, {.penalty_small = 0.6F});
  EXPECT_EQ(m.best(1, 0), 0);
  EXPECT_EQ(m.cost(1, 0), 0.0F);
  EXPECT_EQ(m.cost_before(1, 0), kNoCost);
  EXPECT_EQ(m.cost_after(1, 0), 54.0F);
  EXPECT_EQ(m.mean_cost(1, 0), 27.0F);
  EXPECT_EQ(m.runner_up(1, 0), kNoCost);
  EXPECT_EQ(m.best_right(0, 0), 0);
  // The left pixel's second candidate is outside the right image.
  EXPECT_EQ(m.cost_after(0, 0), kNoCost);
  EXPECT_EQ(m.mean_cost(0, 0), 0.0F);
  // P1 = 54·0.1 = 5: the step from 0 to 1 is cheaper rightward.
  const Matches cheap = matched(StereoPair::from(plain, plain), 2, {.penalty_small = 0.1F});
  EXPECT_EQ(cheap.cost_after(1, 0), 41.0F);
}

TEST(SemiGlobal, RecoversBoardsInFrontOfAWall) {
  const auto scene =
      synthetic::make_scene({.size = {120, 60}, .background_px = 4, .boxes = {{{50, 15, 40, 30}, 14}}});
  const Matches m = matched(scene.pair(), 24);
  int wrong = 0, shown = 0;
  for (int y = 2; y < 58; ++y) {
    for (int x = 26; x < 118; ++x) {
      if (scene.hidden(x, y) != 0) continue;
      ++shown;
      wrong += m.best(x, y) != static_cast<int>(scene.disparity_px(x, y)) ? 1 : 0;
    }
  }
  EXPECT_GT(shown, 4000);
  EXPECT_LT(wrong * 100, shown);  // the rims only
}

/// Dots around a uniform patch, 5 px apart in the two images.
struct PlainPatch {
  Image<Gray> left;
  Image<Gray> right;
  Rect patch{40, 10, 24, 20};
  PlainPatch() : left(synthetic::random_dots({100, 40}, 3)), right(synthetic::random_dots({100, 40}, 4)) {
    for (int y = patch.y; y < patch.y + patch.height; ++y) {
      std::fill_n(left.row(y) + patch.x, patch.width, Gray{128});
    }
    for (int y = 0; y < 40; ++y) std::copy_n(left.row(y) + 5, 95, right.row(y));
  }
};

TEST(SemiGlobal, FillsTexturelessAreasFromTheirSurroundings) {
  const PlainPatch scene;
  const auto pair = StereoPair::from(scene.left, scene.right);
  const Matches paths = matched(pair, 16);
  const Matches windows =
      match_windows(pair, {.cost = Cost::sad, .window_size = 5, .num_disparities = 16}, {});
  const int x = scene.patch.x + scene.patch.width / 2;
  const int y = scene.patch.y + scene.patch.height / 2;
  EXPECT_EQ(windows.best(x, y), 0);  // all costs are equal; the smallest disparity wins
  for (int v = scene.patch.y; v < scene.patch.y + scene.patch.height; ++v) {
    for (int u = scene.patch.x; u < scene.patch.x + scene.patch.width; ++u) EXPECT_EQ(paths.best(u, v), 5);
  }
}

TEST(SemiGlobal, CostsAreZeroForIdenticalImages) {
  const PlainPatch scene;
  const Matches m = matched(StereoPair::from(scene.left, scene.right), 16);
  EXPECT_EQ(m.best(30, 20), 5);
  EXPECT_EQ(m.cost(30, 20), 0.0F);
  EXPECT_GE(m.runner_up(30, 20), 40.0F);
}

TEST(SemiGlobal, IsInvariantToTheRightCamerasGainAndOffset) {
  const auto scene = synthetic::make_scene({.size = {60, 30}, .boxes = {{{25, 8, 20, 15}, 11}}});
  Image<Gray> left = scene.left.clone();
  Image<Gray> right = scene.right.clone();
  Image<Gray> brighter(right.size());
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      left(x, y) = static_cast<Gray>(left(x, y) / 3);
      right(x, y) = static_cast<Gray>(right(x, y) / 3);
      brighter(x, y) = static_cast<Gray>(2 * right(x, y) + 40);
    }
  }
  EXPECT_EQ(costs_and_winners(matched(StereoPair::from(left, brighter), 16)),
            costs_and_winners(matched(StereoPair::from(left, right), 16)));
}

TEST(SemiGlobal, RestrictsLargeStepsToIntensityEdges) {
  // The larger the penalty, the fewer steps.
  const auto scene = synthetic::make_scene({.size = {90, 40}, .boxes = {{{40, 10, 25, 20}, 12}}, .seed = 9});
  const auto steps = [&](const SemiGlobalConfig& penalties) {
    const Matches m = matched(scene.pair(), 20, penalties);
    int count = 0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 21; x < 90; ++x) count += std::abs(m.best(x, y) - m.best(x - 1, y)) > 1 ? 1 : 0;
    }
    return count;
  };
  EXPECT_LT(steps({.penalty_large = 2.3F, .penalty_edge = 0}),
            steps({.penalty_large = 2.3F, .penalty_edge = 10}));
  EXPECT_LT(steps({.penalty_large = 2.3F, .penalty_edge = 0}),
            steps({.penalty_small = 0.1F, .penalty_large = 0}));
}

TEST(SemiGlobal, MarksPixelsWithoutCandidates) {
  const auto dots = synthetic::random_dots({12, 4}, 1);
  const Matches m = match_semi_global(StereoPair::from(dots, dots), search(5, 3), {}, {});
  for (const int x : {0, 4}) {
    EXPECT_EQ(m.best(x, 1), kNoMatch);
    EXPECT_EQ(m.cost(x, 1), kNoCost);
    EXPECT_EQ(m.runner_up(x, 1), kNoCost);
    EXPECT_EQ(m.mean_cost(x, 1), kNoCost);
    EXPECT_EQ(m.cost_before(x, 1), kNoCost);
    EXPECT_EQ(m.cost_after(x, 1), kNoCost);
  }
  EXPECT_EQ(m.best(5, 1), 5);
  EXPECT_EQ(m.best_right(7, 1), kNoMatch);
  EXPECT_NE(m.best_right(6, 1), kNoMatch);
}

TEST(SemiGlobal, MatchesNegativeDisparitiesToo) {
  const auto dots = synthetic::random_dots({60, 20}, 6);
  Image<Gray> moved = synthetic::random_dots({60, 20}, 7);
  for (int y = 0; y < 20; ++y) std::copy_n(dots.row(y), 57, moved.row(y) + 3);  // d = −3
  const Matches m = match_semi_global(StereoPair::from(dots, moved), search(-6, 12), {}, {});
  for (int x = 8; x < 50; ++x) EXPECT_EQ(m.best(x, 10), -3);
  for (int x = 12; x < 50; ++x) EXPECT_EQ(m.best_right(x, 10), -3);
}

TEST(SemiGlobal, KeepsOnlyTheWinnerOnRequest) {
  const auto scene = synthetic::make_scene({.size = {50, 20}});
  auto config = search(0, 12);
  config.maps = MatchMaps::winner;
  const Matches winner = match_semi_global(scene.pair(), config, {}, {});
  const Matches full = matched(scene.pair(), 12);
  EXPECT_EQ(numbers(winner.best), numbers(full.best));
  EXPECT_EQ(numbers(winner.cost), numbers(full.cost));
  EXPECT_TRUE(winner.best_right.empty() && winner.runner_up.empty() && winner.mean_cost.empty() &&
              winner.cost_before.empty() && winner.cost_after.empty() && full.row_offset.empty());
}

TEST(SemiGlobal, IsUsedByMatch) {
  const auto scene = synthetic::make_scene({.size = {50, 20}});
  auto config = search(0, 12);
  const SemiGlobalConfig penalties{.penalty_small = 0.2F, .penalty_large = 1.0F};
  EXPECT_EQ(costs_and_winners(match(scene.pair(), config, {}, {})),
            costs_and_winners(matched(scene.pair(), 12)));
  EXPECT_EQ(costs_and_winners(match(scene.pair(), config, penalties, {})),
            costs_and_winners(matched(scene.pair(), 12, penalties)));
  EXPECT_NE(costs_and_winners(matched(scene.pair(), 12, penalties)),
            costs_and_winners(matched(scene.pair(), 12)));
  // The options of window matching have no effect.
  config.cost = Cost::sad;
  config.window_size = 21;
  config.row_band = 2;
  config.prefilter = Prefilter::xsobel;
  EXPECT_EQ(costs_and_winners(match(scene.pair(), config, {}, {})),
            costs_and_winners(matched(scene.pair(), 12)));
  config = {.cost = Cost::sad, .window_size = 5, .num_disparities = 12};
  EXPECT_EQ(costs_and_winners(match(scene.pair(), config, penalties, {})),
            costs_and_winners(match_windows(scene.pair(), config, {})));
}

}  // namespace
