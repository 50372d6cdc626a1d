// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/output/trajectory_files.hpp>
#include <cairn/sequence/trajectory_error.hpp>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <support/collection.hpp>

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = std::numbers::pi / 180;

Stamp frame(int k) {
  return {std::int64_t{100'000'000} * k};
}

/// Straight along x, `step_m` per frame, with constant attitude.
std::vector<TimedPose> straight(int count, double step_m) {
  std::vector<TimedPose> poses;
  for (int k = 0; k < count; ++k)
    poses.push_back({frame(k), Pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {step_m * k, 0, 0}}});
  return poses;
}

std::vector<TimedPose> circle(int count) {
  std::vector<TimedPose> poses;
  for (int k = 0; k < count; ++k) {
    const double angle = 0.05 * k;
    Pose pose = rotation_about({0, 0, angle});
    pose.translation_m = {2 * std::sin(angle), 2 - 2 * std::cos(angle), 0.1 * std::sin(3 * angle)};
    poses.push_back({frame(k), pose});
  }
  return poses;
}

TEST(TrajectoryError, IsZeroForAnotherMapOrigin) {
  const std::vector<TimedPose> truth = circle(60);
  Pose elsewhere = rotation_about({0.4, 0.2, -2});
  elsewhere.translation_m = {10, -5, 2};
  std::vector<TimedPose> ours = truth;
  for (TimedPose& pose : ours) pose.map_from_camera = elsewhere * pose.map_from_camera;
  const TrajectoryError e = trajectory_error(ours, truth);
  EXPECT_EQ(e.compared, 60);
  EXPECT_NEAR(e.ate_rmse_m, 0, 1e-9);
  EXPECT_NEAR(e.rpe_frame_m, 0, 1e-9);
  EXPECT_NEAR(e.rpe_metre_rad, 0, 1e-7);
  EXPECT_NEAR(e.t_rel, 0, 1e-9);
  EXPECT_NEAR(e.end_drift, 0, 1e-9);
  EXPECT_GT(e.sub_paths, 0);
}

TEST(TrajectoryError, OfAPathThatIsTooLongByAHundredth) {
  const TrajectoryError e = trajectory_error(straight(101, 0.101), straight(101, 0.1));
  EXPECT_NEAR(e.path_m, 10, 1e-9);
  EXPECT_NEAR(e.end_error_m, 0.1, 1e-9);
  EXPECT_NEAR(e.end_drift, 0.01, 1e-9);
  EXPECT_NEAR(e.rpe_frame_m, 0.001, 1e-9);
  EXPECT_NEAR(e.t_rel, 0.01, 0.0012) << "a sub-path ends with the first pose beyond its length";
  EXPECT_NEAR(e.r_rel_rad_per_m, 0, 1e-12);
  // Errors evenly distributed over −5 … 5 cm: their RMS is √((n²−1)/12) steps of 1 mm.
  EXPECT_NEAR(e.ate_rmse_m, 0.001 * std::sqrt((101.0 * 101.0 - 1) / 12), 1e-9);
  EXPECT_NEAR(e.ate_max_m, 0.05, 1e-9);
}

TEST(TrajectoryError, OfAHeadingThatDrifts) {
  std::vector<TimedPose> ours = straight(41, 0.1);
  for (std::size_t k = 0; k < ours.size(); ++k) {
    ours[k].map_from_camera.rotation =
        rotation_about({0, 0, 0.1 * kDegrees * static_cast<double>(k)}).rotation;
  }
  const TrajectoryError e = trajectory_error(ours, straight(41, 0.1));
  EXPECT_NEAR(e.rpe_frame_rad / kDegrees, 0.1, 1e-6);
  EXPECT_NEAR(e.end_error_rad / kDegrees, 4, 1e-6);
  EXPECT_NEAR(e.r_rel_rad_per_m / kDegrees, 1, 0.11);
}

TEST(TrajectoryError, IsUnknownForTooShortTrajectories) {
  const TrajectoryError none = trajectory_error({}, straight(5, 0.1));
  EXPECT_EQ(none.compared, 0);
  EXPECT_TRUE(std::isnan(none.ate_rmse_m));
  EXPECT_EQ(trajectory_error(straight(5, 0.1), {}).compared, 0);
  const TrajectoryError one = trajectory_error(straight(1, 0.1), straight(1, 0.1));
  EXPECT_EQ(one.compared, 1);
  EXPECT_TRUE(std::isnan(one.rpe_frame_m));
  EXPECT_TRUE(std::isnan(one.end_drift));
  const TrajectoryError still = trajectory_error(straight(10, 0), straight(10, 0));
  EXPECT_TRUE(std::isnan(still.end_drift)) << "no path, no share of it";
  EXPECT_NEAR(still.end_error_m, 0, 1e-12);
  EXPECT_TRUE(std::isnan(still.t_rel));
}

TEST(TrajectoryError, ComparesPosesNearInTime) {
  std::vector<TimedPose> ours = straight(10, 0.1);
  for (TimedPose& pose : ours) pose.stamp.ns += 4'000'000;
  ours.erase(ours.begin() + 3, ours.begin() + 5);
  const TrajectoryError e = trajectory_error(ours, straight(10, 0.1));
  EXPECT_EQ(e.compared, 8);
  EXPECT_EQ(e.missing, 2);
  for (TimedPose& pose : ours) pose.stamp.ns += 16'000'000;
  EXPECT_EQ(trajectory_error(ours, straight(10, 0.1)).compared, 0);
  EXPECT_EQ(trajectory_error(ours, straight(10, 0.1), {.max_skew_s = 0.03, .start_step = 10}).compared, 8);
}

TEST(NormalisedError, CountsStandardDeviations) {
  Covariance6 covariance{};
  for (std::size_t k = 0; k < 3; ++k) {
    covariance[7 * k] = 0.01 * 0.01;
    covariance[7 * (k + 3)] = 0.02 * 0.02;
  }
  Pose off;
  off.translation_m = {0.02, 0, 0};
  EXPECT_NEAR(normalised_error(off, covariance, {}), 4, 1e-9);
  EXPECT_NEAR(normalised_error(rotation_about({0, 0.06, 0}), covariance, {}), 9, 1e-9);
  EXPECT_TRUE(std::isnan(normalised_error(off, {}, {}))) << "no covariance at all";
}

TEST(TrajectoryError, EqualsKittisForTwoKnownSystems) {
  const fs::path folder = collection() / "real/sequences/anchors/kitti00";
  if (!fs::exists(folder)) GTEST_SKIP() << "no collection of sequences here (CAIRN_DATA)";
  const output::Trajectory truth = output::load_trajectory(folder / "KITTI_00_gt.txt");
  EXPECT_FALSE(truth.has_stamps);
  const TrajectoryError orb =
      trajectory_error(output::load_trajectory(folder / "KITTI_00_ORB.txt").poses, truth.poses);
  EXPECT_EQ(orb.compared, 4541);
  EXPECT_NEAR(100 * orb.t_rel, 0.70, 0.005);
  EXPECT_NEAR(100 * orb.r_rel_rad_per_m / kDegrees, 0.25, 0.005);
  const TrajectoryError sptam =
      trajectory_error(output::load_trajectory(folder / "KITTI_00_SPTAM.txt").poses, truth.poses);
  EXPECT_NEAR(100 * sptam.t_rel, 1.49, 0.005);
  EXPECT_NEAR(100 * sptam.r_rel_rad_per_m / kDegrees, 0.56, 0.005);
}

}  // namespace
}  // namespace cairn
