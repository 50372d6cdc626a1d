// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/view.hpp>
#include <cstdint>

namespace cairn {

/// How far a pair's disparities contradict themselves and the pictures: what can be said without any truth.
/// Counts and a sum over the left image's pixels; frames add up. Shares are NaN where there is nothing to
/// share.
struct Consistency {
  std::int64_t pixels = 0;
  std::int64_t matched = 0;    // with a disparity
  std::int64_t confirmed = 0;  // of these, the right image's own winner agrees within kConfirmedPx
  double photometric_sum =
      0;  // over the confirmed: |left − right warped to it| / kFarthestGrey, 1 at most each

  Consistency& operator+=(const Consistency& other);
  [[nodiscard]] double density() const;      // matched / pixels
  [[nodiscard]] double agreement() const;    // confirmed / matched
  [[nodiscard]] double photometric() const;  // mean over the confirmed, 0 … 1
  /// What a pixel costs in the mean, 0 … 1: a hole kHoleCost, a disparity that is not confirmed 1, a
  /// confirmed one its photometric difference. So a disparity pays only where it is more likely right than
  /// wrong.
  [[nodiscard]] double loss() const;
};

inline constexpr float kConfirmedPx = 1.0F;
/// Less than the half that it would be were the confirmed ones all right; docs/tune.md says how it was
/// chosen.
inline constexpr double kUnmatchedCost = 0.25;
/// Grey levels of difference from which on a pixel is explained no better.
inline constexpr double kFarthestGrey = 16;

/// `right` is the picture that was matched (after correct_epipolar(), where that moved it), `best_right`
/// Matches::best_right: per right pixel the disparity that fits best out of all candidates, kNoMatch = none.
/// All of one size. The right picture's grey levels are first given the mean and the deviation of the left's,
/// so that unequal exposure is no difference, and interpolated between two pixels.
Consistency consistency(View<const Gray> left, View<const Gray> right, View<const float> disparity_px,
                        View<const std::int16_t> best_right);

/// How steady disparities are from one frame to the next, where the picture stands still.
struct Steadiness {
  std::int64_t pixels = 0;
  std::int64_t still = 0;     // around these the picture is as it was
  std::int64_t seen = 0;      // of these, with a disparity in one of the frames or in both
  std::int64_t unsteady = 0;  // of these, with one in one frame only, or off by more than kConfirmedPx

  Steadiness& operator+=(const Steadiness& other);
  [[nodiscard]] double unsteady_share() const;  // unsteady / seen; NaN where nothing is
  /// Whether the two frames follow each other: most of the picture is as it was.
  [[nodiscard]] bool follows() const { return 2 * still > pixels; }
};

/// A pixel is still where the grey levels of the 5x5 pixels around it (clipped at the image's border) differ
/// by no more than kStillGrey in the mean. All of one size.
Steadiness steadiness(View<const Gray> left_before, View<const Gray> left,
                      View<const float> disparity_before_px, View<const float> disparity_px);
inline constexpr int kStillGrey = 4;

}  // namespace cairn
