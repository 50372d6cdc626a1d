// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

/// The shift of the disparities of some pixels at which both images agree. Private to the library.
namespace cairn {

/// Pixels of a row, first ≤ x < last, with a neighbour on both sides in the image.
struct Stretch {
  int y;
  int first;
  int last;
};

inline constexpr int kOutline = 4;  // px at either end of a row, which keep the disparity of the outline
inline constexpr double kShiftSigma = 0.2;  // px, standard deviation of the prior of the shift

/// Of an object of so many pixels every n-th row is matched: more pixels hardly make the shift more certain, but take
/// as long each. 1 below 32,768 pixels.
inline int row_step(std::int64_t pixels) {
  constexpr std::int64_t kEnough = 1 << 14;
  return static_cast<int>(std::max<std::int64_t>(1, pixels / kEnough));
}

struct ShiftEstimate {
  double shift_px = 0;
  double certainty = 0;  // 1 / variance of the shift by the images alone
};

namespace object_match {

constexpr double kLargestStep = 0.5;  // px; brightness is nearly linear within it
// Chosen on the fit set; results hardly change with half or twice these values.
constexpr double kPixelsAsOne = 16;  // pixels per independent measurement: neighbouring errors correlate
constexpr double kRounding = 1;      // grey levels²; lower limit of the variance of the residuals

/// Sums over pixels of the horizontal gradient g of the left image and of the residual e, the shifted right
/// image minus the left one.
struct Sums {
  double n = 0;
  double g = 0;
  double e = 0;
  double gg = 0;
  double ge = 0;
  double ee = 0;
  [[nodiscard]] double var_g() const { return gg - g * g / n; }
  [[nodiscard]] double cov() const { return ge - g * e / n; }
  [[nodiscard]] double var_e() const { return ee - e * e / n; }
};

template <class Disparity>
Sums compare(const std::vector<Stretch>& stretches, const Disparity& disparity_at, View<const Gray> left,
             View<const Gray> right, double shift_px) {
  Sums sums;
  const auto farthest = static_cast<double>(left.width() - 2);
  for (const auto& [y, first, last] : stretches) {
    const Gray* const l = left.row(y);
    const Gray* const r = right.row(y);
    for (int x = first; x < last; ++x) {
      const double at = x - disparity_at(x, y) - shift_px;
      if (!(at >= 0 && at <= farthest)) continue;
      const auto whole = static_cast<int>(at);
      const double part = at - whole;
      const double g = 0.5 * (int{l[x + 1]} - int{l[x - 1]});
      const double e = int{r[whole]} + part * (int{r[whole + 1]} - int{r[whole]}) - int{l[x]};
      sums.n += 1;
      sums.g += g;
      sums.e += e;
      sums.gg += g * g;
      sums.ge += g * e;
      sums.ee += e * e;
    }
  }
  return sums;
}

}  // namespace object_match

/// Two steps of least squares on the brightness, with a common offset of both images, and a prior of no shift
/// with a standard deviation of `sigma_px` (docs/stages/objects.md). disparity_at(x, y): px. `stretches`: of every
/// `step`-th row.
template <class Disparity>
ShiftEstimate match_shift(const std::vector<Stretch>& stretches, const Disparity& disparity_at,
                          View<const Gray> left, View<const Gray> right, double sigma_px, int step) {
  using namespace object_match;
  constexpr int kSteps = 2;
  const double prior = 1 / (sigma_px * sigma_px);
  ShiftEstimate estimate;
  for (int i = 0; i < kSteps; ++i) {
    const Sums sums = compare(stretches, disparity_at, left, right, estimate.shift_px);
    double wanted = -prior * estimate.shift_px;
    estimate.certainty = 0;
    if (sums.n > 0) {
      const double variance = kPixelsAsOne / step * (sums.var_e() / sums.n + kRounding);
      wanted += sums.cov() / variance;
      estimate.certainty = sums.var_g() / variance;
    }
    estimate.shift_px += std::clamp(wanted / (prior + estimate.certainty), -kLargestStep, kLargestStep);
  }
  return estimate;
}

}  // namespace cairn
