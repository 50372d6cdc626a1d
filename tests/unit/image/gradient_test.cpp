// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/image/gradient.hpp>
#include <cairn/stereo/gradient.hpp>
#include <limits>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Rows = std::vector<std::vector<std::int64_t>>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kHole = kHole16;
constexpr int kTop = kHoleGradient;

TEST(Gradient, IsTheDifferenceOfTheNeighboursAtAStep) {
  const Image<Gray> image = grid<Gray>({{10, 10, 30, 30}, {10, 10, 30, 30}});
  EXPECT_EQ(numbers(gradient(image, 0, {})), (Rows{{0, 20, 20, 0}, {0, 20, 20, 0}}));
}

TEST(Gradient, IsTheLengthOverBothDirections) {
  const Image<Gray> image = grid<Gray>({{0, 0, 0}, {0, 0, 30}, {0, 40, 0}});
  EXPECT_EQ(gradient(image, 0, {})(1, 1), 50);
}

TEST(Gradient, IsCappedAt255) {
  const Image<Gray> image = grid<Gray>({{0, 255, 255}, {255, 255, 255}, {0, 255, 255}});
  EXPECT_EQ(gradient(image, 0, {})(0, 0), 255);
}

TEST(Gradient, OfAPlainImageIsZeroAtEverySmoothing) {
  Image<Gray> image(Size{40, 30}, Gray{255}, {});
  for (const float sigma : {0.0F, 0.3F, 1.0F, 2.5F, 5.0F}) {
    const Image<std::uint16_t> edges = gradient(image, sigma, {});
    EXPECT_EQ(numbers(edges), numbers(Image<std::uint16_t>(image.size(), 0, {}))) << "sigma " << sigma;
  }
}

TEST(Gradient, SmoothingLowersAndWidensAnEdge) {
  Image<Gray> image(Size{20, 3}, Gray{50}, {});
  for (int y = 0; y < 3; ++y) std::fill_n(image.row(y) + 10, 10, Gray{150});
  const Image<std::uint16_t> sharp = gradient(image, 0, {});
  const Image<std::uint16_t> soft = gradient(image, 1.5F, {});
  EXPECT_LT(soft(10, 1), sharp(10, 1));
  EXPECT_EQ(sharp(12, 1), 0);
  EXPECT_GT(soft(12, 1), 0);
}

TEST(Gradient, OfASinglePixelIsZero) {
  const Image<Gray> image = grid<Gray>({{77}});
  EXPECT_EQ(gradient(image, 1.0F, {})(0, 0), 0);
}

TEST(Quantised, CountsInSixteenthsAndRoundsHalvesUp) {
  DisparityMap map{grid<float, double>({{0, 1, 2.5, -1, 1.0 / 32, -1.0 / 32, 2047, -2047}}), {}};
  map.reject = Image<Reject>(map.disparity_px.size(), Reject::none, {});
  EXPECT_EQ(numbers(quantised(map, {})), (Rows{{0, 16, 40, -16, 1, 0, 32752, -32752}}));
}

TEST(Quantised, KeepsHolesAsHoles) {
  DisparityMap map{grid<float, float>({{1, kNan}}), grid<Reject>({{0, 128}})};
  EXPECT_EQ(numbers(quantised(map, {})), (Rows{{16, kHole}}));
}

TEST(DisparityGradient, IgnoresAStepAcrossAHole) {
  const Image<std::int16_t> map = grid<std::int16_t>({{100, kHole, 300, 300, 340}});
  EXPECT_EQ(numbers(gradient(map, 0, {})), (Rows{{0, kTop, 0, 40, 40}}));
}

TEST(DisparityGradient, IsLimitedByItsCap) {
  const Image<std::int16_t> map = grid<std::int16_t>({{-32752, 0, 32752}});
  EXPECT_EQ(numbers(gradient(map, 0, {})), (Rows{{kSteepest16, kSteepest16, kSteepest16}}));
}

TEST(DisparityGradient, SmoothingIgnoresHoles) {
  Image<std::int16_t> map(Size{15, 9}, std::int16_t{800}, {});
  map(7, 4) = kHole16;
  map(0, 0) = kHole16;
  Image<std::uint16_t> expected(map.size(), 0, {});
  expected(7, 4) = expected(0, 0) = kHoleGradient;
  EXPECT_EQ(numbers(gradient(map, 1.2F, {})), numbers(expected));
}

}  // namespace
}  // namespace cairn
