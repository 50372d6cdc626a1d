// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/image/local_contrast.hpp>
#include <cmath>
#include <cstdint>

#include "support/grids.hpp"

namespace cairn {
namespace {

/// The formula, each window from scratch.
float contrast_at(View<const Gray> image, int x, int y) {
  const auto smooth = [&](int u, int v) {
    u = std::clamp(u, 0, image.width() - 1);
    v = std::clamp(v, 0, image.height() - 1);
    std::int64_t sum = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx)
        sum += image(std::clamp(u + dx, 0, image.width() - 1), std::clamp(v + dy, 0, image.height() - 1));
    }
    return static_cast<double>(sum) / 9;
  };
  double mean = 0;
  double square = 0;
  for (int v = y - kContrastWindow / 2; v <= y + kContrastWindow / 2; ++v) {
    for (int u = x - kContrastWindow / 2; u <= x + kContrastWindow / 2; ++u) {
      mean += smooth(u, v) / (kContrastWindow * kContrastWindow);
      square += smooth(u, v) * smooth(u, v) / (kContrastWindow * kContrastWindow);
    }
  }
  return static_cast<float>((smooth(x, y) - mean) / std::sqrt(square - mean * mean + 2));
}

TEST(LocalContrast, IsItsFormulaAtAnySizeAndForAnyThreads) {
  for (const Size size : {Size{1, 1}, Size{3, 40}, Size{29, 5}, Size{33, 150}}) {
    const auto image = grids::random_image<Gray>(size, 0, 255, 5);
    const Image<float> one = local_contrast(image, Exec{});
    const Image<float> three = local_contrast(image, Exec::with_threads(3));
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        EXPECT_NEAR(one(x, y), contrast_at(image, x, y), 1e-4F) << x << " " << y;
        EXPECT_EQ(one(x, y), three(x, y)) << x << " " << y;
      }
    }
  }
}

TEST(LocalContrast, IsZeroOnAPlainImage) {
  const Image<Gray> plain({20, 20}, 200, {});
  const Image<float> contrast = local_contrast(plain, {});
  EXPECT_EQ(contrast(10, 10), 0.0F);
}

}  // namespace
}  // namespace cairn
