// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/image/local_contrast.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

constexpr int kRadius = kContrastWindow / 2;
constexpr float kPixels = kContrastWindow * kContrastWindow;

/// Sums over 3 × 3 pixels for row y, including `margin` columns on both sides.
void smooth_row(View<const Gray> image, int y, int margin, std::vector<std::int32_t>& sums) {
  const auto row = [&](int v) { return image.row(std::clamp(v, 0, image.height() - 1)); };
  const Gray* const above = row(y - 1);
  const Gray* const here = row(y);
  const Gray* const below = row(y + 1);
  const auto column = [&](int x) {
    const int u = std::clamp(x, 0, image.width() - 1);
    return std::int32_t{above[u]} + here[u] + below[u];
  };
  for (int x = 0; x < image.width(); ++x)
    sums[static_cast<std::size_t>(x + margin)] = column(x - 1) + column(x) + column(x + 1);
  std::fill_n(sums.begin(), margin, sums[static_cast<std::size_t>(margin)]);
  std::fill(sums.end() - margin, sums.end(), sums[sums.size() - static_cast<std::size_t>(margin) - 1]);
}

}  // namespace

Image<float> local_contrast(View<const Gray> image, const Exec& exec) {
  const Size size = image.size();
  const auto padded = static_cast<std::size_t>(size.width + 2 * kRadius);
  Image<float> contrast(size, exec.pool);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    // Ring buffer of the window's rows, and their column sums.
    std::vector<std::vector<std::int32_t>> rows(kContrastWindow, std::vector<std::int32_t>(padded));
    std::vector<std::int32_t> sums(padded);
    std::vector<std::int32_t> squares(padded);
    const auto place = [](int y) { return static_cast<std::size_t>((y + kRadius) % kContrastWindow); };
    const auto add = [&](int y, std::int32_t sign) {
      const auto& row = rows[place(y)];
      for (std::size_t x = 0; x < padded; ++x) {
        sums[x] += sign * row[x];
        squares[x] += sign * row[x] * row[x];
      }
    };
    const auto fetch = [&](int y) {
      smooth_row(image, std::clamp(y, 0, size.height - 1), kRadius, rows[place(y)]);
      add(y, 1);
    };
    for (int y = first - kRadius; y < first + kRadius; ++y) fetch(y);
    for (int y = first; y < last; ++y) {
      fetch(y + kRadius);
      std::int64_t sum = 0;
      std::int64_t square = 0;
      for (std::size_t x = 0; x < kContrastWindow - 1; ++x) {
        sum += sums[x];
        square += squares[x];
      }
      float* const out = contrast.row(y);
      const auto& here = rows[place(y)];
      for (int x = 0; x < size.width; ++x) {
        const auto end = static_cast<std::size_t>(x + kContrastWindow - 1);
        sum += sums[end];
        square += squares[end];
        // Sums over 9 pixels are exact integers, so the variance is never negative.
        const auto mean = static_cast<float>(sum) / kPixels;
        const auto spread = static_cast<float>(kContrastWindow * kContrastWindow * square - sum * sum);
        const float variance = spread / (kPixels * kPixels);
        const auto value = static_cast<float>(here[static_cast<std::size_t>(x + kRadius)]);
        out[x] = (value - mean) / std::sqrt(variance + 2 * 81);
        sum -= sums[end - (kContrastWindow - 1)];
        square -= squares[end - (kContrastWindow - 1)];
      }
      add(y - kRadius, -1);
    }
  });
  return contrast;
}

}  // namespace cairn
