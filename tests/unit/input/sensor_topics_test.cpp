// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/input/sensor_topics.hpp>
#include <cmath>
#include <numbers>

#include "support/recordings.hpp"
#include "support/sensor_messages.hpp"
#include "support/temporary_folder.hpp"

/// Other sensors as ROS messages: equal to the same data from files.
namespace cairn::input {
namespace {

using recordings::CameraFile;
using support::has;
using support::refusal;
using support::TemporaryFolder;
namespace messages = sensor_messages;

// ---- transforms ----

TEST(StaticTransforms, ConnectFramesThroughCommonAncestors) {
  StaticTransforms transforms;
  transforms.add(messages::transform("base_link", "mast", {0, 0, 1}, {0, 0, std::numbers::pi / 2}));
  transforms.add(messages::transform("mast", "camera", {0.2, 0, 0}, {}));
  transforms.add(messages::transform("/base_link", "/laser", {0.5, 0, 0.1}, {}));
  const auto laser_from_camera = transforms.between("laser", "camera");
  ASSERT_TRUE(laser_from_camera);
  // The mast is turned to the left, so 0.2 m ahead of it is 0.2 m to the left of the robot.
  EXPECT_NEAR(laser_from_camera->translation_m.x, -0.5, 1e-12);
  EXPECT_NEAR(laser_from_camera->translation_m.y, 0.2, 1e-12);
  EXPECT_NEAR(laser_from_camera->translation_m.z, 0.9, 1e-12);
  EXPECT_TRUE(transforms.between("camera", "camera"));
  EXPECT_FALSE(transforms.between("camera", "arm"));
  ros::TFMessage damaged = messages::transform("base_link", "arm", {}, {});
  damaged.transforms[0].transform.rotation = {0, 0, 0, 0};
  transforms.add(damaged);
  EXPECT_FALSE(transforms.between("camera", "arm"));
}

TEST(StaticTransforms, EndInACircle) {
  StaticTransforms transforms;
  transforms.add(messages::transform("a", "b", {1, 0, 0}, {}));
  transforms.add(messages::transform("b", "a", {1, 0, 0}, {}));
  EXPECT_FALSE(transforms.between("a", "c"));
  EXPECT_TRUE(transforms.between("a", "b"));
}

// ---- recordings and files ----

class SensorRecording : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "run.mcap"; }
  TemporaryFolder folder_;
};

void expect_same_priors(const MotionPriors& a, const MotionPriors& b) {
  int known = 0;
  for (int i = -1; i < 14; ++i) {
    const Stamp before{1'000'000'000 + i * 73'000'000LL};
    const Stamp now{before.ns + 66'000'000};
    const auto one = a.between(before, now);
    const auto other = b.between(before, now);
    ASSERT_EQ(one.has_value(), other.has_value()) << i;
    if (!one) continue;
    ++known;
    EXPECT_EQ(one->kind, other->kind);
    EXPECT_EQ(one->covariance, other->covariance);
    EXPECT_EQ(one->now_from_before.rotation, other->now_from_before.rotation);
    EXPECT_EQ(one->now_from_before.translation_m, other->now_from_before.translation_m);
  }
  EXPECT_GT(known, 5);
}

TEST_F(SensorRecording, OdometryIsThatOfTheSamePosesInAFile) {
  std::string tum = "# base_link\n";
  {
    CameraFile camera(file());
    const auto topic = camera.topic<ros::Odometry>("/odom");
    for (const ros::Odometry& message : messages::odometry(20)) {
      camera.add(topic, ros::stamp_of(message.header.stamp), message);
      tum += messages::tum_line(message);
    }
  }
  const auto topics = read_sensor_topics(file(), {.odometry = "/odom", .imu = {}, .scan = {}}, "");
  expect_same_priors(*topics.priors(), *load_odometry(folder_.with("base_link.tum", tum)));
  ASSERT_EQ(topics.assumptions().size(), 1U);
  EXPECT_TRUE(has(topics.assumptions()[0], {"no transform from base_link to cairn_camera", "at the centre"}));
}

TEST_F(SensorRecording, AGyroscopeIsThatOfTheSameRatesInAFile) {
  std::string csv;
  {
    CameraFile camera(file());
    const auto topic = camera.topic<ros::Imu>("/imu");
    for (const ros::Imu& message : messages::imu(200)) {
      camera.add(topic, ros::stamp_of(message.header.stamp), message);
      csv += messages::euroc_line(message);
    }
  }
  const auto topics = read_sensor_topics(file(), {.odometry = {}, .imu = "/imu", .scan = {}}, "");
  const auto priors = topics.priors();
  expect_same_priors(*priors, *load_imu(folder_.with("data.csv", csv)));
  EXPECT_TRUE(has(priors->description(), {"bias from the rest"}));
}

TEST_F(SensorRecording, ScansAreThoseOfTheSameTable) {
  std::string table;
  {
    CameraFile camera(file());
    const auto topic = camera.topic<ros::LaserScan>("/scan");
    for (const ros::LaserScan& message : messages::scans(5)) {
      camera.add(topic, ros::stamp_of(message.header.stamp), message);
      table += messages::table_line(message, table.empty());
    }
  }
  const auto topics = read_sensor_topics(file(), {.odometry = {}, .imu = {}, .scan = "/scan"}, "");
  const auto from_file = load_scans(folder_.with("scan.csv", table));
  const auto scans = topics.scans();
  ASSERT_EQ(scans.size(), from_file.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_EQ(scans[i].stamp, from_file[i].stamp);
    EXPECT_EQ(scans[i].first_rad, from_file[i].first_rad);
    EXPECT_EQ(scans[i].step_rad, from_file[i].step_rad);
    ASSERT_EQ(scans[i].ranges_m.size(), from_file[i].ranges_m.size());
    for (std::size_t k = 0; k < scans[i].ranges_m.size(); ++k)
      EXPECT_TRUE(scans[i].ranges_m[k] == from_file[i].ranges_m[k] ||
                  (std::isnan(scans[i].ranges_m[k]) && std::isnan(from_file[i].ranges_m[k])));
  }
}

TEST_F(SensorRecording, TheMountingOfTheCameraGivesItsOwnMotion) {
  {
    CameraFile camera(file());
    const auto topic = camera.topic<ros::Odometry>("/odom");
    for (const ros::Odometry& message : messages::odometry(20))
      camera.add(topic, ros::stamp_of(message.header.stamp), message);
    camera.add(camera.topic<ros::TFMessage>("/tf_static"), {0},
               messages::transform("base_link", "optical", {0.3, 0.1, 0.8}, messages::kOpticalFromRobot_rad));
  }
  const auto topics = read_sensor_topics(file(), {.odometry = "/odom", .imu = {}, .scan = {}}, "optical");
  EXPECT_TRUE(topics.assumptions().empty());
  const Stamp before{1'100'000'000};
  const Stamp now{1'200'000'000};
  const auto prior = topics.priors()->between(before, now);
  ASSERT_TRUE(prior);
  // Computed from the definition: the camera's pose in the world at both times.
  const auto all = messages::odometry(20);
  const auto camera_at = [&](std::size_t i) {
    const auto& p = all[i].pose.pose;
    const Pose robot = pose_of({p.position.x, p.position.y, p.position.z},
                               {p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w});
    Pose mounting = rotation_about(messages::kOpticalFromRobot_rad);
    mounting.translation_m = {0.3, 0.1, 0.8};
    return robot * mounting;
  };
  const Pose expected = inverse(camera_at(4)) * camera_at(2);
  EXPECT_NEAR(length(prior->now_from_before.translation_m - expected.translation_m), 0, 1e-9);
  EXPECT_NEAR(angle_of(prior->now_from_before * inverse(expected)), 0, 1e-6);
}

TEST_F(SensorRecording, WhatIsMissingIsNamed) {
  {
    CameraFile camera(file());
    (void)camera.topic<ros::Imu>("/imu");
    camera.add(camera.topic<ros::String>("/said"), {0}, ros::String{});
  }
  const auto read = [&](const SensorTopicNames& names) {
    return refusal([&] { (void)read_sensor_topics(file(), names, ""); });
  };
  EXPECT_TRUE(has(read({{}, {}, "/scan"}), {"has no topic /scan"}));
  EXPECT_TRUE(has(read({"/imu", {}, {}}), {"/imu is sensor_msgs/msg/Imu, expected nav_msgs/msg/Odometry"}));
  EXPECT_TRUE(has(read({{}, "/imu", {}}), {"/imu: has 0 rows"}));
}

// ---- lasers ----

TEST(Lasers, BeamsPointToTheSamePlacesFromTheCamera) {
  // A level camera, and lasers beside it, turned, and upside down.
  const Pose level = rotation_about({0, 0, 0});
  for (const Point3 turn : {Point3{}, Point3{0, 0, 0.7}, Point3{std::numbers::pi, 0, 0}}) {
    Pose robot_from_laser = rotation_about(turn);
    robot_from_laser.translation_m = {0.2, -0.3, -0.5};
    const Pose robot_from_camera = rotation_about(messages::kOpticalFromRobot_rad);
    const Pose camera_from_laser = level * inverse(robot_from_camera) * robot_from_laser;
    ros::LaserScan message = messages::scans(1)[0];
    message.ranges.assign(message.ranges.size(), 2);
    const LaserScan scan = scan_of(message, camera_from_laser);
    for (std::size_t i = 0; i < message.ranges.size(); i += 7) {
      const double angle =
          double{message.angle_min} + static_cast<double>(i) * double{message.angle_increment};
      const Point3 expected = camera_from_laser({2 * std::cos(angle), 2 * std::sin(angle), 0});
      const double a = scan.first_rad + static_cast<double>(i) * scan.step_rad;
      const Point3 found = scan.in_level_camera_m + Point3{-2 * std::sin(a), 0, 2 * std::cos(a)};
      EXPECT_NEAR(length(found - expected), 0, 1e-6) << i << " " << turn.x << " " << turn.z;
    }
  }
}

TEST(Lasers, RangesOutsideOfTheirLimitsAreNoEcho) {
  ros::LaserScan message = messages::scans(1)[0];
  message.ranges = {0.01F, 1, 99, std::nanf("")};
  const LaserScan scan = scan_of(message, std::nullopt);
  EXPECT_TRUE(std::isnan(scan.ranges_m[0]));
  EXPECT_EQ(scan.ranges_m[1], 1);
  EXPECT_TRUE(std::isnan(scan.ranges_m[2]) && std::isnan(scan.ranges_m[3]));
}

// ---- as they arrive ----

TEST(SensorTopics, ForgetWhatIsOldAndKeepTheBias) {
  SensorTopics all("");
  SensorTopics recent("");
  for (const ros::Imu& message : messages::imu(3000)) {
    all.add(message);
    recent.add(message);
    recent.forget_old();
  }
  const Stamp now = *recent.newest_motion();
  const Stamp before{now.ns - 100'000'000};
  const auto expected = all.priors()->between(before, now);
  const auto found = recent.priors()->between(before, now);
  ASSERT_TRUE(expected && found);
  EXPECT_EQ(expected->now_from_before.rotation, found->now_from_before.rotation);
  EXPECT_EQ(expected->covariance, found->covariance);
  EXPECT_FALSE(recent.priors()->between({now.ns - 12'000'000'000}, now)) << "forgotten";
  EXPECT_GT(recent.priors()->first().ns, now.ns - 11'000'000'000);
}

TEST(SensorTopics, IgnoreRepeatedMessagesAndBeginAgainWhereTheClockIsSetBack) {
  SensorTopics topics("");
  const auto all = messages::odometry(20);
  for (const auto& message : all) topics.add(message);
  topics.add(all[10]);
  EXPECT_EQ(topics.newest_motion(), ros::stamp_of(all.back().header.stamp));
  ros::Odometry earlier = all[0];
  earlier.header.stamp = {-5, 0};
  topics.add(earlier);
  EXPECT_EQ(topics.newest_motion(), ros::stamp_of(earlier.header.stamp));
  EXPECT_FALSE(topics.priors());
}

}  // namespace
}  // namespace cairn::input
