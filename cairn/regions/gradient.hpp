// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cstdint>

namespace cairn {

/// Disparity in 1/16 px as the regions count it; kHole16 where the map has a hole.
inline constexpr std::int16_t kHole16 = INT16_MIN;
/// The gradient that holes get: higher than any other, so that the watershed floods them last.
inline constexpr std::uint16_t kHoleGradient = UINT16_MAX;

/// Gradient magnitude of the Gaussian-smoothed grey image, 0 … 255: smoothing in fixed point (radius ⌈3σ⌉ at most 15,
/// border replicated, σ = 0: none), central differences, sqrt(gx² + gy²) rounded and capped. (METHOD §4)
Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma, const Exec& exec);

/// d·16 rounded to the nearest integer, kHole16 in holes.
Image<std::int16_t> quantised(const DisparityMap& disparity, const Exec& exec);

/// Gradient magnitude of a quantised disparity map in 1/16 px: one-sided or central differences over valid neighbours
/// only (a missing neighbour counts as equal), kHoleGradient in holes. `smoothing_sigma`: as above, over the valid
/// pixels of the window, normalised by their weight. (METHOD §5 a)
Image<std::uint16_t> gradient(View<const std::int16_t> disparity16, float smoothing_sigma, const Exec& exec);

}  // namespace cairn
