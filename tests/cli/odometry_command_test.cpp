// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <nlohmann/json.hpp>
#include <support/textured_room.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

/// A camera that moves 3 cm forward and rotates by one degree per frame.
class OdometryCommand : public CommandTest {
 protected:
  static constexpr int kFrames = 6;

  static Pose truth(int k) {
    constexpr double kDegree = 0.017453292519943295;
    Pose pose = rotation_about({0, kDegree * k, 0});
    pose.translation_m = {0, 0, 0.03 * k};
    return pose;
  }

  void SetUp() override {
    for (int k = 0; k < kFrames; ++k) {
      const std::string folder = "frames/00" + std::to_string(k) + "/";
      fs::create_directories(at(folder));
      Pose right;
      right.translation_m = {double{room::kRig.baseline_m}, 0, 0};
      const room::Seen left_view = room::look(truth(k));
      const room::Seen right_view = room::look(truth(k) * right);
      io::save_png(at(folder + "left.png"), left_view.left.view());
      io::save_png(at(folder + "right.png"), right_view.left.view());
      write(at(folder + "calib.txt"),
            "fx=200\nfy=200\ncx=119.5\ncy=89.5\nbaseline=0.12\nwidth=240\nheight=180\nndisp=32\n");
      std::string rows;
      const Pose pose = truth(k);
      for (std::size_t row = 0; row < 3; ++row) {
        const double t = row == 0   ? pose.translation_m.x
                         : row == 1 ? pose.translation_m.y
                                    : pose.translation_m.z;
        for (std::size_t column = 0; column < 3; ++column)
          rows += std::to_string(pose.rotation[3 * row + column]) + " ";
        rows += std::to_string(t) + "\n";
      }
      write(at(folder + "pose.txt"), rows + "0 0 0 1\n");
    }
  }
};

TEST_F(OdometryCommand, WritesATrajectoryThatEvaluateComparesWithTheTruth) {
  const Outcome ran = run({"odometry", path("frames"), "-o", path("poses.tum")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "");
  EXPECT_NE(ran.err.find("6 frames, "), std::string::npos) << ran.err;
  EXPECT_EQ(ran.err.find("refused"), std::string::npos) << ran.err;
  const Outcome compared =
      run({"evaluate", path("poses.tum"), path("frames"), "--json", path("errors.json")});
  ASSERT_EQ(compared.code, 0) << compared.err;
  EXPECT_NE(compared.out.find("ATE"), std::string::npos);
  const auto errors = nlohmann::json::parse(content(at("errors.json")))["summary"]["trajectory"];
  EXPECT_EQ(errors["compared"], kFrames);
  EXPECT_NEAR(errors["path_m"].get<double>(), 0.15, 1e-4);
  EXPECT_LT(errors["end_error_m"].get<double>(), 0.01);
  EXPECT_LT(errors["end_error_deg"].get<double>(), 0.3);
}

TEST_F(OdometryCommand, PrintsInEachFormat) {
  const Outcome tum = run({"odometry", path("frames"), "--frames", "0:3"});
  EXPECT_EQ(std::count(tum.out.begin(), tum.out.end(), '\n'), 3) << tum.out << tum.err;
  EXPECT_EQ(tum.out.find("0.000000000 "), 0U) << tum.out;
  const Outcome kitti = run({"odometry", path("frames"), "--frames", "0:3", "--form", "kitti"});
  EXPECT_EQ(std::count(kitti.out.begin(), kitti.out.end(), ' '), 3 * 11) << kitti.out;
  const Outcome euroc = run({"odometry", path("frames"), "--frames", "0:3", "--form", "euroc"});
  EXPECT_NE(euroc.out.find("\n100000000,"), std::string::npos) << euroc.out;
}

TEST_F(OdometryCommand, UsesTheWheelsOnBlackImages) {
  Image<Gray> black(room::kSize);
  black.fill(0);
  for (const char* name : {"left.png", "right.png"})
    io::save_png(at(std::string("frames/003/") + name), black.view());
  std::string speeds = "frame,t_s,v_m_per_s,omega_rad_per_s\n";
  for (int k = 0; k < kFrames; ++k)
    speeds += std::to_string(k) + "," + std::to_string(0.1 * k) + (k == 0 ? ",0,0\n" : ",0.3,-0.174533\n");
  write(at("wheels.csv"), speeds);
  const Outcome ran =
      run({"odometry", path("frames"), "--odometry", path("wheels.csv"), "-o", path("poses.tum")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find("refused: 1 few_points"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("used for 5 frames"), std::string::npos) << ran.err;
  const Outcome compared =
      run({"evaluate", path("poses.tum"), path("frames"), "--json", path("errors.json")});
  const auto errors = nlohmann::json::parse(content(at("errors.json")))["summary"]["trajectory"];
  EXPECT_EQ(errors["compared"], kFrames);
  EXPECT_LT(errors["ate_max_m"].get<double>(), 0.01);
}

TEST_F(OdometryCommand, RefusesUnusableInput) {
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& why) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(why), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  };
  refused({"odometry", path("frames"), "--form", "ply"}, "expected tum, kitti or euroc");
  refused({"odometry", path("frames"), "--set", "odometry.method=off"}, "odometry.method");
  refused({"odometry", path("frames"), "--odometry", path("absent.csv")}, "absent.csv");
  refused({"odometry", path("frames"), "--odometry", path("a.csv"), "--imu", path("b.csv")}, "--imu");
  refused({"odometry", path("absent")}, "absent");
  for (int k = 0; k < kFrames; ++k) fs::remove(at("frames/00" + std::to_string(k) + "/calib.txt"));
  refused({"odometry", path("frames"), "-o", path("poses.tum")}, "no calibration");
  EXPECT_FALSE(fs::exists(at("poses.tum")));
  write(at("poses.tum"), "0.1 1 2 3\n");
  refused({"evaluate", path("poses.tum"), path("frames")}, "poses.tum:1");
  write(at("poses.tum"), "77.1 1 2 3 0 0 0 1\n77.2 1 2 3 0 0 0 1\n");
  write(at("truth.tum"), "0.1 1 2 3 0 0 0 1\n0.2 1 2 3 0 0 0 1\n");
  refused({"evaluate", path("poses.tum"), path("truth.tum")}, "expected at least two within 0.01 s");
}

}  // namespace
}  // namespace cairn::command
