// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <vector>

namespace cairn {

/// A point of the scene seen in both images, px, between the pixels.
struct Correspondence {
  float x_left = 0;
  float y_left = 0;
  float x_right = 0;
  float y_right = 0;
  [[nodiscard]] float disparity() const { return x_left - x_right; }
  /// How much lower it stands in the right image.
  [[nodiscard]] float rows() const { return y_right - y_left; }
};

struct Correspondences {
  std::vector<Correspondence> list;  // in raster order of the left image
  int points = 0;                    // textured points of the left image that were looked for
  Size size;                         // of the images
};

/// How far from its own place a point is looked for: a share of the width to either side, since cameras may
/// be swapped, and of the height up and down, since the pair need not be rectified.
inline constexpr float kWidestDisparity = 0.4F;
inline constexpr float kMostRowsOff = 0.125F;

/// Sparse points of the left image found again anywhere in the right one: no calibration, no epipolar line
/// and no sign of the disparity is taken for granted. Windows are correlated (zero mean, normalised) in
/// images of at most 400 columns (one step finer where these show little texture); a match stays where no
/// other place is nearly as much alike and where the search from the right image leads back, and is then
/// placed between the pixels up to full resolution.
Correspondences find_correspondences(const StereoPair& pair, const Exec& exec);

}  // namespace cairn
