// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/view.hpp>
#include <cstddef>
#include <cstdint>

namespace cairn {

/// A matched pixel is bad-t if its disparity is off by more than t px.
inline constexpr std::array kBadThresholdsPx{0.5F, 1.0F, 2.0F, 4.0F};

/// Counts and sums over pixels with known disparity; sets of pixels can be added.
struct DisparityErrors {
  std::int64_t known = 0;                                   // pixels with truth
  std::int64_t matched = 0;                                 // of these, pixels with an estimated disparity
  std::array<std::int64_t, kBadThresholdsPx.size()> bad{};  // of the matched, per threshold
  double absolute_sum_px = 0;                               // of |ours − truth| over the matched
  double square_sum_px2 = 0;
  double square_sum_within_1_px2 = 0;  // over errors of at most 1 px

  DisparityErrors& operator+=(const DisparityErrors& other);
  /// Shares of 0 … 1 and px; NaN if the denominator is 0. `t` indexes kBadThresholdsPx.
  [[nodiscard]] double density() const;
  [[nodiscard]] double bad_of_matched(std::size_t t) const;
  [[nodiscard]] double bad_of_known(std::size_t t) const;  // a hole counts as bad
  [[nodiscard]] double mean_absolute_px() const;
  [[nodiscard]] double root_mean_square_px() const;
  /// Root mean square over errors of at most 1 px: σ_d of a correct match.
  [[nodiscard]] double sigma_px() const;
};

/// Compares two disparity maps of one size; NaN = a hole, or a pixel without truth (there also ±infinity).
/// `excluded` (may be empty): pixels with a value other than 0 are skipped, e.g. those occluded in the right
/// image. `skip_left`: columns x < skip_left are skipped (for matchers that cannot fill them).
/// (docs/evaluation.md)
DisparityErrors disparity_errors(View<const float> ours_px, View<const float> truth_px,
                                 View<const std::uint8_t> excluded, int skip_left);

}  // namespace cairn
