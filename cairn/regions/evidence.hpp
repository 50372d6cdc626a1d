// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/left_image.hpp>
#include <cairn/stereo/disparity_map.hpp>

namespace cairn {

struct EvidenceConfig {
  // A constant, not an option: noise σ; a textured pixel has a horizontal gradient of at least this times σ …
  float noise_factor = 1.0F;
  float gradient_min = 0.65F;  // grey levels, 0 … 255; … plus this; higher trusts fewer pixels (dark images)
  // A constant, not an option: ‰ of the width; largest difference between neighbouring textured disparities.
  float agreement = 2.5F;
};
template <class V>
void fields(EvidenceConfig& c, V&& v) {
  v("gradient_min", c.gradient_min, "grey levels",
    "smallest horizontal gradient above the noise of a textured pixel", range(0.0F, 255.0F),
    when("pipeline.method", "region_tree"));
}

/// The textured disparities, NaN elsewhere: valid ones at pixels whose horizontal gradient exceeds the noise
/// and is not that of a nearly horizontal edge (|gx| > |gy|/2), with at least three agreeing disparities of
/// such pixels in the 5×5 neighbourhood. Other disparities are propagated from the surroundings by the
/// matcher, which is how near objects grow beyond their outlines. (beyond the paper)
Image<float> find_evidence(const LeftImage& left, const DisparityMap& disparity, const EvidenceConfig& config,
                           const Exec& exec);

}  // namespace cairn
