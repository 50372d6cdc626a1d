// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/trajectory_error.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <cairn/sequence/twist.hpp>

namespace cairn {
namespace {

struct Pair {
  Pose estimated;
  Pose truth;
};

/// Index of the pose nearest in time; `poses` is not empty.
std::size_t nearest(const std::vector<TimedPose>& poses, Stamp stamp) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), stamp,
                                      [](const TimedPose& pose, Stamp s) { return pose.stamp < s; });
  if (after == poses.end()) return poses.size() - 1;
  if (after == poses.begin()) return 0;
  const auto before = after - 1;
  const bool take_before = seconds_between(before->stamp, stamp) <= seconds_between(stamp, after->stamp);
  return static_cast<std::size_t>((take_before ? before : after) - poses.begin());
}

struct PosePairs {
  std::vector<Pair> pairs;
  int missing = 0;
};

PosePairs pair_up(const std::vector<TimedPose>& estimated, const std::vector<TimedPose>& truth,
                  double max_skew_s) {
  PosePairs all;
  if (truth.empty()) return all;
  std::size_t first = 0;
  std::size_t last = 0;
  for (const TimedPose& pose : estimated) {
    const std::size_t index = nearest(truth, pose.stamp);
    if (std::abs(seconds_between(pose.stamp, truth[index].stamp)) > max_skew_s) continue;
    if (!all.pairs.empty() && index <= last) continue;  // each true pose is used once
    if (all.pairs.empty()) first = index;
    last = index;
    all.pairs.push_back({pose.map_from_camera, truth[index].map_from_camera});
  }
  if (!all.pairs.empty())
    all.missing = static_cast<int>(last - first + 1) - static_cast<int>(all.pairs.size());
  return all;
}

/// Length of the true path up to each pose.
std::vector<double> distances(const std::vector<Pair>& pairs) {
  std::vector<double> sums{0.0};
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    sums.push_back(sums.back() + length(pairs[k].truth.translation_m - pairs[k - 1].truth.translation_m));
  }
  return sums;
}

/// The estimated motion between two poses, relative to the true one.
Pose motion_error(const Pair& from, const Pair& to) {
  const Pose estimated = inverse(from.estimated) * to.estimated;
  const Pose truth = inverse(from.truth) * to.truth;
  return inverse(estimated) * truth;
}

/// The first pose after `first` that is farther along the path than `distance_m`, or the number of poses.
std::size_t pose_beyond(const std::vector<double>& along_m, std::size_t first, double distance_m) {
  const auto found = std::upper_bound(along_m.begin() + static_cast<std::ptrdiff_t>(first), along_m.end(),
                                      along_m[first] + distance_m);
  return static_cast<std::size_t>(found - along_m.begin());
}

void absolute_errors(const std::vector<Pair>& pairs, TrajectoryError& error) {
  const auto n = static_cast<Eigen::Index>(pairs.size());
  Eigen::Matrix3Xd ours(3, n);
  Eigen::Matrix3Xd theirs(3, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Point3 e = pairs[static_cast<std::size_t>(k)].estimated.translation_m;
    const Point3 t = pairs[static_cast<std::size_t>(k)].truth.translation_m;
    ours.col(k) << e.x, e.y, e.z;
    theirs.col(k) << t.x, t.y, t.z;
  }
  const Eigen::Matrix4d moved = Eigen::umeyama(ours, theirs, false);
  const Eigen::Matrix3Xd off =
      ((moved.topLeftCorner<3, 3>() * ours).colwise() + moved.topRightCorner<3, 1>().col(0)) - theirs;
  double squares = 0;
  double most = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    squares += off.col(k).squaredNorm();
    most = std::max(most, off.col(k).norm());
  }
  error.ate_rmse_m = std::sqrt(squares / static_cast<double>(n));
  error.ate_max_m = most;
}

void relative_errors(const std::vector<Pair>& pairs, const std::vector<double>& along_m,
                     TrajectoryError& error) {
  struct Squares {
    double metres = 0;
    double radians = 0;
    int count = 0;
    void add(const Pose& off) {
      metres += dot(off.translation_m, off.translation_m);
      radians += angle_of(off) * angle_of(off);
      ++count;
    }
  };
  Squares frame;
  Squares metre;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (k + 1 < pairs.size()) frame.add(motion_error(pairs[k], pairs[k + 1]));
    const std::size_t beyond = pose_beyond(along_m, k, 1.0);
    if (beyond < pairs.size()) metre.add(motion_error(pairs[k], pairs[beyond]));
  }
  if (frame.count > 0) {
    error.rpe_frame_m = std::sqrt(frame.metres / frame.count);
    error.rpe_frame_rad = std::sqrt(frame.radians / frame.count);
  }
  if (metre.count > 0) {
    error.rpe_metre_m = std::sqrt(metre.metres / metre.count);
    error.rpe_metre_rad = std::sqrt(metre.radians / metre.count);
  }
}

void errors_of_sub_paths(const std::vector<Pair>& pairs, const std::vector<double>& along_m, int start_step,
                         TrajectoryError& error) {
  constexpr double kStreet_m = 100;
  const double unit_m = along_m.back() >= kStreet_m ? kStreet_m : 1.0;
  const auto step = static_cast<std::size_t>(std::max(1, start_step));
  double metres = 0;
  double radians = 0;
  for (std::size_t first = 0; first < pairs.size(); first += step) {
    for (int units = 1; units <= 8; ++units) {
      const double distance_m = units * unit_m;
      const std::size_t last = pose_beyond(along_m, first, distance_m);
      if (last >= pairs.size()) break;
      const Pose off = motion_error(pairs[first], pairs[last]);
      metres += length(off.translation_m) / distance_m;
      radians += angle_of(off) / distance_m;
      ++error.sub_paths;
    }
  }
  if (error.sub_paths == 0) return;
  error.t_rel = metres / error.sub_paths;
  error.r_rel_rad_per_m = radians / error.sub_paths;
}

}  // namespace

TrajectoryError trajectory_error(const std::vector<TimedPose>& estimated, const std::vector<TimedPose>& truth,
                                 const TrajectoryErrorConfig& config) {
  const PosePairs compared = pair_up(estimated, truth, config.max_skew_s);
  const std::vector<Pair>& pairs = compared.pairs;
  TrajectoryError error;
  error.compared = static_cast<int>(pairs.size());
  error.missing = compared.missing;
  if (pairs.empty()) return error;
  const std::vector<double> along_m = distances(pairs);
  error.path_m = along_m.back();
  absolute_errors(pairs, error);
  relative_errors(pairs, along_m, error);
  errors_of_sub_paths(pairs, along_m, config.start_step, error);
  const Pose off = motion_error(pairs.front(), pairs.back());
  error.end_error_m = length(off.translation_m);
  error.end_error_rad = angle_of(off);
  constexpr double kMoved_m = 0.1;
  if (error.path_m >= kMoved_m) error.end_drift = error.end_error_m / error.path_m;
  return error;
}

double normalised_error(const Pose& now_from_before, const Covariance6& covariance,
                        const Pose& true_now_from_before) {
  const Vector6 xi = difference(now_from_before, true_now_from_before);
  const Eigen::Matrix<double, 6, 6> p =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance.data());
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factors(p);
  if (factors.info() != Eigen::Success) return TrajectoryError::kUnknown;
  return xi.dot(factors.solve(xi));
}

}  // namespace cairn
