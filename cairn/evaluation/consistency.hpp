// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/view.hpp>
#include <cstdint>

namespace cairn {

/// The self-consistency of a disparity map: how far left and right disparities and images agree, measured
/// without ground truth. Counts and a sum over the pixels of the left image; frames can be added. Shares of
/// nothing are NaN.
struct Consistency {
  std::int64_t pixels = 0;
  std::int64_t matched = 0;    // with a disparity
  std::int64_t confirmed = 0;  // of these, agreeing with the winner of the right image within kConfirmedPx
  double photometric_sum = 0;  // over the confirmed: |left − warped right| / kMaxGreyDifference, at most 1

  Consistency& operator+=(const Consistency& other);
  [[nodiscard]] double density() const;      // matched / pixels
  [[nodiscard]] double agreement() const;    // confirmed / matched
  [[nodiscard]] double photometric() const;  // mean over the confirmed, 0 … 1
  /// Mean cost of a pixel, 0 … 1: kUnmatchedCost for a hole, 1 for a disparity that is not confirmed, the
  /// photometric difference for a confirmed one. So a disparity pays only if it is more likely right than
  /// wrong.
  [[nodiscard]] double loss() const;
};

inline constexpr float kConfirmedPx = 1.0F;
/// Lower than one half, the value if all confirmed disparities were right; see docs/tune.md.
inline constexpr double kUnmatchedCost = 0.25;
/// The grey level difference from which on a pixel counts as not explained.
inline constexpr double kMaxGreyDifference = 16;

/// `right` is the matched image (after correct_epipolar(), if it shifted the image), `best_right`
/// Matches::best_right: the winning disparity of each right pixel over all candidates, kNoMatch = none. All
/// of one size. The right image is first scaled to the mean and the deviation of the left one, so that
/// unequal exposure does not count, and interpolated between pixels.
Consistency consistency(View<const Gray> left, View<const Gray> right, View<const float> disparity_px,
                        View<const std::int16_t> best_right);

/// The temporal stability of disparities where the image does not change.
struct Steadiness {
  std::int64_t pixels = 0;
  std::int64_t still = 0;     // with unchanged surroundings
  std::int64_t seen = 0;      // of these, with a disparity in at least one of the frames
  std::int64_t unsteady = 0;  // of these, in one frame only, or differing by more than kConfirmedPx

  Steadiness& operator+=(const Steadiness& other);
  [[nodiscard]] double unsteady_share() const;  // unsteady / seen; NaN if seen is 0
  /// Whether the two frames are consecutive: most of the image is unchanged.
  [[nodiscard]] bool follows() const { return 2 * still > pixels; }
};

/// A pixel is still if the mean grey level difference of the 5x5 pixels around it (clipped at the border of
/// the image) is at most kStillGrey. All of one size.
Steadiness steadiness(View<const Gray> left_before, View<const Gray> left,
                      View<const float> disparity_before_px, View<const float> disparity_px);
inline constexpr int kStillGrey = 4;

}  // namespace cairn
