// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/segment_disparity.hpp>
#include <limits>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A wall, and boards in front of it.
struct Board {
  Rect rect;
  float disparity_px;  // NaN: a hole
};
DisparityMap scene(Size size, float wall_px, const std::vector<Board>& boards) {
  DisparityMap map{Image<float>(size, wall_px, {}), Image<Reject>(size, Reject::none, {})};
  for (const auto& [rect, d] : boards) {
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      for (int x = rect.x; x < rect.x + rect.width; ++x) {
        map.disparity_px(x, y) = d;
        map.reject(x, y) = d == d ? Reject::none : Reject::no_data;
      }
    }
  }
  return map;
}

TEST(SegmentDisparity, SeparatesBoardsFromTheWallWithMeansInPixels) {
  const Segmentation result =
      segment_disparity(scene({60, 40}, 4, {{{5, 5, 12, 20}, 20.5F}, {{30, 8, 15, 15}, 11}}), {}, {}, {});
  ASSERT_EQ(result.regions.size(), 3U);
  EXPECT_NEAR(result.regions[0].mean, 4, 0.1);  // a board's corner may belong to either region
  EXPECT_NEAR(result.regions[1].mean, 20.5, 0.1);
  EXPECT_EQ(result.regions[1].box, (Rect{5, 5, 12, 20}));
  EXPECT_NEAR(result.regions[2].mean, 11, 0.1);
  EXPECT_EQ(result.regions[2].box, (Rect{30, 8, 15, 15}));
}

TEST(SegmentDisparity, HolesGetALabelButCountInNoStatistic) {
  const DisparityMap map = scene({60, 40}, 4, {{{20, 10, 20, 20}, 12}, {{28, 16, 4, 4}, kNan}});
  const Segmentation result = segment_disparity(map, {}, {}, {});
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_EQ(result.labels(30, 18), RegionId{1});
  EXPECT_NEAR(result.regions[1].pixel_count, 400, 4);
  EXPECT_EQ(result.regions[1].valid_count, result.regions[1].pixel_count - 16);
  EXPECT_DOUBLE_EQ(result.regions[1].mean, 12);
}

TEST(SegmentDisparity, AMapOfHolesIsOneRegionWithoutValue) {
  const Segmentation result = segment_disparity(scene({30, 20}, kNan, {}), {}, {}, {});
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_EQ(result.regions[0].valid_count, 0);
}

TEST(SegmentDisparity, FloorIsOneRegionAndSplitsABoardOnIt) {
  // Floor at the disparity of the board on it: only the mask separates them.
  const DisparityMap map = scene({60, 40}, 4, {{{0, 20, 60, 20}, 10}, {{20, 12, 15, 14}, 10}});
  Image<std::uint8_t> floor(Size{60, 40}, std::uint8_t{0}, {});
  for (int y = 20; y < 40; ++y) std::fill_n(floor.row(y), 60, std::uint8_t{255});
  for (int y = 20; y < 26; ++y) std::fill_n(floor.row(y) + 20, 15, std::uint8_t{0});
  const Segmentation result = segment_disparity(map, floor, {}, {});
  ASSERT_EQ(result.regions.size(), 3U);
  EXPECT_EQ(result.regions[1].box, (Rect{20, 12, 15, 14}));
  EXPECT_FALSE(result.regions[1].is_floor);
  EXPECT_TRUE(result.regions[2].is_floor);
  EXPECT_EQ(result.regions[2].pixel_count, 20 * 60 - 6 * 15);
}

TEST(SegmentDisparity, HolesInTheFloorAreFloor) {
  const DisparityMap map = scene({60, 40}, 10, {{{0, 0, 60, 12}, 4}, {{25, 24, 6, 5}, kNan}});
  Image<std::uint8_t> floor(Size{60, 40}, std::uint8_t{0}, {});
  for (int y = 12; y < 40; ++y) std::fill_n(floor.row(y), 60, std::uint8_t{255});
  for (int y = 24; y < 29; ++y) std::fill_n(floor.row(y) + 25, 6, std::uint8_t{0});
  const Segmentation result = segment_disparity(map, floor, {}, {});
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_TRUE(result.regions[1].is_floor);
  EXPECT_EQ(result.labels(27, 26), RegionId{1});
  EXPECT_EQ(result.regions[1].pixel_count - result.regions[1].valid_count, 30);
}

TEST(SegmentDisparity, StepsBelowTheGradientThresholdMakeNoBasins) {
  // Steps of 1/16 px every third column, and one of 3 px: without growing, regions are basins.
  DisparityMap map = scene({24, 6}, 0, {});
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 24; ++x)
      map.disparity_px(x, y) = (x / 3 % 2 == 0 ? 0.0F : 0.0625F) + (x < 12 ? 0.0F : 3.0F);
  }
  const auto basins = [&](float threshold) {
    const DisparityConfig config{
        .gradient_threshold = threshold, .mean_difference_max = 0, .deviation_max = 0, .min_region_area = 0};
    return segment_disparity(map, {}, config, {}).regions.size();
  };
  EXPECT_EQ(basins(0), 8U);
  EXPECT_EQ(basins(0.0625F), 8U);  // the threshold itself is not below
  EXPECT_EQ(basins(0.07F), 2U);
}

TEST(SegmentDisparity, ThresholdsAreInPixelsOfDisparity) {
  const DisparityMap map = scene({60, 40}, 4, {{{20, 10, 20, 20}, 5}});
  const DisparityConfig loose{.mean_difference_max = 1.0F, .deviation_max = 100};
  const DisparityConfig strict{.mean_difference_max = 0.9F, .deviation_max = 100};
  EXPECT_EQ(segment_disparity(map, {}, loose, {}).regions.size(), 1U);
  EXPECT_EQ(segment_disparity(map, {}, strict, {}).regions.size(), 2U);
}

}  // namespace
}  // namespace cairn
