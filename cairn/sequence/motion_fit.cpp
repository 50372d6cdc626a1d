// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/motion_fit.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cairn/core/random.hpp>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include <cairn/sequence/twist.hpp>

namespace cairn {
namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix36 = Eigen::Matrix<double, 3, 6>;
using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double kNearest_m = 0.01;  // nearer points are behind the lens
constexpr double kHuber = 1.5;       // standard deviations
constexpr double kOutlier = 6.0;     // standard deviations
constexpr double kMaxSigma_m = 0.1;  // of the translation; a less certain motion is refused
constexpr double kMaxSigma_rad = 0.1;

double squared_error_px(const FollowedCorner& corner, const Pose& pose, const StereoRig& rig) {
  const Point3 p = pose(corner.in_key_m);
  if (p.z < kNearest_m) return std::numeric_limits<double>::infinity();
  const double dx = rig.focal_px * p.x / p.z + rig.cx_px - corner.x_px;
  const double dy = rig.focal_px * p.y / p.z + rig.cy_px - corner.y_px;
  return dx * dx + dy * dy;
}

int count_inliers(const std::vector<FollowedCorner>& corners, const Pose& pose, const StereoRig& rig,
                  double threshold_px) {
  return static_cast<int>(std::count_if(corners.begin(), corners.end(), [&](const FollowedCorner& corner) {
    return squared_error_px(corner, pose, rig) <= threshold_px * threshold_px;
  }));
}

Pose pose_of_vectors(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  Pose pose = rotation_about(
      {rotation_vector.at<double>(0), rotation_vector.at<double>(1), rotation_vector.at<double>(2)});
  pose.translation_m = {translation.at<double>(0), translation.at<double>(1), translation.at<double>(2)};
  return pose;
}

/// Of the solutions for three corners, the one with the least error for a fourth; nullopt if there is none.
std::optional<Pose> motion_of(const std::array<const FollowedCorner*, 4>& sample, const StereoRig& rig) {
  std::array<cv::Point3d, 3> points;
  std::array<cv::Point2d, 3> rays;
  for (std::size_t k = 0; k < 3; ++k) {
    const FollowedCorner& c = *sample[k];
    points[k] = {c.in_key_m.x, c.in_key_m.y, c.in_key_m.z};
    rays[k] = {(c.x_px - rig.cx_px) / rig.focal_px, (c.y_px - rig.cy_px) / rig.focal_px};
  }
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  cv::solveP3P(cv::Mat(3, 1, CV_64FC3, points.data()), cv::Mat(3, 1, CV_64FC2, rays.data()),
               cv::Matx33d::eye(), cv::noArray(), rotations, translations, cv::SOLVEPNP_AP3P);
  std::optional<Pose> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < rotations.size(); ++k) {
    const Pose pose = pose_of_vectors(rotations[k], translations[k]);
    const double error = squared_error_px(*sample[3], pose, rig);
    if (!(error < least)) continue;  // also skips NaN
    least = error;
    best = pose;
  }
  return best;
}

/// The number of RANSAC rounds after which one sample probably contained only inliers. At least 30, since the
/// expected motion may have many inliers and still not be the best.
int rounds_wanted(int inliers, std::size_t n, const OdometryConfig& config) {
  const double clean = std::pow(static_cast<double>(inliers) / static_cast<double>(n), 4.0);
  constexpr int kMin = 30;
  if (clean >= 1) return kMin;
  const double rounds = std::ceil(std::log(1.0 - double(config.confidence)) / std::log1p(-clean));
  return std::max(kMin, rounds < config.iterations ? static_cast<int>(rounds) : config.iterations);
}

/// The motion with the most inliers; the first of equals.
Pose best_hypothesis(const std::vector<FollowedCorner>& corners, const StereoRig& rig, const Pose& start,
                     const OdometryConfig& config) {
  const std::size_t n = corners.size();
  Pose best = start;
  int most = count_inliers(corners, start, rig, config.reprojection_error);
  Random random;
  for (int round = 0; round < rounds_wanted(most, n, config); ++round) {
    std::array<std::size_t, 4> picked{};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto chosen = picked.begin() + static_cast<std::ptrdiff_t>(k);
      do {
        picked[k] = random.below(n);
      } while (std::find(picked.begin(), chosen, picked[k]) != chosen);
    }
    const auto pose =
        motion_of({&corners[picked[0]], &corners[picked[1]], &corners[picked[2]], &corners[picked[3]]}, rig);
    if (!pose) continue;
    const int inliers = count_inliers(corners, *pose, rig, config.reprojection_error);
    if (inliers <= most) continue;
    most = inliers;
    best = *pose;
  }
  return best;
}

/// exp(ξ) · pose, re-orthonormalised.
Pose moved_by(const Vector6& xi, const Pose& pose) {
  Pose step = rotation_about({xi(3), xi(4), xi(5)});
  step.translation_m = {xi(0), xi(1), xi(2)};  // first-order coupling: ξ vanishes as the fit converges
  const Pose moved = step * pose;
  return pose_of(moved.translation_m, quaternion(moved));
}

/// The residual of a corner, linearised at a pose.
struct Linear {
  Matrix36 jacobian;
  Vector3 residual;
  Matrix3 information;
  double mahalanobis = 0;  // not squared
  int dof = 2;
  bool usable = false;
};

Linear linearise(const FollowedCorner& corner, const Pose& pose, const StereoRig& rig,
                 const OdometryConfig& config) {
  Linear out;
  const Point3 now = pose(corner.in_key_m);
  if (now.z < kNearest_m) return out;
  const double f = rig.focal_px;
  const double fb = f * double(rig.baseline_m);
  const double iz = 1.0 / now.z;
  const bool has_disparity = !std::isnan(corner.disparity_px);
  Matrix3 projection;  // d(x, y, d)/d(point)
  projection << f * iz, 0, -f * now.x * iz * iz, 0, f * iz, -f * now.y * iz * iz, 0, 0, -fb * iz * iz;
  out.residual << corner.x_px - (f * now.x * iz + rig.cx_px), corner.y_px - (f * now.y * iz + rig.cy_px),
      has_disparity ? corner.disparity_px - (fb * iz - rig.doffs_px) : 0.0;

  const Vector3 point(now.x, now.y, now.z);
  const Point3& key = corner.in_key_m;
  const bool far =
      config.max_depth_baselines > 0 && key.z > double(config.max_depth_baselines) * double(rig.baseline_m);
  out.jacobian.leftCols<3>() = far ? Matrix3::Zero().eval() : projection;
  out.jacobian.rightCols<3>() = -projection * skew(point);

  const Point3 ray = pose.rotated({key.x / key.z, key.y / key.z, 1.0});
  const double sigma_z = key.z * key.z * double(config.sigma_disparity) / fb;
  const Vector3 along = projection * Vector3(ray.x, ray.y, ray.z) * sigma_z;
  const double pixel = double(config.sigma_pixel) * double(config.sigma_pixel);
  const double disparity = double(config.sigma_disparity) * double(config.sigma_disparity);
  Matrix3 covariance = along * along.transpose();
  covariance.diagonal() += Vector3(pixel, pixel, disparity);
  if (has_disparity) {
    out.information = covariance.inverse();
    out.dof = 3;
  } else {
    out.information.setZero();
    out.information.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>().inverse();
  }
  out.mahalanobis = std::sqrt(std::max(0.0, out.residual.dot(out.information * out.residual)));
  out.usable = std::isfinite(out.mahalanobis);
  return out;
}

struct Normal {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double chi2 = 0;
  int dof = -6;
};

Normal normal_equations(const std::vector<FollowedCorner>& corners,
                        const std::vector<std::uint8_t>& is_inlier, const Pose& pose, const StereoRig& rig,
                        const std::optional<MotionTerm>& term, const OdometryConfig& config) {
  Normal sum;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (is_inlier[k] == 0) continue;
    const Linear one = linearise(corners[k], pose, rig, config);
    if (!one.usable || one.mahalanobis > kOutlier) continue;
    const double weight = one.mahalanobis <= kHuber ? 1.0 : kHuber / one.mahalanobis;
    const Eigen::Matrix<double, 6, 3> weighted = weight * one.jacobian.transpose() * one.information;
    sum.information += weighted * one.jacobian;
    sum.gradient += weighted * one.residual;
    sum.chi2 += weight * one.mahalanobis * one.mahalanobis;
    sum.dof += one.dof;
  }
  if (term) {
    const Matrix6 prior = Eigen::Map<const RowMajor6>(term->information.data());
    sum.information += prior;
    sum.gradient -= prior * difference(pose, term->now_from_key);
  }
  return sum;
}

/// Marks the corners consistent with the pose and returns their number.
int mark_inliers(const std::vector<FollowedCorner>& corners, const Pose& pose, const StereoRig& rig,
                 const OdometryConfig& config, std::vector<std::uint8_t>& is_inlier) {
  const double limit = double(config.reprojection_error) * double(config.reprojection_error);
  int count = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    is_inlier[k] = squared_error_px(corners[k], pose, rig) <= limit ? 1 : 0;
    count += is_inlier[k];
  }
  return count;
}

/// Errors common to all corners do not average out: an error of the disparities scales the motion, one of the
/// positions rotates it.
void state_covariance(MotionFit& fit, RowMajor6 covariance, const StereoRig& rig) {
  constexpr double kCommonScale = 0.01;
  constexpr double kCommon_px = 0.1;
  const double common_m = kCommonScale * length(fit.now_from_key.translation_m);
  const double common_rad = kCommon_px / double(rig.focal_px);
  covariance.diagonal().head<3>().array() += common_m * common_m;
  covariance.diagonal().tail<3>().array() += common_rad * common_rad;
  Eigen::Map<RowMajor6>(fit.covariance.data()) = covariance;
}

bool is_certain(const MotionFit& fit) {
  const Eigen::Map<const RowMajor6> covariance(fit.covariance.data());
  const double sigma_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  const double sigma_rad = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  return sigma_m <= kMaxSigma_m && sigma_rad <= kMaxSigma_rad;
}

}  // namespace

MotionFit fit_motion(const std::vector<FollowedCorner>& corners, const StereoRig& rig, const Pose& start,
                     const std::optional<MotionTerm>& term, const OdometryConfig& config) {
  MotionFit fit;
  fit.now_from_key = start;
  fit.is_inlier.assign(corners.size(), 0);
  const int least = std::max(4, config.min_inliers);
  if (static_cast<int>(corners.size()) < least) {
    fit.refusal = MotionRefusal::few_points;
    return fit;
  }
  Pose pose = best_hypothesis(corners, rig, start, config);
  fit.inliers = mark_inliers(corners, pose, rig, config, fit.is_inlier);
  if (fit.inliers < least) {
    fit.refusal = MotionRefusal::few_inliers;
    return fit;
  }
  // Later rounds add corners that the three-point hypothesis missed narrowly.
  constexpr int kRounds = 3;
  constexpr int kSteps = 8;
  Normal normal;
  for (int round = 0; round < kRounds; ++round) {
    for (int step = 0; step < kSteps; ++step) {
      normal = normal_equations(corners, fit.is_inlier, pose, rig, term, config);
      const Eigen::LDLT<Matrix6> factors(normal.information);
      const Vector6 xi = factors.solve(normal.gradient);
      if (factors.info() != Eigen::Success || !factors.isPositive() || !xi.allFinite() || xi.norm() > 10) {
        fit.refusal = MotionRefusal::degenerate;
        return fit;
      }
      pose = moved_by(xi, pose);
      constexpr double kConverged = 1e-7;
      if (xi.norm() < kConverged) break;
    }
    fit.inliers = mark_inliers(corners, pose, rig, config, fit.is_inlier);
    if (fit.inliers < least) {
      fit.refusal = MotionRefusal::few_inliers;
      return fit;
    }
  }
  normal = normal_equations(corners, fit.is_inlier, pose, rig, term, config);
  fit.now_from_key = pose;
  fit.chi2_per_dof = normal.dof > 0 ? normal.chi2 / normal.dof : 0.0;
  const Eigen::LLT<Matrix6> factors(normal.information);
  const bool is_regular = factors.info() == Eigen::Success;
  if (is_regular) {
    const RowMajor6 covariance = std::max(1.0, fit.chi2_per_dof) * factors.solve(Matrix6::Identity()).eval();
    state_covariance(fit, covariance, rig);
  }
  if (!is_regular || !is_certain(fit)) fit.refusal = MotionRefusal::degenerate;
  return fit;
}

}  // namespace cairn
