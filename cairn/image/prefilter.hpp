// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

namespace cairn {

/// The horizontal Sobel response, clipped to ±cap and shifted by cap: 0 … 2·cap grey levels. Unaffected by a
/// brightness offset between the cameras, so suitable for plain SAD. Rows are mirrored at the border; the
/// first and the last column have no response (= cap). (OpenCV's StereoBM x-Sobel prefilter, which skips the
/// last row of an odd number; here it is filtered too.)
Image<Gray> filter_xsobel(View<const Gray> image, int cap, const Exec& exec);

inline constexpr int kMeanSteps = 16;

/// Each pixel minus the mean of the window centred on it (clipped at the border), in 1/16 grey level; the
/// mean is rounded to the nearest step, halves up. The input of zsad. (docs/stages/matching.md)
Image<std::int16_t> remove_mean(View<const Gray> image, int window_size, const Exec& exec);

}  // namespace cairn
