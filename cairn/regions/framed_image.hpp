// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/image.hpp>
#include <cstdint>

namespace cairn {

/// Interleaved channels, with a frame of zeros one pixel wide. Private to the library.
inline Image<std::int16_t> framed_image(Size size, int channels, const Pool& pool) {
  Image<std::int16_t> framed({(size.width + 2) * channels, size.height + 2}, pool);
  std::fill_n(framed.row(0), framed.width(), std::int16_t{0});
  std::fill_n(framed.row(size.height + 1), framed.width(), std::int16_t{0});
  for (int y = 1; y <= size.height; ++y) {
    std::fill_n(framed.row(y), channels, std::int16_t{0});
    std::fill_n(framed.row(y) + (size.width + 1) * channels, channels, std::int16_t{0});
  }
  return framed;
}

}  // namespace cairn
