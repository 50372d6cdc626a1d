// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/disparity_map.hpp>

namespace cairn {

struct SpeckleConfig {
  int size = 50;       // px, 0 … 1000000, −1 = off; higher removes larger islands
  float range = 1.0F;  // a constant, not an option: px of disparity; less splits slanted surfaces
};
template <class V>
void fields(SpeckleConfig& c, V&& v) {
  v("size", c.size, "px", "largest disparity island that is rejected (OpenCV's speckleWindowSize)",
    off_or(0, 1000000));
}

/// Rejects small islands: components of 4-connected pixels whose neighbours differ by at most `range`, of
/// `size` pixels or fewer → Reject::speckle. (docs/stages/speckle.md, beyond the paper; OpenCV's
/// filterSpeckles)
DisparityMap reject_speckles(DisparityMap disparity, const SpeckleConfig& config, const Exec& exec);

}  // namespace cairn
