// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <array>
#include <cairn/input/priors.hpp>
#include <cairn/input/sequence.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <support/collection.hpp>
#include <support/temporary_folder.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::TemporaryFolder;

constexpr double kDegree = std::numbers::pi / 180;
const std::string kHeader = "frame,t_s,v_m_per_s,omega_rad_per_s\n";

Stamp at_s(double seconds) {
  return Stamp{std::llround(seconds * 1e9)};
}

double sigma(const MotionPrior& prior, std::size_t axis) {
  return std::sqrt(prior.covariance[7 * axis]);
}

TEST(PriorOfWheels, StraightAheadIsAlongTheCamerasView) {
  const TemporaryFolder folder;
  const auto priors = load_odometry(folder.with("o.csv", kHeader + "0,0,0,0\n1,0.1,2,0\n2,0.2,2,0\n"));
  const auto prior = priors->between(at_s(0), at_s(0.2));
  ASSERT_TRUE(prior);
  EXPECT_EQ(prior->kind, PriorKind::wheels);
  EXPECT_EQ(priors->kind(), PriorKind::wheels);
  // A point 1 m ahead is now 0.6 m ahead.
  const Point3 now = prior->now_from_before({0, 0, 1});
  EXPECT_NEAR(now.x, 0, 1e-12);
  EXPECT_NEAR(now.z, 0.6, 1e-12);
  EXPECT_NEAR(sigma(*prior, 2), 0.05 * 0.4 + 0.005, 1e-12);
  EXPECT_LT(sigma(*prior, 0), 0.005);
  EXPECT_NEAR(sigma(*prior, 4), 0.3 * kDegree, 1e-12);
  EXPECT_TRUE(has(priors->description(), {"wheels", "3 rows at 10 Hz"}));
}

TEST(PriorOfWheels, TurningLeftMovesPointsAheadToTheRight) {
  const TemporaryFolder folder;
  const auto priors = load_odometry(folder.with("o.csv", kHeader + "0,0,0,0\n1,0.1,0,1\n"));
  const Point3 now = priors->between(at_s(0), at_s(0.1))->now_from_before({0, 0, 1});
  EXPECT_NEAR(now.x, std::sin(0.1), 1e-12);
  EXPECT_NEAR(now.y, 0, 1e-12);
  EXPECT_NEAR(now.z, std::cos(0.1), 1e-12);
}

TEST(PriorOfWheels, ACircleDoesNotDependOnTheNumberOfRows) {
  const TemporaryFolder folder;
  std::string rows = kHeader;
  for (int i = 0; i <= 20; ++i) {
    rows += std::to_string(i) + "," + std::to_string(0.1 * i) + ",1.5," +
            std::to_string(std::numbers::pi / 4) + "\n";
  }
  const auto priors = load_odometry(folder.with("o.csv", rows));
  // A quarter of a circle to the left, whose radius is v / omega.
  const double radius = 1.5 / (std::numbers::pi / 4);
  const auto prior = priors->between(at_s(0), at_s(2));
  ASSERT_TRUE(prior);
  const Point3 place = inverse(prior->now_from_before).translation_m;
  EXPECT_NEAR(place.x, -radius, 1e-4);
  EXPECT_NEAR(place.z, radius, 1e-4);
  EXPECT_NEAR(angle_of(prior->now_from_before), 90 * kDegree, 1e-4);
  // In parts that do not end at rows.
  Pose whole;
  for (const double from : {0.0, 0.73, 1.21}) {
    whole = priors->between(at_s(from), at_s(from == 0      ? 0.73
                                             : from == 0.73 ? 1.21
                                                            : 2))
                ->now_from_before *
            whole;
  }
  EXPECT_NEAR(length(whole.translation_m - prior->now_from_before.translation_m), 0, 1e-9);
}

TEST(PriorOfWheels, ACameraThatLooksDownMovesAlongTheFloor) {
  const TemporaryFolder folder;
  const auto priors = load_odometry(folder.with("o.csv", kHeader + "0,0,0,0\n1,0.1,10,0\n"));
  const double pitch = 12;
  const auto prior = priors->between(at_s(0), at_s(0.1), camera_from_level(pitch, 0));
  ASSERT_TRUE(prior);
  // Forward on the floor is forward and up for a camera that looks down.
  const Point3 way = inverse(prior->now_from_before).translation_m;
  EXPECT_NEAR(way.y, -std::sin(pitch * kDegree), 1e-12);
  EXPECT_NEAR(way.z, std::cos(pitch * kDegree), 1e-12);
  const Point3 down = camera_from_level(10, 20).rotated({0, 1, 0});  // as KnownGround has it
  EXPECT_NEAR(down.x, std::sin(20 * kDegree) * std::cos(10 * kDegree), 1e-12);
  EXPECT_NEAR(down.y, std::cos(20 * kDegree) * std::cos(10 * kDegree), 1e-12);
  EXPECT_NEAR(down.z, std::sin(10 * kDegree), 1e-12);
}

TEST(PriorOfWheels, IsNoneOutsideOverGapsAndAtNaN) {
  const TemporaryFolder folder;
  const auto priors = load_odometry(
      folder.with("o.csv", kHeader + "0,1.0,0,0\n1,1.1,1,0\n2,1.5,1,0\n3,1.6,1,0\n4,1.7,nan,0\n5,1.8,1,0\n6,"
                                     "1.9,,0\n7,2.0,1,0\n8,2.1,1e9,0\n9,2.2,1,0\n"
                                     "10,2.3,1,0\n11,2.4,1,0\n"));
  EXPECT_EQ(priors->first().ns, 1000000000);
  EXPECT_EQ(priors->last().ns, 2400000000);
  EXPECT_TRUE(priors->between(at_s(1.0), at_s(1.1)));
  EXPECT_FALSE(priors->between(at_s(0.9), at_s(1.1)));
  EXPECT_FALSE(priors->between(at_s(2.3), at_s(2.5)));
  EXPECT_FALSE(priors->between(at_s(1.05), at_s(1.2)));  // 0.4 s without a row
  EXPECT_TRUE(priors->between(at_s(1.5), at_s(1.6)));
  EXPECT_FALSE(priors->between(at_s(1.55), at_s(1.65)));  // nan
  EXPECT_FALSE(priors->between(at_s(1.8), at_s(1.9)));    // empty
  EXPECT_FALSE(priors->between(at_s(2.0), at_s(2.1)));    // 1e9 m/s
  EXPECT_TRUE(priors->between(at_s(2.1), at_s(2.4)));
  EXPECT_FALSE(priors->between(at_s(2.2), at_s(2.2)));
  EXPECT_FALSE(priors->between(at_s(2.3), at_s(2.2)));
}

TEST(PriorOfWheels, RefusesOtherUnitsAndOtherFiles) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    return refusal([&] { (void)load_odometry(folder.with("o.csv", text)); });
  };
  EXPECT_TRUE(has(refused(kHeader + "0,0,0,0\n1,0.1,400,0\n2,0.2,410,0\n3,0.3,420,0\n"),
                  {"o.csv", "410 m/s", "mm/s"}));
  EXPECT_TRUE(has(refused(kHeader + "0,0,0,0\n1,0.1,1,45\n2,0.2,1,45\n"), {"45 rad/s", "degrees"}));
  EXPECT_TRUE(has(refused(kHeader + "0,0,0,0\n1,0.1,1,0\n2,0.1,1,0\n"), {"of line 4", "0.1 s"}));
  EXPECT_TRUE(has(refused(kHeader + "0,0,0,0\n"), {"has 1 row of numbers"}));
  EXPECT_TRUE(has(refused(kHeader + "0,0,0\n1,1,1\n"), {"o.csv:2", "3 fields, expected 4"}));
  EXPECT_TRUE(has(refused(kHeader + "0,0,fast,0\n1,1,1,1\n"), {"o.csv:2", "'fast'"}));
  EXPECT_TRUE(has(refused("frame,t_s,speed\n0,0,0\n"), {"no column v_m_per_s"}));
  EXPECT_TRUE(has(refused("1 2 3\n"), {"3 numbers", "TUM", "KITTI"}));
  EXPECT_TRUE(has(refused(""), {"no lines"}));
  EXPECT_TRUE(has(refusal([&] { (void)load_odometry(folder.path() / "none.csv"); }), {"none.csv"}));
}

TEST(PriorOfPoses, IsTheMotionBetweenTwoStamps) {
  const TemporaryFolder folder;
  // A camera that looks along the world's z, and turns about its y.
  const std::string half = std::to_string(std::sqrt(0.5));
  const auto priors = load_odometry(folder.with(
      "poses.tum", "# t x y z qx qy qz qw\n10.0 0 0 0 0 0 0 1\n10.1 0 0 1 0 0 0 1\n10.2 0 0 1 0 " + half +
                       " 0 " + half + "\n"));
  const Pose way = priors->between(at_s(10.0), at_s(10.05))->now_from_before;
  EXPECT_NEAR(way.translation_m.z, -0.5, 1e-9);
  EXPECT_NEAR(angle_of(priors->between(at_s(10.05), at_s(10.15))->now_from_before), 45 * kDegree, 1e-6);
  EXPECT_FALSE(priors->between(at_s(9.95), at_s(10.05)));
  EXPECT_TRUE(has(priors->description(), {"poses of the camera"}));
}

TEST(PriorOfPoses, OfARobotAreTransformedToTheCamera) {
  const TemporaryFolder folder;
  // The robot moves along its x and turns left about its z.
  const std::string rows = "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 " + std::to_string(std::sin(0.1)) + " " +
                           std::to_string(std::cos(0.1)) + "\n";
  for (const auto& [name, text] : {std::pair{std::string("odom_base_link.tum"), rows},
                                   std::pair{std::string("odom.tum"), "# map to base_link\n" + rows}}) {
    const auto priors = load_odometry(folder.with(name, text));
    const Pose before_from_now = inverse(priors->between(at_s(0), at_s(0.1))->now_from_before);
    EXPECT_NEAR(before_from_now.translation_m.z, 1, 1e-6) << name;
    EXPECT_NEAR(before_from_now.translation_m.x, 0, 1e-6) << name;
    EXPECT_NEAR(rotation_vector(before_from_now).y, -0.2, 1e-5) << name;  // about up, which is -y
  }
}

TEST(PriorOfPoses, OfKittiUsesTheSourcesStamps) {
  const TemporaryFolder folder;
  const fs::path poses = folder.with("poses/04.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1.25\n");
  EXPECT_TRUE(
      has(refusal([&] { (void)load_odometry(poses); }), {"04.txt", "no stamps", "times.txt", "2 of them"}));
  (void)folder.with("times.txt", "0.0\n1.036000e-01\n");
  const auto priors = load_odometry(poses, folder.path());
  EXPECT_NEAR(priors->between(at_s(0), at_s(0.1036))->now_from_before.translation_m.z, -1.25, 1e-9);
  EXPECT_NEAR(sigma(*priors->between(at_s(0), at_s(0.1036)), 0), 0.05 * 1.25 + 0.005, 1e-9);
}

TEST(PriorOfPoses, RefusesMillimetres) {
  const TemporaryFolder folder;
  const fs::path poses = folder.with("mm.tum", "0.0 0 0 0 0 0 0 1\n0.1 40 0 0 0 0 0 1\n0.2 80 0 0 0 0 0 1\n");
  EXPECT_TRUE(has(refusal([&] { (void)load_odometry(poses); }), {"mm.tum", "400 m/s", "in mm"}));
}

/// Rates at 100 Hz: one second at rest with a bias, then a rotation about one axis.
std::string imu_rows(double bias, double rate_rad_s, const char* noise = "0") {
  std::string text = "#timestamp [ns],w_RS_S_x [rad s^-1]\n";
  for (int i = 0; i <= 200; ++i) {
    const double about_y = bias + (i > 100 ? rate_rad_s : 0);
    text += std::to_string(1000000000LL + 10000000LL * i) + "," + (i % 2 == 0 ? "0" : noise) + "," +
            std::to_string(about_y) + ",0,0,9.81,0\n";
  }
  return text;
}

TEST(PriorOfAGyroscope, IsARotationWithoutItsBias) {
  const TemporaryFolder folder;
  const auto priors = load_imu(folder.with("imu.csv", imu_rows(0.08, 0.5)));
  EXPECT_EQ(priors->kind(), PriorKind::gyroscope);
  EXPECT_TRUE(has(priors->description(), {"gyroscope", "100 Hz", "bias from the rest"}));
  const auto rest = priors->between(at_s(1.2), at_s(1.9));
  ASSERT_TRUE(rest);
  EXPECT_NEAR(angle_of(rest->now_from_before), 0, 1e-9);
  // Its y is the camera's y, which is down: a positive rotation is to the right.
  const auto turn = priors->between(at_s(2.2), at_s(2.7));
  const Point3 ahead = turn->now_from_before({0, 0, 1});
  EXPECT_NEAR(ahead.x, -std::sin(0.25), 1e-6);
  EXPECT_EQ(length(turn->now_from_before.translation_m), 0);
  EXPECT_GE(sigma(*turn, 0), 100);
  EXPECT_LT(sigma(*turn, 3), 0.01);
  EXPECT_EQ(turn->kind, PriorKind::gyroscope);
}

TEST(PriorOfAGyroscope, OfAMovingStartHasAnUnknownBias) {
  const TemporaryFolder folder;
  const auto priors = load_imu(folder.with("imu.csv", imu_rows(0.08, 0.5, "0.4")));
  EXPECT_TRUE(has(priors->description(), {"bias unknown"}));
  EXPECT_GT(sigma(*priors->between(at_s(1.2), at_s(1.9)), 3), 0.05);
}

TEST(PriorOfAGyroscope, IsRotatedToTheCamera) {
  const TemporaryFolder folder;
  // The IMU's y is the camera's x: pitch.
  const Pose camera_from_imu{{0, 1, 0, -1, 0, 0, 0, 0, 1}, {}};
  const auto priors = load_imu(folder.with("imu.csv", imu_rows(0, 0.5)), camera_from_imu);
  const Point3 turn = rotation_vector(priors->between(at_s(2.2), at_s(2.7))->now_from_before);
  EXPECT_NEAR(turn.x, -0.25, 1e-6);
  EXPECT_NEAR(turn.y, 0, 1e-6);
}

TEST(PriorOfAGyroscope, IsNoneOverGapsAndAtNaN) {
  const TemporaryFolder folder;
  const auto priors = load_imu(folder.with("imu.csv",
                                           "1000000000,0,0,0\n1100000000,0,0,0\n1400000000,0,0,0\n1500000000,"
                                           "nan,0,0\n1600000000,0,0,0\n1700000000,0,0,0\n"));
  EXPECT_TRUE(priors->between(at_s(1.0), at_s(1.1)));
  EXPECT_FALSE(priors->between(at_s(1.05), at_s(1.45)));
  EXPECT_FALSE(priors->between(at_s(1.4), at_s(1.45)));
  EXPECT_FALSE(priors->between(at_s(1.55), at_s(1.6)));
  EXPECT_TRUE(priors->between(at_s(1.6), at_s(1.7)));
  EXPECT_FALSE(priors->between(at_s(1.6), at_s(1.8)));
}

TEST(PriorOfAGyroscope, RefusesOtherUnitsAndOtherFiles) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    return refusal([&] { (void)load_imu(folder.with("imu.csv", text)); });
  };
  EXPECT_TRUE(has(refused("1.5,0,0,0\n1.6,0,0,0\n"), {"imu.csv:1", "ns", "these are s"}));
  EXPECT_TRUE(has(refused("1,0,0,0\n2,0,0,0\n3,0,0,0\n"), {"less than 1 us"}));
  EXPECT_TRUE(has(refused("1000000,90,0,0\n2000000,90,0,0\n"), {"90 rad/s", "degrees"}));
  EXPECT_TRUE(has(refused("1000000,0,0\n"), {"imu.csv:1", "3 fields"}));
  EXPECT_TRUE(has(refused("2000000,0,0,0\n1000000,0,0,0\n"), {"of line 2"}));
}

TEST(Priors, AreReadUnderDamageOrRefused) {
  const TemporaryFolder folder;
  support::survives_damage(
      folder, "o.csv", kHeader + "0,0,0,0\n1,0.1,1.5,-0.1\n2,0.2,1e-3,nan\n",
      [](const fs::path& path) { (void)load_odometry(path)->between(at_s(0.05), at_s(0.15)); });
  support::survives_damage(
      folder, "p.tum", "0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0.1 0.9\n",
      [](const fs::path& path) { (void)load_odometry(path)->between(at_s(0.05), at_s(0.1)); });
  support::survives_damage(folder, "i.csv", "#t\n1000000000,0.1,0,0,1,2,3\n1100000000,0.1,nan,0,1,2,3\n",
                           [](const fs::path& path) { (void)load_imu(path)->between(at_s(1), at_s(1.1)); });
}

TEST(PriorsOfTheCollection, AgreeWithTheTruth) {
  const fs::path tour = collection() / "rendered/tour_train";
  if (!fs::exists(tour)) GTEST_SKIP() << "no data collection: " << tour;
  const auto priors = load_odometry(tour / "odometry.csv");
  const auto true_pose = [&](int frame) {
    std::array<char, 8> name{};
    std::snprintf(name.data(), name.size(), "%03d", frame);
    std::ifstream file(tour / name.data() / "pose.txt");
    std::string line;
    std::getline(file, line);  // a comment
    Pose pose;
    for (std::size_t row = 0; row < 3; ++row) {
      double t = 0;
      file >> pose.rotation[3 * row] >> pose.rotation[3 * row + 1] >> pose.rotation[3 * row + 2] >> t;
      (row == 0 ? pose.translation_m.x : row == 1 ? pose.translation_m.y : pose.translation_m.z) = t;
    }
    return pose;
  };
  int within = 0;
  for (int i = 1; i < 100; ++i) {
    const auto prior =
        priors->between(Stamp{200'000'000LL * (i - 1)}, Stamp{200'000'000LL * i}, camera_from_level(12, 0));
    ASSERT_TRUE(prior) << i;
    const Pose truth = inverse(true_pose(i)) * true_pose(i - 1);
    const Pose error = prior->now_from_before * inverse(truth);
    EXPECT_LT(length(error.translation_m), 0.03) << i;
    const Point3 t = error.translation_m;
    const Point3 r = rotation_vector(error);
    const std::array parts{t.x, t.y, t.z, r.x, r.y, r.z};
    // The camera shakes by 1 mm and 0.07 degrees, and wheels have errors of 3 %: nearly all are within three
    // sigma of each axis.
    bool is_within = true;
    for (std::size_t axis = 0; axis < parts.size(); ++axis)
      is_within &= std::abs(parts[axis]) < 3 * sigma(*prior, axis);
    within += is_within ? 1 : 0;
  }
  EXPECT_GE(within, 95);
}

TEST(PriorsOfTheCollection, AGyroscopeAtRestDoesNotTurn) {
  const fs::path euroc = collection() / "real/sequences/euroc_V1_01_standstill";
  if (!fs::exists(euroc)) GTEST_SKIP() << "no data collection: " << euroc;
  const auto mounting = mounting_of_imu(euroc / "mav0/imu0/data.csv", nullptr);
  ASSERT_TRUE(mounting);
  const auto priors = load_imu(euroc / "mav0/imu0/data.csv", *mounting);
  int count = 0;
  for (std::int64_t k = 0; k < 19; ++k) {
    const Stamp before{1403715274312143104 + k * 100'000'000};
    const auto prior = priors->between(before, Stamp{before.ns + 100'000'000});
    if (!prior) continue;
    ++count;
    EXPECT_LT(angle_of(prior->now_from_before), 3 * sigma(*prior, 3)) << k << " " << priors->description();
  }
  EXPECT_GE(count, 17);
}

}  // namespace
}  // namespace cairn::input
