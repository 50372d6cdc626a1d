// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>

/// Images of a fraction of their size, as cameras and ROS bin them: one pixel for factor × factor. What remains at the right
/// and lower border is left out. Precondition: 1 ≤ factor ≤ both sides.
namespace cairn {

inline constexpr int kMaxBinning = 8;

/// Means, rounded, halves up.
Image<Gray> binned(View<const Gray> image, int factor, const Pool& pool = {});
Image<Rgb> binned(View<const Rgb> image, int factor, const Pool& pool = {});
/// Disparities of the smaller image, px: of each bin the median of those that are known (of two, the smaller), divided by
/// `factor`, so none lies between two surfaces. NaN where none is known.
Image<float> binned_disparity(View<const float> disparity_px, int factor, const Pool& pool = {});

}  // namespace cairn
