// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace cairn {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

Image<float> row(std::initializer_list<float> values) {
  Image<float> image({static_cast<int>(values.size()), 1});
  std::copy(values.begin(), values.end(), image.row(0));
  return image;
}

TEST(DisparityErrors, AMatchIsBadOnlyBeyondTheThreshold) {
  const Image<float> truth = row({10, 10, 10, 10, 10});
  const Image<float> ours = row({10, 10.5F, 9, 12.5F, 15});
  const DisparityErrors e = disparity_errors(ours, truth, {}, 0);
  EXPECT_EQ(e.known, 5);
  EXPECT_EQ(e.matched, 5);
  EXPECT_EQ(e.bad[0], 3);  // > 0.5
  EXPECT_EQ(e.bad[1], 2);  // > 1
  EXPECT_EQ(e.bad[2], 2);  // > 2
  EXPECT_EQ(e.bad[3], 1);  // > 4
  EXPECT_DOUBLE_EQ(e.mean_absolute_px(), (0 + 0.5 + 1 + 2.5 + 5) / 5);
  EXPECT_DOUBLE_EQ(e.root_mean_square_px(), std::sqrt((0.25 + 1 + 6.25 + 25) / 5));
  EXPECT_DOUBLE_EQ(e.sigma_px(), std::sqrt((0.25 + 1) / 3));
}

TEST(DisparityErrors, AHoleIsNoBadMatchButABadPixel) {
  const Image<float> truth = row({10, 10, 10, 10});
  const Image<float> ours = row({10, kHole, 20, kHole});
  const DisparityErrors e = disparity_errors(ours, truth, {}, 0);
  EXPECT_DOUBLE_EQ(e.density(), 0.5);
  EXPECT_DOUBLE_EQ(e.bad_of_matched(1), 0.5);
  EXPECT_DOUBLE_EQ(e.bad_of_known(1), 0.75);
}

TEST(DisparityErrors, PixelsWithoutTruthDoNotCount) {
  const Image<float> truth = row({kHole, 10, kHole, std::numeric_limits<float>::infinity()});
  const Image<float> ours = row({3, 10, kHole, 5});
  const DisparityErrors e = disparity_errors(ours, truth, {}, 0);
  EXPECT_EQ(e.known, 1);
  EXPECT_DOUBLE_EQ(e.density(), 1.0);
}

TEST(DisparityErrors, ExcludedPixelsAndSkippedColumnsDoNotCount) {
  const Image<float> truth = row({1, 2, 3, 4});
  const Image<float> ours = row({9, 9, 9, 4});
  Image<std::uint8_t> excluded({4, 1}, 0, {});
  excluded(1, 0) = 255;
  EXPECT_EQ(disparity_errors(ours, truth, excluded, 0).known, 3);
  EXPECT_EQ(disparity_errors(ours, truth, excluded, 2).known, 2);
  EXPECT_EQ(disparity_errors(ours, truth, {}, 3).bad[0], 0);
  EXPECT_EQ(disparity_errors(ours, truth, {}, 99).known, 0);
}

TEST(DisparityErrors, OfTwoFramesAddUpToThatOfBothTogether) {
  const Image<float> truth = row({10, 10, 10, 10});
  const Image<float> ours = row({10, 13, kHole, 10.75F});
  const DisparityErrors whole = disparity_errors(ours, truth, {}, 0);
  DisparityErrors sum;
  for (int x = 0; x < 4; x += 2) {
    sum += disparity_errors(ours.view().sub({x, 0, 2, 1}), truth.view().sub({x, 0, 2, 1}), {}, 0);
  }
  EXPECT_EQ(sum.known, whole.known);
  EXPECT_EQ(sum.matched, whole.matched);
  EXPECT_EQ(sum.bad, whole.bad);
  EXPECT_DOUBLE_EQ(sum.root_mean_square_px(), whole.root_mean_square_px());
  EXPECT_DOUBLE_EQ(sum.sigma_px(), whole.sigma_px());
}

TEST(DisparityErrors, OfNoPixelsAreNaN) {
  const Image<float> truth = row({kHole});
  const Image<float> ours = row({5});
  const DisparityErrors e = disparity_errors(ours, truth, {}, 0);
  EXPECT_TRUE(std::isnan(e.density()));
  EXPECT_TRUE(std::isnan(e.bad_of_matched(0)));
  EXPECT_TRUE(std::isnan(e.mean_absolute_px()));
}

}  // namespace
}  // namespace cairn
