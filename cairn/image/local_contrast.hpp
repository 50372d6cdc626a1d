// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>

namespace cairn {

inline constexpr int kContrastWindow = 13;  // px

/// How much brighter each pixel is than its surroundings, in standard deviations of these: (s − mean) /
/// sqrt(variance
/// + 2), where s is the mean of the 3 × 3 pixels about it, and mean and variance are those of s in the window
/// centred on it. Beyond the border the nearest pixel counts. Dimmed copies of a picture have the same
/// contrast.
Image<float> local_contrast(View<const Gray> image, const Exec& exec);

}  // namespace cairn
