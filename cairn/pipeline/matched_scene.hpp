// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/observed.hpp>
#include <cairn/pipeline/segment.hpp>

namespace cairn {

/// What a frame is made of: a pair or, without a right image, a left image and its disparities from
/// elsewhere.
struct Given {
  View<const Gray> left;
  View<const Rgb> left_rgb;
  View<const Gray> right;
  DisparityMap disparity;
};

/// Disparities that every check has passed, what they were judged by, and the ground.
struct MatchedScene {
  Matches matches;           // empty where the disparities come from elsewhere
  float noise_sigma = 0;     // grey levels
  Image<float> evidence_px;  // fusion.method=hierarchy: what texture vouches for, see find_evidence()
  SceneDisparity found;      // its confidence is empty
};

/// Both methods begin with this. Takes the disparities of `given` where there is nothing to match. Private to
/// the library.
MatchedScene match_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec, Observed& stage);

}  // namespace cairn
