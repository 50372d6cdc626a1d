// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/statistics.hpp>
#include <cairn/evaluation/consistency.hpp>
#include <cairn/stereo/match.hpp>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace cairn {
namespace {

struct Moments {
  double mean = 0;
  double deviation = 0;
};

Moments moments(View<const Gray> image) {
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  for (int y = 0; y < image.height(); ++y) {
    const Gray* const row = image.row(y);
    for (int x = 0; x < image.width(); ++x) {
      sum += row[x];
      squares += row[x] * row[x];
    }
  }
  const auto count = static_cast<double>(image.size().area());
  const double mean = static_cast<double>(sum) / count;
  return {mean, std::sqrt(std::max(0.0, static_cast<double>(squares) / count - mean * mean))};
}

/// Maps grey levels of the right image to those of the left one.
struct GreyScale {
  double gain = 1;
  double offset = 0;
};

GreyScale right_to_left(View<const Gray> left, View<const Gray> right) {
  const Moments to = moments(left);
  const Moments from = moments(right);
  const double gain = from.deviation > 0 ? to.deviation / from.deviation : 1;
  return {gain, to.mean - gain * from.mean};
}

/// Whether the right image's winner for the matched pixel agrees.
bool is_confirmed(const std::int16_t* best_right, int width, int x, float disparity_px) {
  const auto at = static_cast<int>(std::lround(static_cast<float>(x) - disparity_px));
  if (at < 0 || at >= width || best_right[at] == kNoMatch) return false;
  // Winners are integers and can be half a pixel from the refined disparity.
  return std::abs(static_cast<float>(best_right[at]) - disparity_px) <= kConfirmedPx + 0.5F;
}

double grey_at(const Gray* row, int width, float x) {
  const float inside = std::clamp(x, 0.0F, static_cast<float>(width - 1));
  const auto first = static_cast<int>(inside);
  const double part = static_cast<double>(inside) - first;
  return (1 - part) * row[first] + part * row[std::min(first + 1, width - 1)];
}

constexpr int kStillRadius = 2;

/// Whether the image around left (x, y) is unchanged.
bool is_still(View<const Gray> before, View<const Gray> now, int x, int y) {
  int sum = 0;
  int count = 0;
  for (int v = std::max(0, y - kStillRadius); v <= std::min(now.height() - 1, y + kStillRadius); ++v) {
    const Gray* const a = before.row(v);
    const Gray* const b = now.row(v);
    for (int u = std::max(0, x - kStillRadius); u <= std::min(now.width() - 1, x + kStillRadius); ++u) {
      sum += std::abs(a[u] - b[u]);
      ++count;
    }
  }
  return sum <= kStillGrey * count;
}

}  // namespace

Consistency& Consistency::operator+=(const Consistency& other) {
  pixels += other.pixels;
  matched += other.matched;
  confirmed += other.confirmed;
  photometric_sum += other.photometric_sum;
  return *this;
}

double Consistency::density() const {
  return share(static_cast<double>(matched), pixels);
}
double Consistency::agreement() const {
  return share(static_cast<double>(confirmed), matched);
}
double Consistency::photometric() const {
  return share(photometric_sum, confirmed);
}
double Consistency::loss() const {
  const auto holes = static_cast<double>(pixels - matched);
  const auto contradicted = static_cast<double>(matched - confirmed);
  return share(kUnmatchedCost * holes + contradicted + photometric_sum, pixels);
}

Consistency consistency(View<const Gray> left, View<const Gray> right, View<const float> disparity_px,
                        View<const std::int16_t> best_right) {
  assert(right.size() == left.size() && disparity_px.size() == left.size() &&
         best_right.size() == left.size());
  const GreyScale scale = right_to_left(left, right);
  Consistency all;
  all.pixels = left.size().area();
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      const float d = disparity_px(x, y);
      if (std::isnan(d)) continue;
      ++all.matched;
      if (!is_confirmed(best_right.row(y), left.width(), x, d)) continue;
      ++all.confirmed;
      const double seen =
          scale.gain * grey_at(right.row(y), left.width(), static_cast<float>(x) - d) + scale.offset;
      all.photometric_sum += std::min(1.0, std::abs(left(x, y) - seen) / kMaxGreyDifference);
    }
  }
  return all;
}

Steadiness& Steadiness::operator+=(const Steadiness& other) {
  pixels += other.pixels;
  still += other.still;
  seen += other.seen;
  unsteady += other.unsteady;
  return *this;
}

double Steadiness::unsteady_share() const {
  return share(static_cast<double>(unsteady), seen);
}

Steadiness steadiness(View<const Gray> left_before, View<const Gray> left,
                      View<const float> disparity_before_px, View<const float> disparity_px) {
  assert(left_before.size() == left.size() && disparity_before_px.size() == left.size() &&
         disparity_px.size() == left.size());
  Steadiness all;
  all.pixels = left.size().area();
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      if (!is_still(left_before, left, x, y)) continue;
      ++all.still;
      const float before = disparity_before_px(x, y);
      const float now = disparity_px(x, y);
      if (std::isnan(before) && std::isnan(now)) continue;
      ++all.seen;
      // Comparisons with NaN are false: with a disparity in only one of the frames, the pixel counts as
      // unsteady.
      if (!(std::abs(now - before) <= kConfirmedPx)) ++all.unsteady;
    }
  }
  return all;
}

}  // namespace cairn
