// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <optional>

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
    range(0.0F, 255.0F), when("fusion.method", "evidence"));
}

/// The standard deviation of the image's noise in grey levels: the median of |response| to a kernel that
/// answers to neither steps nor ramps (1 −2 1; −2 4 −2; 1 −2 1), over 6·0.6745. Images under 3×3 have none
/// (0). (beyond the paper)
float noise_sigma(View<const Gray> image, const Exec& exec = {});

/// The disparities that rest on the pixel's own texture, NaN elsewhere: valid ones where the horizontal
/// gradient stands out of the noise and is no mere grazing edge (|gx| > |gy|/2), and at least three pixels of
/// the 5×5 neighbourhood that pass the same test agree. Elsewhere a matcher can only have carried disparity
/// over from the surroundings, which is how near objects grow over their borders. `noise`: noise_sigma(left),
/// where that is known. (beyond the paper)
Image<float> find_evidence(View<const Gray> left, const DisparityMap& disparity, const EvidenceConfig& config,
                           const Exec& exec, std::optional<float> noise = std::nullopt);

}  // namespace cairn
