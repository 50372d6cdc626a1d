// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/gradient_threshold.hpp>
#include <cairn/regions/watershed.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Rows = std::vector<std::vector<std::int64_t>>;

/// Two uniform areas with noise, and the edge between them.
Image<std::uint16_t> noisy_halves() {
  return grid<std::uint16_t>({{0, 1, 0, 9, 1, 0, 1}, {1, 0, 1, 9, 0, 1, 0}, {0, 1, 0, 8, 1, 2, 1}});
}

Image<std::uint16_t> levelled(double threshold) {
  Image<std::uint16_t> gradient = noisy_halves();
  level_below(threshold, gradient, {});
  return gradient;
}

TEST(GradientThreshold, GradientsBelowItAreZero) {
  EXPECT_EQ(numbers(levelled(2)),
            (Rows{{0, 0, 0, 9, 0, 0, 0}, {0, 0, 0, 9, 0, 0, 0}, {0, 0, 0, 8, 0, 2, 0}}));
}

TEST(GradientThreshold, MayBeBetweenTwoGradients) {
  EXPECT_EQ(numbers(levelled(1.5)), numbers(levelled(2)));
  EXPECT_EQ(numbers(levelled(8.1)),
            (Rows{{0, 0, 0, 9, 0, 0, 0}, {0, 0, 0, 9, 0, 0, 0}, {0, 0, 0, 0, 0, 0, 0}}));
}

TEST(GradientThreshold, ZeroIsOff) {
  EXPECT_EQ(numbers(levelled(0)), numbers(noisy_halves()));
}

TEST(GradientThreshold, KeepsNoiseFromMakingBasins) {
  const Image<std::uint16_t> noisy = noisy_halves();
  const Image<std::uint16_t> smooth = levelled(3);
  EXPECT_GT(watershed(noisy, {}).count, 6);
  EXPECT_EQ(numbers(watershed(smooth, {}).labels),
            (Rows{{0, 0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 1, 1, 1}}));
}

}  // namespace
}  // namespace cairn
