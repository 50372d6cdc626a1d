// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/target.hpp>

#include "reference/epipolar_correction.hpp"
#include "support/first_difference.hpp"
#include "support/synthetic_scene.hpp"

namespace {

using namespace cairn;

void expect_equal_to_reference(Size size, float rows, float rows_per_px, int threads = 1) {
  const Image<Gray> right = synthetic::random_dots(size, static_cast<std::uint32_t>(size.width));
  const EpipolarOffset offset{.rows = rows, .rows_per_px = rows_per_px};
  const Image<Gray> expected = reference::shift_rows(right, offset);
  for (const Target target : supported_targets()) {
    const Image<Gray> got = shift_rows(right, offset, Exec::with_threads(threads, target));
    EXPECT_EQ(first_difference(expected, got), "") << text(size) << " by " << rows << ", " << rows_per_px;
  }
}

TEST(ShiftRowsEquivalence, HoldsForEveryStepOfARow) {
  for (int step = -150; step <= 150; ++step) {
    expect_equal_to_reference({9, 11}, static_cast<float>(step) / 64.0F, 0);
  }
}

TEST(ShiftRowsEquivalence, HoldsForEverySize) {
  for (int width = 1; width <= 70; ++width) expect_equal_to_reference({width, 5}, -0.7F, 0.013F);
  for (int height = 1; height <= 20; ++height) expect_equal_to_reference({19, height}, 1.3F, -0.02F);
}

TEST(ShiftRowsEquivalence, HoldsForEveryRollAndSplitIntoThreads) {
  for (const float roll : {-0.2F, -0.01F, 0.003F, 0.05F, 1.0F}) {
    for (const int threads : {1, 2, 3}) expect_equal_to_reference({97, 150}, 0.25F, roll, threads);
  }
}

}  // namespace
