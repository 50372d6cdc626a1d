// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <limits>
#include <vector>

#include <cairn/sequence/pose.hpp>

namespace cairn {

/// The pose of the camera at one time of a run.
struct TimedPose {
  Stamp stamp;
  Pose map_from_camera;
};

/// The comparison of two trajectories.
struct TrajectoryErrorConfig {
  double max_skew_s = 0.01;  // largest time difference to the nearest true pose
  int start_step = 10;       // every n-th frame starts a sub-path of t_rel and r_rel, as in the KITTI devkit
};

/// The error of an estimated trajectory. Measures that need longer trajectories are NaN.
struct TrajectoryError {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  int compared = 0;   // poses with a true pose at their stamp
  int missing = 0;    // true poses between the first and last compared one without an estimate
  double path_m = 0;  // length of the true path through the compared poses

  double ate_rmse_m = kUnknown;  // of positions, after optimal rigid alignment
  double ate_max_m = kUnknown;

  double rpe_frame_m = kUnknown;  // RMSE of the motion from each compared pose to the next
  double rpe_frame_rad = kUnknown;
  double rpe_metre_m = kUnknown;  // the same over 1 m of true path
  double rpe_metre_rad = kUnknown;

  // Means over sub-paths of 100, 200 … 800 m; of 1, 2 … 8 m where the path is shorter than 100 m.
  int sub_paths = 0;
  double t_rel = kUnknown;            // m per m
  double r_rel_rad_per_m = kUnknown;  // KITTI's degrees per 100 m are 18000/π times this

  double end_error_m = kUnknown;  // of the last pose, with the first poses aligned
  double end_error_rad = kUnknown;
  double end_drift = kUnknown;  // end_error_m ÷ path_m; NaN if the path is shorter than 0.1 m
};

/// ATE after Umeyama alignment without scale (PAMI 13(4), 1991), RPE (Sturm et al., IROS 2012), t_rel and
/// r_rel (Geiger et al., CVPR 2012). Both lists are sorted by stamp; the map frames may differ.
TrajectoryError trajectory_error(const std::vector<TimedPose>& estimated, const std::vector<TimedPose>& truth,
                                 const TrajectoryErrorConfig& config = {});

/// The normalised squared error ξᵀP⁻¹ξ of a motion, with 6 degrees of freedom: the median is about 5.3 for a
/// correct covariance. ξ is translation, then rotation vector of now_from_before · true⁻¹, hence in the
/// present camera frame, like the covariance; NaN if the covariance is not positive definite.
double normalised_error(const Pose& now_from_before, const Covariance6& covariance,
                        const Pose& true_now_from_before);

}  // namespace cairn
