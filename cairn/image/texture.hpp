// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

namespace cairn {

/// The texture that a pixel needs.
struct TextureLimit {
  int window_size;  // px, odd, 31 at most
  float threshold;  // grey levels², not negative
};

/// 1 for pixels without texture, else 0, by the Moravec operator: the minimum over the shifts s = (1,0),
/// (0,1), (1,1), (1,−1) of the mean of (I(q) − I(q+s))² over the window is below the threshold. Pairs with a
/// pixel outside the image do not count; no pair at all is no texture.
Image<std::uint8_t> lacks_texture(View<const Gray> image, const TextureLimit& limit, const Exec& exec);

}  // namespace cairn
