// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <limits>
#include <vector>

#include "pose.hpp"

namespace cairn {

/// Where the camera was at one moment of a run.
struct TimedPose {
  Stamp stamp;
  Pose map_from_camera;
};

/// How two trajectories are compared.
struct TrajectoryErrorConfig {
  double max_skew_s = 0.01;  // a pose is compared with the true one nearest in time, at most this far off
  int start_step = 10;       // every n-th frame begins the sub-paths of t_rel and r_rel, as in KITTI's kit
};

/// How far an estimated trajectory is off. A measure that the trajectories are too short for is NaN.
struct TrajectoryError {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  int compared = 0;   // poses with a true one at their stamp
  int missing = 0;    // true poses between the first and last compared one without an estimate
  double path_m = 0;  // length of the true path through the compared poses

  double ate_rmse_m = kUnknown;  // of positions, after the rigid alignment that makes it least
  double ate_max_m = kUnknown;

  double rpe_frame_m = kUnknown;  // RMSE of the motion from each compared pose to the next
  double rpe_frame_rad = kUnknown;
  double rpe_metre_m = kUnknown;  // the same over 1 m of true path
  double rpe_metre_rad = kUnknown;

  // Means over sub-paths of 100, 200 … 800 m; of 1, 2 … 8 m where the path is shorter than 100 m.
  int sub_paths = 0;
  double t_rel = kUnknown;            // m per m
  double r_rel_rad_per_m = kUnknown;  // KITTI's degrees per 100 m are 18000/π times this

  double end_error_m = kUnknown;  // of the last pose, both trajectories laid together at their first
  double end_error_rad = kUnknown;
  double end_drift = kUnknown;  // end_error_m ÷ path_m; NaN where the camera moved by less than 0.1 m
};

/// ATE after Umeyama's alignment without scale (PAMI 13(4), 1991), RPE (Sturm et al., IROS 2012), t_rel and
/// r_rel (Geiger et al., CVPR 2012). Both lists are sorted by stamp; the frames of the two maps may differ.
TrajectoryError trajectory_error(const std::vector<TimedPose>& estimated, const std::vector<TimedPose>& truth,
                                 const TrajectoryErrorConfig& config = {});

/// The normalised squared error ξᵀP⁻¹ξ of a motion, with 6 degrees of freedom: about 5.3 in the median where
/// the covariance is right. ξ is translation, then rotation vector of now_from_before · true⁻¹, hence in the
/// frame of the camera now, as the covariance is; NaN where that is not positive definite.
double normalised_error(const Pose& now_from_before, const Covariance6& covariance,
                        const Pose& true_now_from_before);

}  // namespace cairn
