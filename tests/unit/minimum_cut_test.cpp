// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/grouping/minimum_cut.hpp>
#include <limits>
#include <random>

namespace cairn {
namespace {

using Costs = std::vector<std::int64_t>;
using Labels = std::vector<std::int32_t>;

std::int64_t cost_of(const Labels& labels, const Costs& cost_0, const Costs& cost_1,
                     const std::vector<Tie>& ties) {
  const auto label = [&](std::int32_t i) { return labels[static_cast<std::size_t>(i)]; };
  std::int64_t cost = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) cost += labels[i] == 0 ? cost_0[i] : cost_1[i];
  for (const Tie& tie : ties) cost += label(tie.a) != label(tie.b) ? tie.cost : 0;
  return cost;
}

Labels minimum_cut(const Costs& cost_0, const Costs& cost_1, const std::vector<Tie>& ties) {
  return MinimumCuts(cost_0.size(), ties).cut(cost_0, cost_1);
}

/// Of all labellings that of least cost, and of those the one with the fewest 1s.
Labels best_of_all(const Costs& cost_0, const Costs& cost_1, const std::vector<Tie>& ties) {
  std::pair<std::int64_t, int> least{std::numeric_limits<std::int64_t>::max(), 0};
  Labels best;
  for (unsigned bits = 0; bits < 1U << cost_0.size(); ++bits) {
    Labels labels;
    int ones = 0;
    for (std::size_t i = 0; i < cost_0.size(); ++i) {
      labels.push_back(static_cast<std::int32_t>((bits >> i) & 1U));
      ones += labels.back();
    }
    const std::pair now{cost_of(labels, cost_0, cost_1, ties), ones};
    if (now >= least) continue;
    least = now;
    best = labels;
  }
  return best;
}

TEST(MinimumCut, OfNoNodesIsNoLabels) {
  EXPECT_TRUE(minimum_cut({}, {}, {}).empty());
}

TEST(MinimumCut, GivesEachNodeItsCheaperLabelWhereNothingIsTied) {
  EXPECT_EQ(minimum_cut({5, 1, 3, 0}, {2, 4, 3, 0}, {}), (Labels{1, 0, 0, 0}));
}

TEST(MinimumCut, PartsNeighboursOnlyWhereThatCostsLessThanTheWrongLabel) {
  EXPECT_EQ(minimum_cut({9, 0}, {0, 4}, {{0, 1, 3}}), (Labels{1, 0}));
  EXPECT_EQ(minimum_cut({9, 0}, {0, 4}, {{0, 1, 5}}), (Labels{1, 1}));
  EXPECT_EQ(minimum_cut({4, 0}, {0, 9}, {{0, 1, 5}}), (Labels{0, 0}));
}

TEST(MinimumCut, AddsUpTiesBetweenTheSameNodesInEitherDirection) {
  EXPECT_EQ(minimum_cut({9, 0}, {0, 4}, {{0, 1, 3}, {1, 0, 2}}), (Labels{1, 1}));
}

TEST(MinimumCut, MindsNoTieOfANodeToItself) {
  EXPECT_EQ(minimum_cut({9, 0}, {0, 4}, {{0, 0, 50}, {1, 1, 50}}), (Labels{1, 0}));
}

TEST(MinimumCut, HasTheFewestOnesOfWhatCostsTheSame) {
  EXPECT_EQ(minimum_cut({4, 0, 0}, {0, 0, 4}, {{0, 1, 4}, {1, 2, 4}}), (Labels{0, 0, 0}));
}

TEST(MinimumCut, FollowsAChainAsFarAsItHolds) {
  EXPECT_EQ(minimum_cut({9, 0, 0, 0, 0}, {0, 0, 0, 0, 9}, {{0, 1, 8}, {1, 2, 7}, {2, 3, 2}, {3, 4, 6}}),
            (Labels{1, 1, 1, 0, 0}));
}

TEST(MinimumCut, ManagesCostsThatFillMoreThan32Bits) {
  constexpr std::int64_t kMuch = 1'000'000'000'000;
  EXPECT_EQ(minimum_cut({9 * kMuch, 0}, {0, 4 * kMuch}, {{0, 1, 4 * kMuch + 1}}), (Labels{1, 1}));
  EXPECT_EQ(minimum_cut({9 * kMuch, 0}, {0, 4 * kMuch}, {{0, 1, 4 * kMuch - 1}}), (Labels{1, 0}));
}

TEST(MinimumCut, IsTheBestOfAllLabellings) {
  for (std::uint32_t seed = 1; seed <= 400; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return static_cast<std::int32_t>(random() % n); };
    const std::size_t nodes = 1 + seed % 9;
    const std::size_t highest = seed % 3 == 0 ? 3 : 12;  // few heights make labellings of the same cost
    Costs cost_0;
    Costs cost_1;
    for (std::size_t i = 0; i < nodes; ++i) {
      cost_0.push_back(below(highest));
      cost_1.push_back(below(highest));
    }
    std::vector<Tie> ties(nodes * (seed % 4));
    for (Tie& tie : ties) tie = {below(nodes), below(nodes), below(highest)};
    EXPECT_EQ(minimum_cut(cost_0, cost_1, ties), best_of_all(cost_0, cost_1, ties)) << seed;
  }
}

}  // namespace
}  // namespace cairn
