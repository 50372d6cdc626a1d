// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/stereo/reject.hpp>

namespace cairn {

struct TextureConfig {
  int window_size = 9;     // a constant, not an option: px, odd, 3 … 31; as wide as the correlation window
  float threshold = 4.0F;  // grey levels², 0 … 65025, −1 = off; above the camera's noise
};
template <class V>
void fields(TextureConfig& c, V&& v) {
  v("threshold", c.threshold, "grey levels²", "smallest mean squared difference to the most similar shift",
    off_or(0.0F, 65025.0F));
}

/// Marks pixels with too little texture by the Moravec operator: the minimum over the shifts s = (1,0),
/// (0,1), (1,1), (1,−1) of the mean of (I(q) − I(q+s))² over the window is below the threshold →
/// Reject::no_texture. Pairs with a pixel outside the image do not count; no pair at all → no texture.
/// (docs/stages/texture.md; paper, "Moravec operator")
Image<Reject> reject_textureless(View<const Gray> left, const TextureConfig& config, const Exec& exec);

}  // namespace cairn
