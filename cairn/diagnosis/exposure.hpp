// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/correspondences.hpp>

namespace cairn {

/// The use of the 256 grey levels by one camera, without the black border that rectification leaves.
struct Exposure {
  float black = 0;     // share of the pixels at level 0 or 1
  float white = 0;     // share of the pixels at level 254 or 255
  float contrast = 0;  // grey levels between the 1st and the 99th percentile
  float border = 0;    // share of the image that is a black border; the other numbers are of the rest
};
/// Black pixels count as a border if they reach in from the sides of the image, along a smooth line, and cover
/// from 2 to 70 % of it.
Exposure measure_exposure(View<const Gray> image);

/// The difference in brightness of the cameras: right ≈ gain · left + offset.
struct BrightnessDifference {
  static constexpr int kMinPoints = 50;
  int points = 0;  // windows compared, without clipped pixels
  float gain = 1;
  float offset = 0;  // grey levels
  float median = 0;  // of |right − left|, grey levels
  /// If false, gain, offset and median are those of equal cameras.
  [[nodiscard]] bool is_measured() const { return points >= kMinPoints; }
};
/// Robustly compares the means of windows of 9×9 px around correspondences (those with consistent rows).
/// Fewer than kMinPoints windows: not measured. If the brightness of the windows hardly varies, the gain
/// stays 1 and the offset absorbs the difference.
BrightnessDifference measure_brightness_difference(const StereoPair& pair, const Correspondences& agreeing);

}  // namespace cairn
