// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Odometry on sequences with known truth. Prints the rows of the table in docs/stages/odometry.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/input/priors.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/sequence/first_pose.hpp>
#include <cairn/sequence/odometry.hpp>
#include <cairn/sequence/trajectory_error.hpp>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <support/collection.hpp>

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = 180 / std::numbers::pi;

struct Drive {
  std::string folder;
  std::string truth;       // in the folder; empty: the folder itself
  bool by_wheels = false;  // odometry.csv
  int black = 0;           // every n-th frame is black
};

struct Measurement {
  TrajectoryError error;
  double nees = 0;          // median, of the motion since the keyframe
  double milliseconds = 0;  // of processor time, median
  int refused = 0;
};

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Measurement measure(const Drive& drive) {
  const fs::path folder = collection() / drive.folder;
  const auto source = input::open_sequence(folder.string(), {});
  output::Trajectory truth = output::load_trajectory(folder / drive.truth);
  Config segmentation;
  segmentation.match.num_disparities = source->disparities().value_or(segmentation.match.num_disparities);
  const std::unique_ptr<input::MotionPriors> wheels =
      drive.by_wheels ? input::load_odometry(folder / "odometry.csv", folder) : nullptr;

  Measurement all;
  std::vector<TimedPose> ours;
  std::vector<double> nees;
  std::vector<double> times;
  OdometryState state;
  Pose from_level;
  std::size_t key = 0;
  const Exec exec;
  for (std::size_t k = 0; const auto frame = source->next(); ++k) {
    StereoResult scene = estimate_disparity(StereoPair::from(frame->left.gray, frame->right, frame->left.rgb),
                                            source->rig(), segmentation, exec);
    Image<Gray> left = frame->left.gray.clone();
    if (drive.black > 0 &&
        k % static_cast<std::size_t>(drive.black) == static_cast<std::size_t>(drive.black) - 1) {
      left.fill(0);
      scene.disparity.disparity_px.fill(std::numeric_limits<float>::quiet_NaN());
      scene.disparity.reject.fill(Reject::no_data);
    }
    if (k == 0) {
      const Pose first = first_pose(scene.ground, source->rig());
      from_level = camera_from_level(first);
      state = begin_odometry(first);
    }
    std::optional<MotionPrior> prior;
    if (wheels && k > 0) prior = wheels->between(ours.back().stamp, frame->stamp, from_level);
    const std::clock_t start = std::clock();
    const OdometryStep step =
        advance_odometry(state, {left, scene.disparity, scene.confidence, {}}, *source->rig(), prior, {});
    times.push_back(1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    ours.push_back({frame->stamp, step.state.map_from_camera});
    if (step.motion.refusal != MotionRefusal::none) ++all.refused;
    const bool frame_by_frame = truth.poses.size() > k && drive.truth != "groundtruth_left_camera_tum.txt";
    if (k > 0 && frame_by_frame && step.motion.refusal == MotionRefusal::none &&
        state.refused_in_a_row == 0) {
      const auto since = [&](const std::vector<TimedPose>& poses) {
        return inverse(poses[k].map_from_camera) * poses[key].map_from_camera;
      };
      nees.push_back(normalised_error(since(ours), step.motion.covariance, since(truth.poses)));
    }
    if (step.motion.is_new_keyframe) key = k;
    state = step.state;
  }
  all.error = trajectory_error(ours, truth.poses);
  all.nees = median(nees);
  all.milliseconds = median(times);
  const TrajectoryError& e = all.error;
  std::printf("| %-38s | %6.2f | %6.4f | %5.2f | %5.2f | %6.4f | %5.2f | %5.1f | %d | %4.1f |\n",
              (drive.folder.substr(drive.folder.rfind('/') + 1) + (drive.by_wheels ? ", wheels" : "") +
               (drive.black > 0 ? ", 1 of " + std::to_string(drive.black) + " black" : ""))
                  .c_str(),
              e.path_m, e.end_error_m, 100 * e.end_drift, kDegrees * e.end_error_rad, e.ate_rmse_m,
              100 * e.t_rel, all.nees, all.refused, all.milliseconds);
  return all;
}

class OdometryData : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(collection() / "real/sequences"))
      GTEST_SKIP() << "no collection of sequences (CAIRN_DATA)";
  }
};

TEST_F(OdometryData, DriftsByAtMostOneAndAHalfPercentOnTheRenderedDrives) {
  for (const char* folder : {"rendered/dev/sequences/dev_seqA", "rendered/dev/sequences/dev_seqB"}) {
    const Measurement m = measure({.folder = folder, .truth = ""});
    EXPECT_LE(m.error.end_drift, 0.015) << folder;
    EXPECT_EQ(m.refused, 0) << folder;
    EXPECT_LE(m.nees, 10) << folder;
  }
}

TEST_F(OdometryData, DriftsByAtMostOnePercentOnTheTourAndWheelsCarryItThroughTheDark) {
  const Measurement alone = measure({.folder = "rendered/tour_train", .truth = ""});
  EXPECT_LE(alone.error.end_drift, 0.010);
  EXPECT_LE(alone.error.end_error_rad * kDegrees, 1.5);
  EXPECT_EQ(alone.refused, 0);
  EXPECT_LE(alone.nees, 10);
  const Measurement wheels = measure({.folder = "rendered/tour_train", .truth = "", .by_wheels = true});
  EXPECT_LE(wheels.error.end_drift, 0.010);
  const Measurement dark =
      measure({.folder = "rendered/tour_train", .truth = "", .by_wheels = true, .black = 10});
  EXPECT_EQ(dark.refused, 10);
  EXPECT_LE(dark.error.ate_rmse_m, 1.5 * wheels.error.ate_rmse_m);
}

TEST_F(OdometryData, DriftsByAtMostOnePointTwoPercentOnTheStreet) {
  const Measurement m = measure({.folder = "real/sequences/kitti_odometry_04", .truth = "poses.txt"});
  EXPECT_LE(m.error.end_drift, 0.012);
}

TEST_F(OdometryData, StandsStillIfTheRigDoes) {
  const Measurement m = measure(
      {.folder = "real/sequences/euroc_V1_01_standstill", .truth = "groundtruth_left_camera_tum.txt"});
  EXPECT_LE(m.error.end_error_m, 0.002);
  EXPECT_LE(m.error.end_error_rad * kDegrees, 0.15);
}

}  // namespace
}  // namespace cairn
