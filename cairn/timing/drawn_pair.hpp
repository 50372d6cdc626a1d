// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/match.hpp>
#include <cstdint>

/// A synthetic pair for timing without input: the same pixels on every machine.
namespace cairn::timing {

struct DrawnPair {
  Image<Gray> left;
  Image<Gray> right;
  Image<Rgb> left_rgb;
  Image<Rgb> right_rgb;
  Image<float> disparity_px;   // of every left pixel, exact
  Image<std::uint8_t> hidden;  // 1: the right camera does not see this left pixel
  StereoRig rig;

  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left, right, left_rgb); }
};

/// A room: a tiled floor, a wall, and textured boxes on the floor, with sub-pixel disparities, a little
/// sensor noise and different texture everywhere. The floor at the bottom row has `largest_disparity_px`;
/// boxes and texture scale with the image.
DrawnPair draw_pair(Size size, float largest_disparity_px);
/// The same with three quarters of the searched range as the largest disparity.
DrawnPair draw_pair(Size size, const MatchConfig& match);

}  // namespace cairn::timing
