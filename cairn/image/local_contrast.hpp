// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>

namespace cairn {

inline constexpr int kContrastWindow = 13;  // px

/// The brightness of each pixel relative to its surroundings, in their standard deviations:
///   (s − mean) / sqrt(variance + 2)
/// s is the mean of 3 × 3 pixels; mean and variance are those of s in the window centred on the pixel. The
/// border is replicated. A dimmed copy of an image has the same contrast.
Image<float> local_contrast(View<const Gray> image, const Exec& exec);

}  // namespace cairn
