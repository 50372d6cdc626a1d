// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/robust_fit.hpp>
#include <cairn/diagnosis/exposure.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

namespace cairn {
namespace {

constexpr std::size_t kLevels = 256;

int level_below(const std::array<std::int64_t, kLevels>& counts, std::int64_t pixels) {
  std::int64_t sum = 0;
  for (std::size_t level = 0; level < kLevels; ++level) {
    sum += counts[level];
    if (sum > pixels) return static_cast<int>(level);
  }
  return kLevels - 1;
}

/// For each line of the image, the number of black pixels up to its first other one. All 0 if the ends of these
/// runs do not form a smooth line, as in a scene that is dark at the side.
template <class IsBlack>
std::vector<int> runs(int lines, int length, IsBlack is_black) {
  std::vector<int> all(static_cast<std::size_t>(lines), 0);
  for (int i = 0; i < lines; ++i) {
    int& run = all[static_cast<std::size_t>(i)];
    while (run < length && is_black(i, run)) ++run;
  }
  constexpr int kSmooth = 2;  // px from line to line; a steeper border is smooth along the other side
  int reaching = 0;
  int jumps = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    reaching += all[i] > 0 ? 1 : 0;
    jumps += i > 0 && std::abs(all[i] - all[i - 1]) > kSmooth ? 1 : 0;
  }
  if (20 * jumps > reaching) std::fill(all.begin(), all.end(), 0);
  return all;
}

/// The width of the border at each side, by row or column.
struct Border {
  std::vector<int> left;
  std::vector<int> right;
  std::vector<int> top;
  std::vector<int> bottom;
  [[nodiscard]] bool contains(int x, int y) const {
    const auto column = static_cast<std::size_t>(x);
    const auto row = static_cast<std::size_t>(y);
    const int width = static_cast<int>(top.size());
    const int height = static_cast<int>(left.size());
    return x < left[row] || x >= width - right[row] || y < top[column] || y >= height - bottom[column];
  }
};

Border border_of(View<const Gray> image) {
  constexpr int kBlack = 1;
  const int w = image.width();
  const int h = image.height();
  const auto is_black = [&](int x, int y) { return image(x, y) <= kBlack; };
  return {runs(h, w, [&](int y, int i) { return is_black(i, y); }),
          runs(h, w, [&](int y, int i) { return is_black(w - 1 - i, y); }),
          runs(w, h, [&](int x, int i) { return is_black(x, i); }),
          runs(w, h, [&](int x, int i) { return is_black(x, h - 1 - i); })};
}

constexpr int kRadius = 4;  // px, of the windows to compare

/// Mean of the window; nullopt if it leaves the image or contains clipped pixels.
std::optional<double> mean_around(View<const Gray> image, float x_px, float y_px) {
  const auto x0 = static_cast<int>(std::lround(x_px)) - kRadius;
  const auto y0 = static_cast<int>(std::lround(y_px)) - kRadius;
  constexpr int kSide = 2 * kRadius + 1;
  if (x0 < 0 || y0 < 0 || x0 + kSide > image.width() || y0 + kSide > image.height()) return std::nullopt;
  int sum = 0;
  for (int y = y0; y < y0 + kSide; ++y) {
    for (int x = x0; x < x0 + kSide; ++x) {
      const int level = image(x, y);
      if (level <= 1 || level >= 254) return std::nullopt;
      sum += level;
    }
  }
  return static_cast<double>(sum) / (kSide * kSide);
}

}  // namespace

Exposure measure_exposure(View<const Gray> image) {
  std::array<std::int64_t, kLevels> counts{};
  for (int y = 0; y < image.height(); ++y) {
    const Gray* row = image.row(y);
    for (int x = 0; x < image.width(); ++x) ++counts[row[x]];
  }
  std::int64_t area = image.size().area();
  constexpr double kMinBorder = 0.02;
  constexpr double kMaxBorder = 0.7;
  const double black = static_cast<double>(counts[0] + counts[1]) / static_cast<double>(area);
  float border = 0;
  if (black >= kMinBorder) {
    const Border sides = border_of(image);
    std::array<std::int64_t, 2> in_border{};  // by level
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (sides.contains(x, y)) ++in_border[image(x, y)];
      }
    }
    const std::int64_t pixels = in_border[0] + in_border[1];
    const double share = static_cast<double>(pixels) / static_cast<double>(area);
    if (share >= kMinBorder && share <= kMaxBorder) {
      border = static_cast<float>(share);
      counts[0] -= in_border[0];
      counts[1] -= in_border[1];
      area -= pixels;
    }
  }
  const auto share = [&](std::int64_t count) { return static_cast<float>(count) / static_cast<float>(area); };
  return {share(counts[0] + counts[1]), share(counts[254] + counts[255]),
          static_cast<float>(level_below(counts, area - 1 - area / 100) - level_below(counts, area / 100)),
          border};
}

BrightnessDifference measure_brightness_difference(const StereoPair& pair, const Correspondences& agreeing) {
  constexpr double kMiddle = 128;
  constexpr double kScale = 4;       // grey levels; typical difference between windows
  constexpr double kMinSpread = 20;  // grey levels between the darker and the brighter windows
  std::vector<Equation<2>> equations;
  std::vector<double> differences;
  std::vector<double> levels;
  for (const Correspondence& c : agreeing.list) {
    const auto left = mean_around(pair.left(), c.x_left, c.y_left);
    const auto right = mean_around(pair.right(), c.x_right, c.y_right);
    if (!left || !right) continue;
    equations.push_back({{1, (*left - kMiddle) / kMiddle}, *right - *left});
    differences.push_back(std::abs(*right - *left));
    levels.push_back(*left);
  }
  BrightnessDifference result;
  result.points = static_cast<int>(equations.size());
  if (!result.is_measured()) return result;
  result.median = static_cast<float>(quantile(differences, 0.5));
  if (quantile(levels, 0.9) - quantile(levels, 0.1) < kMinSpread) {
    std::vector<double> signed_differences;
    signed_differences.reserve(equations.size());
    for (const auto& e : equations) signed_differences.push_back(e.value);
    result.offset = static_cast<float>(quantile(signed_differences, 0.5));
    return result;
  }
  const std::array<double, 2> fit = fit_robustly<2>(equations, kScale);
  result.gain = static_cast<float>(1 + fit[1] / kMiddle);
  result.offset = static_cast<float>(fit[0] - fit[1]);
  return result;
}

}  // namespace cairn
