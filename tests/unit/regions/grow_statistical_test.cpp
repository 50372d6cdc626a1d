// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/grow_statistical.hpp>

#include "support/chain_graph.hpp"

namespace cairn {
namespace {

using chain::graph;

RegionGraph::Node node(int mean, int pixels, int spread = 0) {
  return graph({{.mean = mean, .pixels = pixels, .spread = spread}}).nodes[0];
}

TEST(MayFuse, RefusesMeansFurtherApartThanEquationOne) {
  const GrowCriteria criteria{.mean_difference_max = 10, .deviation_max = 100, .sigma_min = 1};
  EXPECT_TRUE(may_fuse(node(50, 10), node(60, 10), criteria));
  EXPECT_FALSE(may_fuse(node(50, 10), node(61, 10), criteria));
}

TEST(MayFuse, LetsALargeRegionAbsorbASmallOneButNotTheOtherWayRound) {
  const GrowCriteria criteria{.mean_difference_max = 10, .deviation_max = 1, .sigma_min = 1};
  EXPECT_TRUE(may_fuse(node(50, 90), node(60, 10), criteria));   // the mean moves by 1 = 1 σ
  EXPECT_FALSE(may_fuse(node(60, 10), node(50, 90), criteria));  // the mean moves by 9
}

TEST(MayFuse, KeepsTwoSignificantRegionsApart) {
  const GrowCriteria criteria{.mean_difference_max = 10, .deviation_max = 1, .sigma_min = 1};
  EXPECT_FALSE(may_fuse(node(50, 500), node(60, 500), criteria));
  EXPECT_TRUE(may_fuse(node(50, 500, 5), node(60, 500), criteria));  // σ = 5, and the mean moves by 5
}

TEST(MayFuse, NeverAdmitsFloorOrRegionsWithoutValue) {
  const GrowCriteria criteria{.mean_difference_max = 1e9, .deviation_max = 1e9, .sigma_min = 1};
  const RegionGraph given =
      graph({{.mean = 5}, {.mean = 5, .is_valid = false}, {.mean = 5, .is_floor = true}});
  EXPECT_FALSE(may_fuse(given.nodes[0], given.nodes[1], criteria));
  EXPECT_FALSE(may_fuse(given.nodes[1], given.nodes[0], criteria));
  EXPECT_FALSE(may_fuse(given.nodes[0], given.nodes[2], criteria));
  EXPECT_FALSE(may_fuse(given.nodes[2], given.nodes[0], criteria));
}

TEST(GrowStatistical, FusesSimilarNeighboursOnly) {
  const RegionGraph given = graph({{.mean = 10}, {.mean = 11}, {.mean = 90}, {.mean = 91}, {.mean = 10}});
  const Merges merges =
      grow_statistical(given, {.mean_difference_max = 3, .deviation_max = 1, .sigma_min = 2}, {});
  EXPECT_EQ(merges, (Merges{0, 0, 2, 2, 4}));
}

TEST(GrowStatistical, ReachesNeighboursGainedByAFusion) {
  const RegionGraph given = graph({{.mean = 10}, {.mean = 10}, {.mean = 10}, {.mean = 10}});
  EXPECT_EQ(grow_statistical(given, {.mean_difference_max = 1, .deviation_max = 1, .sigma_min = 1}, {}),
            (Merges{0, 0, 0, 0}));
}

TEST(GrowStatistical, ComparesWithTheMeanOfTheFusedRegion) {
  // Each is similar to its neighbour, but the last is too far from the mean of the earlier ones.
  const RegionGraph given = graph({{.mean = 10}, {.mean = 14}, {.mean = 18}});
  EXPECT_EQ(grow_statistical(given, {.mean_difference_max = 4, .deviation_max = 100, .sigma_min = 1}, {}),
            (Merges{0, 0, 2}));
}

TEST(GrowStatistical, PassesAgainWhereALaterRegionCanAbsorbAnEarlierOne) {
  // The small first region cannot move its mean that far; the large second one absorbs it.
  const RegionGraph given = graph({{.mean = 10, .pixels = 2}, {.mean = 14, .pixels = 200}});
  EXPECT_EQ(grow_statistical(given, {.mean_difference_max = 5, .deviation_max = 1, .sigma_min = 1}, {}),
            (Merges{1, 1}));
}

TEST(FuseSmallRegions, SendsASmallRegionToTheNearestMean) {
  const RegionGraph given =
      graph({{.mean = 10, .pixels = 50}, {.mean = 40, .pixels = 3}, {.mean = 60, .pixels = 50}});
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 10, {}), (Merges{0, 2, 2}));
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 3, {}), (Merges{0, 1, 2}));
}

TEST(FuseSmallRegions, DecidesEqualDistancesInRasterOrder) {
  const RegionGraph given =
      graph({{.mean = 10, .pixels = 50}, {.mean = 20, .pixels = 3}, {.mean = 30, .pixels = 50}});
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 10, {}), (Merges{0, 0, 2}));
}

TEST(FuseSmallRegions, MergesTheSmallestFirstByItsCurrentSize) {
  // 2 (1 px) joins 1; together they are large enough to stay.
  const RegionGraph given =
      graph({{.mean = 30, .pixels = 50}, {.mean = 50, .pixels = 4}, {.mean = 55, .pixels = 1}});
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 5, {}), (Merges{0, 1, 1}));
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 6, {}), (Merges{0, 0, 0}));
}

TEST(FuseSmallRegions, MergesRegionsWithoutDisparityIntoTheFarthestNeighbour) {
  const RegionGraph given =
      graph({{.mean = 90, .pixels = 50}, {.pixels = 40, .is_valid = false}, {.mean = 20, .pixels = 50}});
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 0, {}), (Merges{0, 2, 2}));
}

TEST(FuseSmallRegions, LeavesTheFloorAlone) {
  const RegionGraph given = graph(
      {{.mean = 90, .pixels = 2}, {.mean = 90, .pixels = 2, .is_floor = true}, {.mean = 10, .pixels = 50}});
  EXPECT_EQ(fuse_small_regions(given, {0, 1, 2}, 10, {}), (Merges{0, 1, 2}));
}

}  // namespace
}  // namespace cairn
