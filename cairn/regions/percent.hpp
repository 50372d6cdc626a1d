// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/geometry.hpp>
#include <cmath>
#include <cstdint>

namespace cairn {

/// An area in per cent of the image, in pixels, rounded up.
inline std::int64_t pixels_in(float percent, Size image) {
  return static_cast<std::int64_t>(
      std::ceil(static_cast<double>(percent) * static_cast<double>(image.area()) / 100.0));
}

/// The pixels that decide how many superpixels and cells of hints an image has: its own, but no fewer than those of
/// 320×240, and no more than those of 480×360.
inline std::int64_t pixels_of_detail(Size image) {
  return std::clamp(image.area(), std::int64_t{320 * 240}, std::int64_t{480 * 360});
}

}  // namespace cairn
