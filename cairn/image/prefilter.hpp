// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

namespace cairn {

/// The horizontal Sobel response, clipped to ±cap and shifted by cap: 0 … 2·cap grey levels. Blind to an
/// offset between the cameras, so that plain SAD can stand one. Rows beyond the border are mirrored about it;
/// the first and the last column have no response (= cap). (OpenCV's StereoBM x-Sobel prefilter, which leaves
/// out the last of an odd number of rows; here it is filtered too.)
Image<Gray> filter_xsobel(View<const Gray> image, int cap, const Exec& exec);

inline constexpr int kMeanSteps = 16;

/// Each pixel less the mean of the window centred on it (clipped at the image's border), in 1/16 grey levels;
/// the mean is rounded to the nearest step, halves up. The images that zsad compares.
/// (docs/stages/matching.md)
Image<std::int16_t> remove_mean(View<const Gray> image, int window_size, const Exec& exec);

}  // namespace cairn
