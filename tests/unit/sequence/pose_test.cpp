// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/sequence/pose.hpp>
#include <cmath>
#include <numbers>

namespace cairn {
namespace {

constexpr double kPi = std::numbers::pi;

Pose some_pose() {
  Pose pose = rotation_about({0.3, -1.1, 0.7});
  pose.translation_m = {1, -2, 3};
  return pose;
}

void expect_near(Point3 a, Point3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}
void expect_near(const Pose& a, const Pose& b) {
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(a.rotation[k], b.rotation[k], 1e-12) << k;
  expect_near(a.translation_m, b.translation_m);
}

TEST(Pose, TurnsAboutTheAxisByTheRightHand) {
  expect_near(rotation_about({0, 0, kPi / 2})({1, 0, 0}), {0, 1, 0});
  expect_near(rotation_about({kPi / 2, 0, 0})({0, 1, 0}), {0, 0, 1});
  expect_near(rotation_about({0, kPi / 2, 0})({0, 0, 1}), {1, 0, 0});
}

TEST(Pose, AppliesTheRightOperandFirst) {
  const Pose a = some_pose();
  Pose b = rotation_about({0, 0.2, 0});
  b.translation_m = {0, 0, 5};
  const Point3 p{0.1, 0.2, 0.3};
  expect_near((a * b)(p), a(b(p)));
}

TEST(Pose, IsUndoneByItsInverse) {
  expect_near(some_pose() * inverse(some_pose()), Pose{});
  expect_near(inverse(some_pose()) * some_pose(), Pose{});
}

TEST(Pose, DoesNotTranslateDirections) {
  EXPECT_NEAR(length(some_pose().rotated({3, 4, 12})), 13, 1e-12);
  expect_near(Pose{some_pose().rotation, {}}({1, 2, 3}), some_pose().rotated({1, 2, 3}));
}

TEST(Pose, RoundTripsThroughItsQuaternion) {
  expect_near(pose_of({1, -2, 3}, quaternion(some_pose())), some_pose());
  EXPECT_EQ(quaternion({}), (std::array<double, 4>{0, 0, 0, 1}));
  for (const double angle : {0.1, 1.5, 3.1, 3.2, 4.0, 6.0})
    EXPECT_GE(quaternion(rotation_about({0, angle, 0}))[3], 0) << angle;
  expect_near(pose_of({}, {0, 0, 4, 4}), rotation_about({0, 0, kPi / 2}));  // of any length
}

TEST(Pose, KnowsItsAngleAndAxis) {
  expect_near(rotation_vector(rotation_about({0.3, -1.1, 0.7})), {0.3, -1.1, 0.7});
  EXPECT_NEAR(angle_of(rotation_about({0, 2, 0})), 2, 1e-12);
  EXPECT_NEAR(angle_of(rotation_about({0, 4, 0})), 2 * kPi - 4, 1e-12) << "the shorter way";
  EXPECT_NEAR(angle_of(rotation_about({kPi, 0, 0})), kPi, 1e-7);
  EXPECT_EQ(angle_of(Pose{}), 0);
}

TEST(Pose, TurnsACovarianceWithIt) {
  const Covariance3 along_x{4, 0, 0, 0, 1, 0, 0, 0, 0.25};
  const Covariance3 turned = rotated(rotation_about({0, 0, kPi / 2}), along_x);
  const Covariance3 expected{1, 0, 0, 0, 4, 0, 0, 0, 0.25};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(turned[k], expected[k], 1e-12) << k;
}

TEST(Stamp, IsOrderedAndCountsSeconds) {
  EXPECT_LT(Stamp{1}, Stamp{2});
  EXPECT_DOUBLE_EQ(seconds_between({1'000'000'000}, {3'500'000'000}), 2.5);
  EXPECT_DOUBLE_EQ(seconds_between({3'500'000'000}, {1'000'000'000}), -2.5);
}

}  // namespace
}  // namespace cairn
