// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/grow_near_to_far.hpp>

#include "support/chain_graph.hpp"

namespace cairn {
namespace {

using chain::graph;

constexpr GrowCriteria kWithinFive{.mean_difference_max = 5, .deviation_max = 100, .sigma_min = 1};

TEST(GrowNearToFar, LetsTheNearestRegionGrowFirst) {
  // The middle one is within reach of both; the nearer neighbour is visited first and takes it.
  const RegionGraph given = graph({{.mean = 10}, {.mean = 14}, {.mean = 18}});
  EXPECT_EQ(grow_near_to_far(given, kWithinFive, {}), (Merges{0, 2, 2}));
}

TEST(GrowNearToFar, TriesTheCheapestArcFirst) {
  // 200 would refuse 160 at first (its mean would move by 20); once it has 195, which is many, 160 moves it
  // little.
  const RegionGraph given =
      graph({{.mean = 160, .pixels = 10}, {.mean = 200, .pixels = 10}, {.mean = 195, .pixels = 90}});
  const GrowCriteria criteria{.mean_difference_max = 40, .deviation_max = 1, .sigma_min = 10};
  EXPECT_EQ(grow_near_to_far(given, criteria, {}), (Merges{1, 1, 1}));
}

TEST(GrowNearToFar, DoesNotRetryARefusedNeighbour) {
  // 200 refuses 175, absorbs 170, and would then admit 175 (its mean would move by 9.7, half a deviation is
  // 10.8). But it does not try again; and 175, when visited itself, refuses (its mean would move by 6.8, half
  // a deviation is 5).
  const RegionGraph given = graph(
      {{.mean = 175, .pixels = 20}, {.mean = 200, .pixels = 10, .spread = 20}, {.mean = 170, .pixels = 4}});
  const GrowCriteria criteria{.mean_difference_max = 40, .deviation_max = 0.5, .sigma_min = 10};
  EXPECT_EQ(grow_near_to_far(given, criteria, {}), (Merges{0, 1, 1}));
}

TEST(GrowNearToFar, TriesTheEarlierOfTwoEqualArcs) {
  // 60 is visited first and refuses 50, which would move its mean by 8. Then 50 has 60 and 40 as neighbours,
  // both 10 away; absorbing one moves its mean away from the other.
  const GrowCriteria criteria{.mean_difference_max = 10, .deviation_max = 4, .sigma_min = 1};
  const chain::Member near{.mean = 60, .pixels = 4};
  const chain::Member visited{.mean = 50, .pixels = 16};
  const chain::Member far{.mean = 40, .pixels = 4};
  EXPECT_EQ(grow_near_to_far(graph({near, visited, far}), criteria, {}), (Merges{1, 1, 2}));
  EXPECT_EQ(grow_near_to_far(graph({far, visited, near}), criteria, {}), (Merges{1, 1, 2}));
}

TEST(GrowNearToFar, ContinuesWithTheNeighboursOfAbsorbedRegions) {
  const RegionGraph given = graph({{.mean = 30}, {.mean = 29}, {.mean = 28}, {.mean = 27}});
  EXPECT_EQ(grow_near_to_far(given, kWithinFive, {}), (Merges{0, 0, 0, 0}));
}

TEST(GrowNearToFar, MayAbsorbARegionThatWasVisitedBefore) {
  // 60 cannot absorb 57 (its mean would move too far), but 57, which is large, absorbs 60 when visited.
  const RegionGraph given = graph({{.mean = 60, .pixels = 4}, {.mean = 57, .pixels = 400}});
  const GrowCriteria criteria{.mean_difference_max = 5, .deviation_max = 1, .sigma_min = 1};
  EXPECT_EQ(grow_near_to_far(given, criteria, {}), (Merges{1, 1}));
}

TEST(GrowNearToFar, KeepsTheFloorApart) {
  const RegionGraph given = graph({{.mean = 30}, {.mean = 30, .is_floor = true}, {.mean = 30}});
  EXPECT_EQ(grow_near_to_far(given, kWithinFive, {}), (Merges{0, 1, 2}));
}

TEST(GrowNearToFar, MergesRegionsWithoutDisparityIntoTheBackground) {
  const RegionGraph given = graph({{.mean = 90}, {.is_valid = false}, {.mean = 20}});
  EXPECT_EQ(grow_near_to_far(given, kWithinFive, {}), (Merges{0, 2, 2}));
}

TEST(GrowNearToFar, LeavesAGraphWithoutAnyValueInOnePiece) {
  const RegionGraph given = graph({{.is_valid = false}, {.is_valid = false}, {.is_valid = false}});
  const Merges merges = grow_near_to_far(given, kWithinFive, {});
  EXPECT_EQ(merges[0], merges[1]);
  EXPECT_EQ(merges[1], merges[2]);
}

}  // namespace
}  // namespace cairn
