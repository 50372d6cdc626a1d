// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/segment_intensity.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

/// A uniform image with a brighter rectangle.
Image<Gray> picture(Size size, Rect bright, int noise) {
  Image<Gray> image = grids::random_image<Gray>(size, 100 - noise, 100 + noise, 5);
  for (int y = bright.y; y < bright.y + bright.height; ++y) {
    for (int x = bright.x; x < bright.x + bright.width; ++x)
      image(x, y) = static_cast<Gray>(image(x, y) + 60);
  }
  return image;
}

TEST(SegmentIntensity, SeparatesARectangleFromItsBackground) {
  const Rect bright{12, 8, 20, 15};
  const Image<Gray> image = picture({60, 40}, bright, 0);
  const Segmentation result = segment_intensity(image, {.smoothing_sigma = 0}, {});
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_EQ(result.regions[1].box, bright);
  EXPECT_NEAR(result.regions[1].pixel_count, 300, 4);  // a corner may belong to either region
  EXPECT_NEAR(result.regions[1].mean, 160, 0.5);
  EXPECT_NEAR(result.regions[0].mean, 100, 0.5);
}

TEST(SegmentIntensity, ManyBasinsOfNoiseGrowToFewRegions) {
  const Image<Gray> image = picture({120, 90}, {30, 20, 50, 40}, 3);
  const Segmentation result = segment_intensity(image, {.min_region_area = 1.0F}, {});
  EXPECT_LE(result.regions.size(), 6U);
  EXPECT_NE(result.labels(55, 40), result.labels(5, 5));
}

TEST(SegmentIntensity, AGradientBelowItsThresholdMakesNoBasins) {
  // Without growing, regions are basins: two, and possibly one for a corner.
  const Image<Gray> image = picture({60, 40}, {12, 8, 20, 15}, 2);
  const auto basins = [&](float threshold) {
    const IntensityConfig config{.gradient_threshold = threshold,
                                 .mean_difference_max = 0,
                                 .deviation_max = 0,
                                 .smoothing_sigma = 0,
                                 .min_region_area = 0};
    return segment_intensity(image, config, {}).regions.size();
  };
  EXPECT_GT(basins(0), 100U);
  EXPECT_LE(basins(10), 6U);
}

TEST(SegmentIntensity, LeavesNoRegionBelowTheMinimumArea) {
  const Image<Gray> image = grids::random_image<Gray>({50, 40}, 0, 255, 3);
  const Segmentation result = segment_intensity(image, {.min_region_area = 1.0F}, {});
  for (const Region& region : result.regions) EXPECT_GE(region.pixel_count, 20);
}

TEST(SegmentIntensity, AcceptsAnyImageSize) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 3}, Size{200, 1}, Size{1, 200}}) {
    const Image<Gray> image = grids::random_image<Gray>(size, 0, 255, 1);
    const Segmentation result = segment_intensity(image, {}, {});
    EXPECT_GE(result.regions.size(), 1U) << text(size);
  }
}

}  // namespace
}  // namespace cairn
