// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/image/binning.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "support/grids.hpp"

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Of one pixel, by definition.
int mean_at(const Image<int>& image, int x, int y, int factor) {
  int sum = 0;
  for (int v = 0; v < factor; ++v) {
    for (int u = 0; u < factor; ++u) sum += image(x * factor + u, y * factor + v);
  }
  return static_cast<int>(std::floor(sum / static_cast<double>(factor * factor) + 0.5));
}

TEST(Binning, TakesRoundedMeansOfEachChannel) {
  for (const Size size : {Size{8, 8}, Size{13, 9}, Size{70, 11}}) {
    const Image<int> r = grids::random_image<int>(size, 0, 255, 1);
    const Image<int> g = grids::random_image<int>(size, 0, 255, 2);
    const Image<int> b = grids::random_image<int>(size, 250, 255, 3);
    Image<Gray> grey(size);
    Image<Rgb> colours(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        grey(x, y) = static_cast<Gray>(g(x, y));
        colours(x, y) = {static_cast<Gray>(r(x, y)), static_cast<Gray>(g(x, y)), static_cast<Gray>(b(x, y))};
      }
    }
    for (int factor = 1; factor <= kMaxBinning; ++factor) {
      const Image<Gray> small = binned(grey, factor);
      const Image<Rgb> small_colours = binned(colours, factor);
      ASSERT_EQ(small.size(), (Size{size.width / factor, size.height / factor}));
      ASSERT_EQ(small_colours.size(), small.size());
      for (int y = 0; y < small.height(); ++y) {
        for (int x = 0; x < small.width(); ++x) {
          EXPECT_EQ(small(x, y), mean_at(g, x, y, factor));
          const Rgb& c = small_colours(x, y);
          EXPECT_EQ(c.r, mean_at(r, x, y, factor));
          EXPECT_EQ(c.g, mean_at(g, x, y, factor));
          EXPECT_EQ(c.b, mean_at(b, x, y, factor));
        }
      }
    }
  }
}

TEST(Binning, ADisparityIsThatOfOneSurfaceOrAHole) {
  Image<float> disparity({6, 2}, kNan, {});
  disparity(0, 0) = 10, disparity(1, 0) = 30, disparity(0, 1) = 12,
               disparity(1, 1) = 31;         // the border of two
  disparity(2, 0) = 8, disparity(3, 1) = 6;  // the smaller of two
  const Image<float> small = binned_disparity(disparity, 2);
  ASSERT_EQ(small.size(), (Size{3, 1}));
  EXPECT_EQ(small(0, 0), 6);
  EXPECT_EQ(small(1, 0), 3);
  EXPECT_TRUE(std::isnan(small(2, 0)));
  const Image<float> holes({3, 3}, kNan, {});
  const Image<float> flat({3, 3}, 9, {});
  EXPECT_TRUE(std::isnan(binned_disparity(holes, 3)(0, 0)));
  EXPECT_EQ(binned_disparity(flat, 3)(0, 0), 3);
}

}  // namespace
}  // namespace cairn
