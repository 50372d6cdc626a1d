// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/disparity/disparity_map.hpp>

namespace cairn {

struct EvidenceConfig {
  // No option, a constant: σ of the noise; least horizontal gradient of evidence is this many deviations …
  float noise_factor = 1.0F;
  float gradient_min =
      0.65F;  // grey levels, 0 … 255; … plus this; more trusts fewer pixels: for dim pictures
  // No option, a constant: ‰ of the width; how far the disparities of neighbouring evidence may lie apart.
  float agreement = 2.5F;
};
template <class V>
void fields(EvidenceConfig& c, V&& v) {
  v("gradient_min", c.gradient_min, "grey levels",
    "how far a pixel's horizontal gradient must exceed the image's noise to count as evidence",
    range(0.0F, 255.0F), when("fusion.method", "hierarchy"));
}

/// The disparities that rest on the pixel's own texture, NaN elsewhere: valid ones where the horizontal
/// gradient stands out of the noise and is no mere grazing edge (|gx| > |gy|/2), and at least three pixels of
/// the 5×5 neighbourhood that pass the same test agree. Elsewhere a matcher can only have carried disparity
/// over from the surroundings, which is how near objects grow over their borders. `noise_sigma`: of the left
/// image. (beyond the paper)
Image<float> find_evidence(View<const Gray> left, const DisparityMap& disparity, float noise_sigma,
                           const EvidenceConfig& config, const Exec& exec);

}  // namespace cairn
