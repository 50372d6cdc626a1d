// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/diagnosis/correspondences.hpp>

namespace cairn {

/// The row misalignment of a pair, from correspondences. A point in row y of the left image belongs in row y
/// of the right one. A small shift or roll between the cameras moves it to
///   y + offset_rows + rows_per_px · (x_right − (width − 1)/2)
/// and in a pair that is not rectified it is further off.
struct RowAlignment {
  int points = 0;            // correspondences
  float offset_rows = 0;     // at the centre column
  float rows_per_px = 0;     // tangent of the roll
  int agreeing = 0;          // correspondences within a row of a smooth distortion
  float left_over_rows = 0;  // 90th percentile of the row error without shift and roll
  [[nodiscard]] double agreeing_share() const {
    return points > 0 ? static_cast<double>(agreeing) / points : 0.0;
  }
  static constexpr int kMinForRoll = 24;   // consistent points; with fewer rows_per_px is 0
  static constexpr int kMinForField = 40;  // the same for left_over_rows
  static constexpr int kMaxBins = 8;
  /// Points by y_right − y_left, rounded, from −8 to 8 rows; the outermost bins include all beyond.
  std::array<int, 2 * kMaxBins + 1> histogram{};
};

/// The roll is 0 with fewer than 24 consistent points, or below five of its standard errors; left_over_rows
/// is 0 with fewer than 40. The smooth distortion is a polynomial of the second degree in the position and of
/// the first in the disparity: the effect of lens distortion, a rotation about any axis, a wrong focal length
/// and cameras at unequal heights. It is fitted robustly (Cauchy weights).
RowAlignment measure_row_alignment(const Correspondences& found);

/// The correspondences within a row of the smooth distortion; the others are false matches.
Correspondences agreeing_ones(const Correspondences& found);

}  // namespace cairn
