// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/correspondences.hpp>

namespace cairn {

/// How one camera used its 256 grey levels.
struct Exposure {
  float black = 0;     // share of the pixels at level 0 or 1
  float white = 0;     // share of the pixels at level 254 or 255
  float contrast = 0;  // grey levels between the darkest and the brightest hundredth of the pixels
};
Exposure measure_exposure(View<const Gray> image);

/// What the right camera makes of the left one's brightness: right ≈ gain · left + offset.
struct BrightnessDifference {
  static constexpr int kLeastPoints = 50;
  int points = 0;  // windows compared; neither clipped
  float gain = 1;
  float offset = 0;  // grey levels
  float median = 0;  // of |right − left|, grey levels
  /// Otherwise gain, offset and median are those of equal cameras.
  [[nodiscard]] bool is_measured() const { return points >= kLeastPoints; }
};
/// Compares means of windows of 9×9 px around correspondences (those that agree in their rows), robustly.
/// Fewer than kLeastPoints windows: no difference is measured. Where the windows' brightness hardly varies
/// the gain stays 1 and the offset takes it all.
BrightnessDifference measure_brightness_difference(const StereoPair& pair, const Correspondences& agreeing);

}  // namespace cairn
