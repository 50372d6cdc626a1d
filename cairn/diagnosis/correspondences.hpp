// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <vector>

namespace cairn {

/// A scene point seen in both images, in px, with subpixel accuracy.
struct Correspondence {
  float x_left = 0;
  float y_left = 0;
  float x_right = 0;
  float y_right = 0;
  [[nodiscard]] float disparity() const { return x_left - x_right; }
  /// How much lower the point is in the right image.
  [[nodiscard]] float rows() const { return y_right - y_left; }
};

struct Correspondences {
  std::vector<Correspondence> list;  // in raster order of the left image
  int points = 0;                    // textured points of the left image, matched or not
  Size size;                         // of the images
};

/// The search area around a point, as shares: of the width to either side, since the cameras may be swapped,
/// and of the height up and down, since the pair may not be rectified.
inline constexpr float kWidestDisparity = 0.4F;
inline constexpr float kMaxRowsOff = 0.125F;

/// Sparse points of the left image matched anywhere in the right one, without assuming a calibration,
/// epipolar lines or the sign of the disparity. Windows are correlated (zero mean, normalised) in images of
/// at most 400 columns (the next finer scale if these show little texture). A match is kept if no other place
/// is nearly as similar and the search from the right image leads back to it; it is then refined to subpixel
/// accuracy at full resolution. If the contrast of the images differs by half or more, the weaker one is stretched
/// first: the refinement compares grey levels.
Correspondences find_correspondences(const StereoPair& pair, const Exec& exec);

}  // namespace cairn
