// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <filesystem>
#include <fstream>

namespace cairn::output {
namespace {

namespace fs = std::filesystem;

class TrajectoryFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / (std::string("cairn_trajectory_") +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path with(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string refusal(const std::string& text) const {
    try {
      (void)load_trajectory(with("poses.txt", text));
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }
  [[nodiscard]] const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

std::vector<TimedPose> some_poses() {
  std::vector<TimedPose> poses;
  for (int k = 0; k < 5; ++k) {
    Pose pose = rotation_about({0.1 * k, -0.2, 0.5 * k});
    pose.translation_m = {1.0 * k, -2.5, 0.001 * k};
    poses.push_back({Stamp{1'403'715'274'312'143'104 + std::int64_t{50'000'000} * k}, pose});
  }
  return poses;
}

TEST_F(TrajectoryFiles, AreReadBackAsWritten) {
  for (const auto& form : kTrajectoryForms) {
    const std::vector<TimedPose> poses = some_poses();
    const Trajectory back =
        load_trajectory(with("poses.txt", "# a comment\n" + trajectory_text(poses, form.value)));
    ASSERT_EQ(back.poses.size(), poses.size()) << form.name;
    EXPECT_EQ(back.has_stamps, form.value != TrajectoryForm::kitti);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (back.has_stamps) {
        EXPECT_EQ(back.poses[k].stamp, poses[k].stamp) << form.name;
      }
      const Pose off = inverse(back.poses[k].map_from_camera) * poses[k].map_from_camera;
      EXPECT_LT(length(off.translation_m), 1e-7) << form.name;
      EXPECT_LT(angle_of(off), 1e-7) << form.name;
    }
  }
}

TEST_F(TrajectoryFiles, OfKittiReadTheStampsNextToThem) {
  const std::string text = trajectory_text(some_poses(), TrajectoryForm::kitti);
  EXPECT_EQ(load_trajectory(with("poses.txt", text)).poses[2].stamp.ns, 200'000'000);
  with("times.txt", "0.0\n1.036e-01\n0.21\n0.31\n0.42\n");
  const Trajectory timed = load_trajectory(folder() / "poses.txt");
  EXPECT_TRUE(timed.has_stamps);
  EXPECT_EQ(timed.poses[1].stamp.ns, 103'600'000);
  with("times.txt", "0.0\n0.1\n");
  EXPECT_FALSE(load_trajectory(folder() / "poses.txt").has_stamps) << "stamps of something else";
}

TEST_F(TrajectoryFiles, OfEurocMayNameTheirColumns) {
  const Trajectory read = load_trajectory(
      with("data.csv", "timestamp,x,y,z,qw,qx,qy,qz\n1403715274312143104,1,2,3,1,0,0,0,0.5,0.5\n"));
  ASSERT_EQ(read.poses.size(), 1U);
  EXPECT_EQ(read.poses[0].map_from_camera.translation_m, (Point3{1, 2, 3}));
  EXPECT_EQ(angle_of(read.poses[0].map_from_camera), 0);
}

TEST_F(TrajectoryFiles, FramesOfAFolderMayBeAnExcerptOfItsTable) {
  for (const int frame : {3, 5})
    with("seq/" + std::to_string(frame) + "/pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
  with("seq/trajectory.csv", "frame,t_s\n1,0.1\n3,0.3\n4,0.4\n5,0.5\n");
  const Trajectory read = load_trajectory(folder() / "seq");
  ASSERT_EQ(read.poses.size(), 2U);
  EXPECT_EQ(read.poses[0].stamp.ns, 300'000'000);
  EXPECT_EQ(read.poses[1].stamp.ns, 500'000'000);
  with("seq/stamps.txt", "2000000000\n1000000000\n");
  try {
    (void)load_trajectory(folder() / "seq");
    FAIL() << "the stamps descend";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is not later than"), std::string::npos) << error.what();
  }
}

TEST_F(TrajectoryFiles, FramesOfAFolderAreInTheOrderOfTheirNumbers) {
  for (const int frame : {1, 2, 9, 10, 11}) {
    with("seq/" + std::to_string(frame) + "/pose.txt",
         "1 0 0 " + std::to_string(frame) + "\n0 1 0 0\n0 0 1 0\n");
  }
  std::vector<double> order;
  for (const TimedPose& pose : load_trajectory(folder() / "seq").poses)
    order.push_back(pose.map_from_camera.translation_m.x);
  EXPECT_EQ(order, (std::vector<double>{1, 2, 9, 10, 11}));
}

TEST_F(TrajectoryFiles, AFolderOfFramesHasOnePoseEach) {
  with("seq/000/pose.txt", "# camera-to-world\n1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  with("seq/001/pose.txt", "1 0 0 0.6\n0 1 0 0\n0 0 1 0\n");
  const Trajectory bare = load_trajectory(folder() / "seq");
  ASSERT_EQ(bare.poses.size(), 2U);
  EXPECT_FALSE(bare.has_stamps);
  EXPECT_EQ(bare.poses[1].map_from_camera.translation_m.x, 0.6);
  with("seq/trajectory.csv", "frame,t_s,x_m,y_m,heading_rad\n0,0.000,0,0,0\n1,0.200,0,0,0\n");
  EXPECT_EQ(load_trajectory(folder() / "seq").poses[1].stamp.ns, 200'000'000);
  with("seq/trajectory.csv", "frame,t_s\n0,0.000\n");
  EXPECT_THROW((void)load_trajectory(folder() / "seq"), Error);
  with("other/readme.txt", "");
  EXPECT_THROW((void)load_trajectory(folder() / "other"), Error);
}

TEST_F(TrajectoryFiles, AreRefusedInOneLineThatNamesThePosition) {
  const std::string good = "0.1 1 2 3 0 0 0 1\n";
  EXPECT_EQ(refusal(good), "none");
  EXPECT_NE(refusal("").find("contains no pose"), std::string::npos);
  EXPECT_NE(refusal(good + "0.2 1 2 3\n").find("poses.txt:2: found 4 fields"), std::string::npos);
  EXPECT_NE(refusal(good + "0.2 1 2 x 0 0 0 1\n").find("'x', expected a number"), std::string::npos);
  EXPECT_NE(refusal(good + "0.2 1 2 nan 0 0 0 1\n").find("expected a finite number"), std::string::npos);
  EXPECT_NE(refusal(good + "0.1 1 2 3 0 0 0 1\n").find("is not later than"), std::string::npos);
  EXPECT_NE(refusal("0.1 1 2 3 0 0 0 0\n").find("quaternion"), std::string::npos);
  EXPECT_NE(refusal("1 0 0 0 0 1 0 0 0 0 2 0\n").find("not a rotation"), std::string::npos);
  EXPECT_NE(refusal("1 0 0 0 0 1 0 0 0 0 -1 0\n").find("not a rotation"), std::string::npos) << "mirrored";
  EXPECT_NE(refusal(good + "1 0 0 0 0 1 0 0 0 0 1 0\n").find("differs in form"), std::string::npos);
  EXPECT_THROW((void)load_trajectory(folder() / "absent.txt"), Error);
}

}  // namespace
}  // namespace cairn::output
