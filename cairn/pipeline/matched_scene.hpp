// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/observed.hpp>
#include <cairn/pipeline/segment.hpp>

namespace cairn {

/// The input of a frame: a pair or, without a right image, a left image and external disparities.
struct Given {
  View<const Gray> left;
  View<const Rgb> left_rgb;
  View<const Gray> right;
  DisparityMap disparity;
};

/// Checked disparities, the data for the checks, and the ground.
struct MatchedScene {
  Matches matches;            // empty for external disparities
  Image<Gray> aligned_right;  // correct_epipolar(); empty where nothing was corrected
  float noise_sigma = 0;      // grey levels
  Image<float> evidence_px;   // fusion.method=hierarchy: textured disparities, see find_evidence()
  SceneDisparity found;       // its confidence is empty
  [[nodiscard]] View<const Gray> right_of(const Given& given) const {
    return aligned_right.empty() ? given.right : View<const Gray>(aligned_right);
  }
};

/// The common first half of both methods. Moves the disparities out of `given` if there is nothing to match.
/// Private to the library.
MatchedScene match_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec, Observed& stage);

}  // namespace cairn
