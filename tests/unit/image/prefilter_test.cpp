// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/image/prefilter.hpp>

namespace {

using namespace cairn;

/// Columns of these grey levels, `height` rows of them.
Image<Gray> stripes(std::initializer_list<int> greys, int height) {
  Image<Gray> image({static_cast<int>(greys.size()), height});
  for (int y = 0; y < height; ++y) {
    int x = 0;
    for (const int grey : greys) image(x++, y) = static_cast<Gray>(grey);
  }
  return image;
}

Image<Gray> sobel_of(const Image<Gray>& image, int cap) {
  return filter_xsobel(image, cap, {});
}
Image<std::int16_t> flattened(const Image<Gray>& image) {
  return remove_mean(image, 3, {});
}

TEST(XSobel, WeighsItsThreeRowsOneTwoOneAndShiftsByTheCap) {
  const auto filtered = sobel_of(stripes({10, 10, 13, 13}, 3), 31);
  for (int y = 0; y < 3; ++y) {
    EXPECT_EQ(filtered(1, y), 31 + 4 * 3);
    EXPECT_EQ(filtered(2, y), 31 + 4 * 3);
  }
}

TEST(XSobel, HasNoResponseInTheFirstAndLastColumn) {
  const auto filtered = sobel_of(stripes({0, 100, 200}, 2), 31);
  EXPECT_EQ(filtered(0, 0), 31);
  EXPECT_EQ(filtered(2, 1), 31);
  EXPECT_EQ(sobel_of(stripes({5}, 1), 31)(0, 0), 31);
}

TEST(XSobel, ClipsToTheCap) {
  EXPECT_EQ(sobel_of(stripes({0, 9, 255}, 3), 20)(1, 1), 40);
  EXPECT_EQ(sobel_of(stripes({255, 9, 0}, 3), 20)(1, 1), 0);
}

TEST(XSobel, MirrorsTheRowsAtTheBorder) {
  Image<Gray> image({3, 2}, Gray{0}, Pool{});
  image(2, 0) = 3;
  image(2, 1) = 5;
  const auto filtered = sobel_of(image, 60);
  EXPECT_EQ(filtered(1, 0), 60 + 5 + 2 * 3 + 5);
  EXPECT_EQ(filtered(1, 1), 60 + 3 + 2 * 5 + 3);
}

TEST(MeanRemoval, SubtractsTheMeanInSixteenths) {
  const auto flat = flattened(stripes({0, 0, 9}, 1));
  EXPECT_EQ(flat(0, 0), 0);            // the mean of 0, 0
  EXPECT_EQ(flat(1, 0), -16 * 3);      // of 0, 0, 9
  EXPECT_EQ(flat(2, 0), 16 * 9 - 72);  // of 0, 9
}

TEST(MeanRemoval, RoundsToTheNearestStep) {
  // The mean of 0, 0, 1 is 5.33 steps, of 0, 1, 1 it is 10.67.
  EXPECT_EQ(flattened(stripes({0, 0, 1}, 1))(1, 0), -5);
  EXPECT_EQ(flattened(stripes({0, 1, 1}, 1))(1, 0), 16 - 11);
}

}  // namespace
