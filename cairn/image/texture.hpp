// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

namespace cairn {

/// How much texture is enough.
struct TextureLimit {
  int window_size;  // px, odd, 31 at most
  float threshold;  // grey levels², not negative
};

/// 1 where a pixel lacks texture, else 0: the Moravec operator, the least over the shifts s = (1,0), (0,1),
/// (1,1), (1,−1) of the mean over the window of (I(q) − I(q+s))², below the threshold. Pairs of which either
/// pixel lies outside the image do not count; no pair at all is no texture.
Image<std::uint8_t> lacks_texture(View<const Gray> image, const TextureLimit& limit, const Exec& exec);

}  // namespace cairn
