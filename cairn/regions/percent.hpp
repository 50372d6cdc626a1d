// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cmath>
#include <cstdint>

namespace cairn {

/// An area in per cent of the image, in pixels, rounded up.
inline std::int64_t pixels_in(float percent, Size image) {
  return static_cast<std::int64_t>(
      std::ceil(static_cast<double>(percent) * static_cast<double>(image.area()) / 100.0));
}

}  // namespace cairn
