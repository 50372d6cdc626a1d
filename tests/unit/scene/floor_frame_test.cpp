// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/scene/floor_frame.hpp>
#include <cmath>
#include <numbers>

namespace cairn {
namespace {

constexpr StereoRig kRig{.focal_px = 300, .cx_px = 160, .cy_px = 120, .baseline_m = 0.1F, .doffs_px = 3};

float radians(float degrees) {
  return degrees * std::numbers::pi_v<float> / 180;
}

GroundPlane from_pose(float height_m, float pitch_deg, float roll_deg) {
  GroundConfig config;
  config.source = GroundSource::pose;
  config.known.camera_height_m = height_m;
  config.known.camera_pitch_deg = pitch_deg;
  config.known.camera_roll_deg = roll_deg;
  const Image<float> disparity_px({4, 4}, 1.0F, {});
  return *fit_ground(disparity_px.view(), kRig, config, {}).plane;
}

void expect_near(Vec3 found, Vec3 expected) {
  EXPECT_NEAR(found.x, expected.x, 1e-5);
  EXPECT_NEAR(found.y, expected.y, 1e-5);
  EXPECT_NEAR(found.z, expected.z, 1e-5);
}

TEST(FloorFrame, RecoversThePoseOfThePlane) {
  for (const float pitch : {-10.0F, 0.0F, 30.0F, 85.0F}) {
    for (const float roll : {-8.0F, 0.0F, 12.0F}) {
      const auto frame = floor_frame(from_pose(1.2F, pitch, roll), kRig);
      ASSERT_TRUE(frame);
      EXPECT_NEAR(frame->camera_height_m, 1.2, 1e-4);
      EXPECT_NEAR(frame->pitch_rad(), radians(pitch), 1e-4);
      EXPECT_NEAR(frame->roll_rad(), radians(roll), 1e-3);
    }
  }
}

TEST(FloorFrame, OfALevelCameraIsTurnedAndLifted) {
  const auto frame = floor_frame(from_pose(0.5F, 0, 0), kRig);
  ASSERT_TRUE(frame);
  expect_near(frame->to_floor({0, 0, 0}), {0, 0, 0.5F});
  expect_near(frame->to_floor({0.2F, 0.5F, 3}), {3, -0.2F, 0});  // on the floor, to the right of the middle
}

TEST(FloorFrame, PutsPointsOfThePlaneOnTheFloor) {
  const GroundPlane plane = from_pose(0.9F, 20, 5);
  const auto frame = floor_frame(plane, kRig);
  ASSERT_TRUE(frame);
  for (const float x : {0.0F, 310.0F}) {
    const auto point = kRig.point_in_camera_m(x, 200, plane.disparity_px(x, 200));
    ASSERT_TRUE(point);
    EXPECT_NEAR(frame->to_floor(*point).z, 0, 1e-4);
    EXPECT_GT(frame->to_floor(*point).x, 0);
  }
}

TEST(FloorFrame, RoundTripsPoints) {
  const auto frame = floor_frame(from_pose(0.9F, 20, 5), kRig);
  ASSERT_TRUE(frame);
  const Vec3 point{0.3F, -0.4F, 2};
  expect_near(frame->to_camera(frame->to_floor(point)), point);
  const auto m = frame->floor_from_camera();
  const Vec3 by_matrix{m[0] * point.x + m[1] * point.y + m[2] * point.z + m[3],
                       m[4] * point.x + m[5] * point.y + m[6] * point.z + m[7],
                       m[8] * point.x + m[9] * point.y + m[10] * point.z + m[11]};
  expect_near(by_matrix, frame->to_floor(point));
}

TEST(FloorFrame, OfADownwardCameraHasTheImagesTopInFront) {
  // d + doffs = 0.1 · 300 / 2 everywhere.
  const auto frame = floor_frame({0, 0.001F, 12}, kRig);
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->camera_height_m, 2, 0.05);
  const Vec3 above_the_middle = frame->to_floor({0, -0.5F, 2});
  EXPECT_NEAR(above_the_middle.x, 0.5, 0.05);
}

TEST(FloorFrame, IsUndefinedForAPlaneAboveTheCamera) {
  EXPECT_FALSE(floor_frame({0, -0.1F, 20}, kRig));
  EXPECT_FALSE(floor_frame({0, 0, 5}, kRig));
}

}  // namespace
}  // namespace cairn
