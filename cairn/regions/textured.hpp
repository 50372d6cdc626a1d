// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/left_image.hpp>
#include <cairn/stereo/disparity_map.hpp>

namespace cairn {

/// Constants of the method, not options.
struct TexturedConfig {
  // A textured pixel has a horizontal gradient of at least this times the noise's σ …
  float noise_factor = 1.0F;
  float gradient_min = 0.65F;  // … plus this, in grey levels
  float agreement = 2.5F;      // ‰ of the width; largest difference of neighbouring textured disparities
};

/// The textured disparities, NaN elsewhere: valid ones at pixels whose horizontal gradient exceeds the noise
/// and is not that of a nearly horizontal edge (|gx| > |gy|/2), with at least three agreeing disparities of
/// such pixels in the 5×5 neighbourhood. Other disparities are propagated from the surroundings by the
/// matcher, which is how near objects grow beyond their outlines. (beyond the paper)
Image<float> select_textured(const LeftImage& left, const DisparityMap& disparity,
                             const TexturedConfig& config, const Exec& exec);

}  // namespace cairn
