// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cstdint>

namespace cairn {

/// Value of a hole among disparities in 1/16 px.
inline constexpr std::int16_t kHole16 = INT16_MIN;
/// The gradient of holes: higher than any other, so the watershed floods them last.
inline constexpr std::uint16_t kHoleGradient = UINT16_MAX;
/// The cap of the disparity gradient, in 1/16 px: just under 256 px from one side of a pixel to the other.
inline constexpr int kSteepest16 = 4095;

/// d·16 rounded to the nearest integer (halves up), kHole16 in holes.
Image<std::int16_t> quantised(const DisparityMap& disparity, const Exec& exec);

/// Gradient magnitude of a quantised disparity map in 1/16 px from one side of a pixel to the other:
///   gx = d(x+1, y) − d(x−1, y), gy likewise, sqrt(gx² + gy²)
/// A missing neighbour (a hole, or outside the image) counts as equal to the pixel itself; capped at
/// kSteepest16. kHoleGradient in holes. Smoothing: the weights of image/gradient.hpp over the valid pixels of
/// the window, divided by the sum of their weights and rounded to 1/16 px (halves up); holes stay holes.
Image<std::uint16_t> gradient(View<const std::int16_t> disparity16, float smoothing_sigma, const Exec& exec);

}  // namespace cairn
