// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

namespace cairn {

/// Gradient magnitude of the Gaussian-smoothed grey image, 0 … 255, in grey levels from one side of a pixel
/// to the other:
///   gx = s(x+1, y) − s(x−1, y), gy likewise, sqrt(gx² + gy²) rounded and capped
/// Fixed-point smoothing: weights round(256·g(i)) for |i| ≤ ⌈3σ⌉ (at most 15), g normalised to 1, the centre
/// absorbs the rounding; border replicated; s is rounded to 1/16 grey level. σ = 0: no smoothing.
Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma, const Exec& exec);

/// Edge strength for superpixels: central differences (s(x+1) − s(x−1))/2 in 1/4 grey level, not capped; with
/// colour (`rgb` not empty) the maximum over the three channels, so that edges between equal grey levels
/// count. (beyond the paper)
Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma,
                                   const Exec& exec);

}  // namespace cairn
