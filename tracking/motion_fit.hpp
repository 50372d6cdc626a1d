// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <optional>
#include <vector>

#include "odometry.hpp"

namespace cairn {

/// A corner of a keyframe that was followed to the present image.
struct FollowedCorner {
  Point3 in_key_m;
  double x_px = 0;  // where it is now
  double y_px = 0;
  double disparity_px = 0;  // now; NaN where it has none
};

/// Where a motion is already known from elsewhere: ξ of now_from_key · expected⁻¹ has this information, 0 of
/// what is not known.
struct MotionTerm {
  Pose now_from_key;
  Covariance6 information{};
};

struct MotionFit {
  Pose now_from_key;
  Covariance6 covariance{};  // of ξ, true motion = exp(ξ) · now_from_key: in the frame of the camera now
  MotionRefusal refusal = MotionRefusal::none;  // none, few_points, few_inliers or degenerate
  std::vector<std::uint8_t> is_inlier;          // of each corner
  int inliers = 0;
  double chi2_per_dof = 0;
};

/// The motion that most of the corners agree with. Hypotheses: `start`, then AP3P (Ke and Roumeliotis, CVPR
/// 2017) in RANSAC with a fixed seed; refined over (x, y, disparity) by Gauss-Newton with Huber's weights,
/// where each corner's depth in the keyframe is uncertain, too.
MotionFit fit_motion(const std::vector<FollowedCorner>& corners, const StereoRig& rig, const Pose& start,
                     const std::optional<MotionTerm>& term, const OdometryConfig& config);

}  // namespace cairn
