// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <optional>
#include <vector>

#include <cairn/sequence/odometry.hpp>

namespace cairn {

/// A corner of a keyframe tracked into the present image.
struct FollowedCorner {
  Point3 in_key_m;
  double x_px = 0;  // present position
  double y_px = 0;
  double disparity_px = 0;  // present disparity; NaN = none
};

/// A motion known from another sensor: the information of ξ of now_from_key · expected⁻¹, 0 for unknown
/// components.
struct MotionTerm {
  Pose now_from_key;
  Covariance6 information{};
};

struct MotionFit {
  Pose now_from_key;
  Covariance6 covariance{};  // of ξ, true motion = exp(ξ) · now_from_key: in the present camera frame
  MotionRefusal refusal = MotionRefusal::none;  // none, few_points, few_inliers or degenerate
  std::vector<std::uint8_t> is_inlier;          // of each corner
  int inliers = 0;
  double chi2_per_dof = 0;
};

/// The motion with the most inlier corners. Hypotheses: `start`, then AP3P (Ke and Roumeliotis, CVPR 2017) in
/// RANSAC with a fixed seed; refined over (x, y, disparity) by Gauss-Newton with Huber weights, taking the
/// depth uncertainty of each corner in the keyframe into account.
MotionFit fit_motion(const std::vector<FollowedCorner>& corners, const StereoRig& rig, const Pose& start,
                     const std::optional<MotionTerm>& term, const OdometryConfig& config);

}  // namespace cairn
