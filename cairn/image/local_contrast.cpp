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

/// The contrast of each value of a row, in a loop that compilers vectorise.
void compare(const std::int32_t* row, const std::vector<std::int32_t>& sums,
             const std::vector<std::int32_t>& squares, float* out) {
  for (std::size_t x = 0; x < sums.size(); ++x) {
    const auto mean = static_cast<float>(sums[x]) / kPixels;
    // Exact in doubles, so the variance is never negative.
    const double sum = sums[x];
    const auto spread = static_cast<float>(double{kPixels} * squares[x] - sum * sum);
    const float variance = spread / (kPixels * kPixels);
    out[x] = (static_cast<float>(row[x]) - mean) / std::sqrt(variance + 2 * 81);
  }
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
    std::vector<std::int32_t> window_sums(static_cast<std::size_t>(size.width));
    std::vector<std::int32_t> window_squares(static_cast<std::size_t>(size.width));
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
      // Of the window's pixels: at most 169 · 9 · 255, and 169 · (9 · 255)².
      std::int32_t sum = 0;
      std::int32_t square = 0;
      for (std::size_t x = 0; x < kContrastWindow - 1; ++x) {
        sum += sums[x];
        square += squares[x];
      }
      for (std::size_t x = 0; x < window_sums.size(); ++x) {
        window_sums[x] = sum += sums[x + kContrastWindow - 1];
        window_squares[x] = square += squares[x + kContrastWindow - 1];
        sum -= sums[x];
        square -= squares[x];
      }
      compare(&rows[place(y)][kRadius], window_sums, window_squares, contrast.row(y));
      add(y - kRadius, -1);
    }
  });
  return contrast;
}

}  // namespace cairn
