// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/split_floor.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/stereo/gradient.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Rows = std::vector<std::vector<std::int64_t>>;

Rows basins(std::initializer_list<std::initializer_list<int>> heights) {
  const Image<std::uint16_t> gradient = grid<std::uint16_t>(heights);
  return numbers(watershed(gradient, {}).labels);
}

TEST(Watershed, SeparatesTwoValleysAtTheirRidge) {
  EXPECT_EQ(basins({{0, 3, 9, 4, 1}}), (Rows{{0, 0, 0, 1, 1}}));
}

TEST(Watershed, SendsARidgePixelToTheLowerSide) {
  EXPECT_EQ(basins({{0, 4, 9, 3, 1}}), (Rows{{0, 0, 1, 1, 1}}));
}

TEST(Watershed, DecidesTiesInTheOrderUpLeftRightDown) {
  EXPECT_EQ(basins({{9, 1, 9}, {1, 5, 1}, {9, 1, 9}})[1][1], 0);  // up is basin 0
  EXPECT_EQ(basins({{9, 9, 9}, {1, 5, 1}, {9, 1, 9}})[1], (std::vector<std::int64_t>{0, 0, 1}));
  EXPECT_EQ(basins({{9, 9, 9}, {9, 5, 1}, {9, 1, 9}})[1][1], basins({{9, 9, 9}, {9, 5, 1}, {9, 1, 9}})[1][2]);
}

TEST(Watershed, MakesAPlainImageOneBasin) {
  EXPECT_EQ(basins({{7, 7, 7}, {7, 7, 7}}), (Rows{{0, 0, 0}, {0, 0, 0}}));
}

TEST(Watershed, HalvesAPlateauBetweenItsTwoOutlets) {
  EXPECT_EQ(basins({{1, 5, 5, 5, 5, 2}}), (Rows{{0, 0, 0, 1, 1, 1}}));
}

TEST(Watershed, GivesTheMiddleOfAnOddPlateauToTheLeft) {
  EXPECT_EQ(basins({{1, 5, 5, 5, 2}}), (Rows{{0, 0, 0, 1, 1}}));
}

TEST(Watershed, CrossesAPlateauOnTheShortestPathAroundAnObstacle) {
  // The corner at the lower right is two steps from the way down above it and three from the one at the left.
  EXPECT_EQ(basins({{9, 9, 9, 2}, {9, 9, 9, 5}, {1, 5, 9, 5}, {9, 5, 5, 5}}),
            (Rows{{0, 1, 1, 1}, {0, 0, 1, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}}));
}

TEST(Watershed, MakesAFlatDipOneBasin) {
  EXPECT_EQ(basins({{2, 8, 2}, {2, 8, 2}, {2, 2, 2}}), (Rows{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
}

TEST(Watershed, DoesNotJoinDipsThatTouchAtACornerOnly) {
  EXPECT_EQ(basins({{1, 5}, {5, 1}}), (Rows{{0, 0}, {0, 1}}));
}

TEST(Watershed, FloodsHolesFromTheirSurroundings) {
  constexpr int kHole = UINT16_MAX;
  EXPECT_EQ(basins({{0, kHole, kHole, kHole, kHole, 3}}), (Rows{{0, 0, 0, 1, 1, 1}}));
  EXPECT_EQ(basins({{kHole, kHole}}), (Rows{{0, 0}}));
}

TEST(Watershed, NumbersBasinsByTheirFirstPixelNotByTheirLowest) {
  EXPECT_EQ(basins({{5, 9, 1}, {4, 9, 9}, {0, 9, 0}}), (Rows{{0, 1, 1}, {0, 0, 2}, {0, 0, 2}}));
}

TEST(SplitFloor, MakesTheFloorOneRegionEvenInPieces) {
  const Basins two{grid<RegionId>({{0, 0, 1}, {0, 1, 1}}), 2};
  const Image<std::uint8_t> floor = grid<std::uint8_t>({{255, 0, 0}, {0, 0, 255}});
  const Basins split = split_floor(two, floor, {});
  EXPECT_EQ(numbers(split.labels), (Rows{{0, 1, 2}, {3, 4, 0}}));
  EXPECT_EQ(split.count, 5);
}

TEST(SplitFloor, SplitsABasinCutByTheFloor) {
  const Basins one{grid<RegionId>({{0, 0, 0}, {0, 0, 0}}), 1};
  const Image<std::uint8_t> floor = grid<std::uint8_t>({{0, 1, 0}, {0, 1, 0}});
  EXPECT_EQ(numbers(split_floor(one, floor, {}).labels), (Rows{{0, 1, 2}, {0, 1, 2}}));
}

TEST(SplitFloor, WithoutFloorChangesNothing) {
  const Basins two{grid<RegionId>({{0, 0, 1}, {0, 1, 1}}), 2};
  const Image<std::uint8_t> floor = grid<std::uint8_t>({{0, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(numbers(split_floor(two, floor, {}).labels), numbers(two.labels));
}

/// For one row: the floor after filling its holes.
std::vector<std::int64_t> closed(const Basins& basins, const Image<std::uint8_t>& floor,
                                 const Image<std::int16_t>& values) {
  return numbers(floor_with_holes(basins, floor, values, {})).front();
}

TEST(FloorWithHoles, AHoleGoesToTheFloorOfItsBasin) {
  constexpr int kNone = kHole16;
  const Basins two{grid<RegionId>({{0, 0, 0, 0, 1, 1, 1}}), 2};
  const Image<std::uint8_t> floor = grid<std::uint8_t>({{255, 255, 0, 0, 0, 0, 0}});
  EXPECT_EQ(closed(two, floor, grid<std::int16_t>({{70, 71, kNone, kNone, kNone, 90, 90}})),
            (std::vector<std::int64_t>{255, 255, 255, 255, 0, 0, 0}));
}

TEST(FloorWithHoles, AHoleInABasinMostlyOutsideTheFloorStays) {
  constexpr int kNone = kHole16;
  const Basins one{grid<RegionId>({{0, 0, 0, 0}}), 1};
  const Image<std::int16_t> values = grid<std::int16_t>({{70, 70, kNone, 72}});
  EXPECT_EQ(closed(one, grid<std::uint8_t>({{255, 0, 0, 255}}), values),
            (std::vector<std::int64_t>{255, 0, 255, 255}));
  EXPECT_EQ(closed(one, grid<std::uint8_t>({{255, 0, 0, 0}}), values),
            (std::vector<std::int64_t>{255, 0, 0, 0}));
}

}  // namespace
}  // namespace cairn
