// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/diagnosis/correspondences.hpp>

namespace cairn {

/// How well the two images' rows are the same, from correspondences. What the left image shows in row y
/// should stand in the right one's row y; where the cameras differ by a small shift or turn it stands at y +
/// offset_rows + rows_per_px · (x_right − (width − 1)/2), and where the pair is not rectified it strays
/// further.
struct RowAlignment {
  int points = 0;            // correspondences
  float offset_rows = 0;     // in the middle column
  float rows_per_px = 0;     // the roll's tangent
  int agreeing = 0;          // those of them within a row of what a smooth distortion explains
  float left_over_rows = 0;  // how far 9 in 10 points at most are off once shift and roll are taken back
  [[nodiscard]] double agreeing_share() const {
    return points > 0 ? static_cast<double>(agreeing) / points : 0.0;
  }
  static constexpr int kLeastForRoll = 24;   // points that agree; fewer leave rows_per_px 0
  static constexpr int kLeastForField = 40;  // the same of left_over_rows
  static constexpr int kMostBins = 8;
  /// Points by y_right − y_left, rounded, from −8 to 8 rows; the outermost count all beyond.
  std::array<int, 2 * kMostBins + 1> histogram{};
};

/// Where fewer than 24 points agree, or the roll is below five of its standard errors, it is 0; below 40 that
/// agree the left-over does. The smooth distortion is a polynomial of the second degree in the place and of
/// the first in the disparity, which lens distortion, a turn about any axis, a wrong focal length and cameras
/// at unequal heights make; it is fitted robustly (Cauchy's weights).
RowAlignment measure_row_alignment(const Correspondences& found);

/// Where the points agree, those within a row of the smooth distortion: the others are false matches.
Correspondences agreeing_ones(const Correspondences& found);

}  // namespace cairn
