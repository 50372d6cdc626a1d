// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/sequence/odometry.hpp>
#include <cairn/sequence/trajectory_error.hpp>
#include <cmath>
#include <numbers>
#include <opencv2/core/utility.hpp>
#include <support/textured_room.hpp>

namespace cairn {
namespace {

using room::look;
using room::Seen;

constexpr double kDegrees = std::numbers::pi / 180;

/// Rotated about the vertical and translated, in the axes of the camera (x right, y down, z forward).
Pose at(double x_m, double z_m, double right_deg) {
  Pose pose = rotation_about({0, right_deg * kDegrees, 0});
  pose.translation_m = {x_m, 0, z_m};
  return pose;
}

double metres_apart(const Pose& a, const Pose& b) {
  return length(a.translation_m - b.translation_m);
}
double degrees_apart(const Pose& a, const Pose& b) {
  return angle_of(inverse(a) * b) / kDegrees;
}

OdometryStep step(const OdometryState& state, const Seen& seen,
                  const std::optional<MotionPrior>& prior = std::nullopt, const OdometryConfig& config = {}) {
  return advance_odometry(state, {seen.left, seen.disparity, {}, {}}, room::kRig, prior, config);
}

Seen all_of(Gray value) {
  Seen seen = look({});
  seen.left.fill(value);
  seen.disparity.disparity_px.fill(std::numeric_limits<float>::quiet_NaN());
  seen.disparity.reject.fill(Reject::no_data);
  return seen;
}

MotionPrior wheels(const Pose& now_from_before, double sigma_m = 0.005, double sigma_deg = 0.3) {
  MotionPrior prior{PriorKind::wheels, now_from_before, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    prior.covariance[7 * k] = sigma_m * sigma_m;
    prior.covariance[7 * (k + 3)] = sigma_deg * sigma_deg * kDegrees * kDegrees;
  }
  return prior;
}

double sum_of_diagonal(const Covariance6& covariance) {
  double sum = 0;
  for (std::size_t k = 0; k < 6; ++k) sum += covariance[7 * k];
  return sum;
}

TEST(Odometry, RecoversAKnownMotion) {
  Pose truth = at(0, 0, 0);
  OdometryState state = step(begin_odometry(truth), look(truth)).state;
  std::vector<double> errors;
  for (int k = 1; k <= 15; ++k) {
    truth = at(0.01 * k, 0.04 * k, 1.5 * k);
    const OdometryStep moved = step(state, look(truth));
    ASSERT_EQ(moved.motion.refusal, MotionRefusal::none) << k;
    EXPECT_LT(metres_apart(moved.state.map_from_camera, truth), 0.01) << k;
    EXPECT_LT(degrees_apart(moved.state.map_from_camera, truth), 0.2) << k;
    const Pose in_steps = moved.state.map_from_camera * moved.motion.now_from_before;
    EXPECT_LT(metres_apart(in_steps, state.map_from_camera), 1e-9);
    state = moved.state;
  }
  EXPECT_GT(sum_of_diagonal(state.covariance), 0);
}

TEST(Odometry, BeginsAtTheGivenPose) {
  Pose map_from_camera = rotation_about({-std::numbers::pi / 2, 0, 0});  // z of the map is up
  map_from_camera.translation_m = {3, -2, 0.8};
  OdometryState state = step(begin_odometry(map_from_camera), look({})).state;
  EXPECT_EQ(state.map_from_camera.translation_m, map_from_camera.translation_m);
  const OdometryStep moved = step(state, look(at(0, 0.1, 0)));
  // Forward for the camera is y of this map.
  EXPECT_LT(length(moved.state.map_from_camera.translation_m - Point3{3, -1.9, 0.8}), 0.005);
}

TEST(Odometry, FindsASuddenTurn) {
  const OdometryState state = step(begin_odometry({}), look({})).state;
  for (const double degrees : {-14.0, -9.0, 9.0, 14.0}) {
    const Pose truth = at(0.03, 0.05, degrees);
    const OdometryStep moved = step(state, look(truth));
    ASSERT_EQ(moved.motion.refusal, MotionRefusal::none) << degrees;
    EXPECT_LT(degrees_apart(moved.state.map_from_camera, truth), 0.2) << degrees;
    EXPECT_LT(metres_apart(moved.state.map_from_camera, truth), 0.02) << degrees;
  }
}

TEST(Odometry, IgnoresMovingObjects) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  int outliers = 0;
  for (int k = 1; k <= 5; ++k) {
    const Pose truth = at(0, 0.02 * k, 0);
    const OdometryStep moved = step(state, look(truth, 0.02 * k));
    ASSERT_EQ(moved.motion.refusal, MotionRefusal::none);
    EXPECT_LT(metres_apart(moved.state.map_from_camera, truth), 0.01) << k;
    outliers = std::max(outliers, moved.motion.followed - moved.motion.inliers);
    state = moved.state;
  }
  EXPECT_GT(outliers, 10) << "the panel's corners were followed, and went elsewhere";
}

TEST(Odometry, SpreadsItsCornersInALargeImage) {
  // Texture in a patch alone, where 300 corners 8 px apart would have room.
  constexpr Size kLarge{640, 480};
  Seen seen{Image<Gray>(kLarge, Gray{90}, {}),
            {Image<float>(kLarge, 20.0F, {}), Image<Reject>(kLarge, Reject::none, {})}};
  for (int y = 180; y < 300; ++y) {
    for (int x = 240; x < 400; ++x) seen.left(x, y) = static_cast<Gray>(255 * room::hashed(x / 3, y / 3));
  }
  const OdometryState state = step(begin_odometry({}), seen).state;
  const int corners = step(state, seen).motion.followed;
  EXPECT_GE(corners, 40);
  EXPECT_LE(corners, 100) << "16 px apart: one for each 256 px of 160x120, more at the border";
}

TEST(Odometry, UsesNoCornersOfMovingObjects) {
  const Seen first = look({});
  Image<std::uint8_t> moving(room::kSize);
  moving.fill(255);
  const OdometryStep none =
      advance_odometry(begin_odometry({}), {first.left, first.disparity, {}, moving}, room::kRig, {}, {});
  EXPECT_EQ(none.motion.refusal, MotionRefusal::few_points);
  EXPECT_FALSE(none.motion.is_new_keyframe);
}

TEST(Odometry, UsesNoCornersOfUncertainDisparity) {
  const Seen first = look({});
  Image<float> confidence(room::kSize);
  confidence.fill(0.1F);
  EXPECT_EQ(
      advance_odometry(begin_odometry({}), {first.left, first.disparity, confidence, {}}, room::kRig, {}, {})
          .motion.refusal,
      MotionRefusal::few_points);
  confidence.fill(0.9F);
  EXPECT_EQ(
      advance_odometry(begin_odometry({}), {first.left, first.disparity, confidence, {}}, room::kRig, {}, {})
          .motion.refusal,
      MotionRefusal::none);
}

TEST(Odometry, ReportsWhyAFrameHasNoMotion) {
  const OdometryState state = step(begin_odometry({}), look({})).state;
  EXPECT_EQ(step(state, all_of(0)).motion.refusal, MotionRefusal::few_points);
  EXPECT_EQ(step(state, all_of(255)).motion.refusal, MotionRefusal::few_points);

  OdometryConfig off;
  off.method = OdometryMethod::off;
  EXPECT_EQ(step(state, look({}), {}, off).motion.refusal, MotionRefusal::off);

  const Seen seen = look({});
  EXPECT_EQ(advance_odometry(state, {seen.left, seen.disparity, {}, {}}, StereoRig{}, {}, {}).motion.refusal,
            MotionRefusal::no_rig);

  OdometryConfig strict;
  strict.min_inliers = 200;
  strict.min_distance = 4;
  const OdometryState dense = step(begin_odometry({}), look({}), {}, strict).state;
  ASSERT_TRUE(dense.key.frame);
  EXPECT_EQ(step(dense, look(at(0.6, 0, 25)), {}, strict).motion.refusal, MotionRefusal::few_points);
}

TEST(Odometry, RefusesNoiseATornImageAndABadStamp) {
  const OdometryState state = step(begin_odometry({}), look({})).state;
  Seen noise = look({});
  for (int y = 0; y < room::kSize.height; ++y) {
    for (int x = 0; x < room::kSize.width; ++x)
      noise.left(x, y) = static_cast<Gray>(255 * room::hashed(x + 1000, y));
  }
  const MotionRefusal refusal = step(state, noise).motion.refusal;
  EXPECT_TRUE(refusal == MotionRefusal::few_points || refusal == MotionRefusal::few_inliers);

  Seen torn = look({});
  const Seen other = look(at(0.8, 0.5, 40));
  for (int y = 60; y < room::kSize.height; ++y) {
    for (int x = 0; x < room::kSize.width; ++x) {
      torn.left(x, y) = other.left(x, y);
      torn.disparity.disparity_px(x, y) = other.disparity.disparity_px(x, y);
    }
  }
  const OdometryStep after = step(state, torn);
  if (after.motion.refusal == MotionRefusal::none) {
    EXPECT_LT(metres_apart(after.state.map_from_camera, {}), 0.05);
  }

  Image<Gray> stamp(Size{8, 8});
  stamp.fill(7);
  DisparityMap map{Image<float>(Size{8, 8}), Image<Reject>(Size{8, 8})};
  map.disparity_px.fill(3);
  map.reject.fill(Reject::none);
  EXPECT_EQ(advance_odometry(state, {stamp, map, {}, {}}, room::kRig, {}, {}).motion.refusal,
            MotionRefusal::few_points);
  EXPECT_EQ(advance_odometry(begin_odometry({}), {stamp, map, {}, {}}, room::kRig, {}, {}).motion.refusal,
            MotionRefusal::few_points);
  EXPECT_EQ(advance_odometry(state, {{}, {}, {}, {}}, room::kRig, {}, {}).motion.refusal,
            MotionRefusal::few_points);
}

TEST(Odometry, RejectsATranslationFromFarPointsOnly) {
  constexpr double kHall = 12;  // the nearest wall is more than 40 baselines away
  const OdometryState state = step(begin_odometry({}), look({}, 0, kHall)).state;
  const OdometryStep moved = step(state, look(at(0, 0, 2), 0, kHall));
  EXPECT_EQ(moved.motion.refusal, MotionRefusal::degenerate);
}

TEST(Odometry, ExtrapolatesOverBlankFramesAndIsLostAfterFive) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  state = step(state, look(at(0, 0.03, 0))).state;
  double before = sum_of_diagonal(state.covariance);
  for (int k = 1; k <= 5; ++k) {
    const OdometryStep dark = step(state, all_of(0));
    EXPECT_EQ(dark.motion.refusal, MotionRefusal::few_points);
    EXPECT_FALSE(dark.state.lost) << k;
    EXPECT_NEAR(dark.state.map_from_camera.translation_m.z, 0.03 * (k + 1), 0.02) << k;
    EXPECT_GT(sum_of_diagonal(dark.state.covariance), before);
    before = sum_of_diagonal(dark.state.covariance);
    state = dark.state;
  }
  state = step(state, all_of(0)).state;
  EXPECT_TRUE(state.lost);
  const Pose truth = at(0.02, 0.05, 1);
  const OdometryStep found = step(state, look(truth));
  EXPECT_EQ(found.motion.refusal, MotionRefusal::none) << "the keyframe is seen again";
  EXPECT_FALSE(found.state.lost);
  EXPECT_LT(metres_apart(found.state.map_from_camera, truth), 0.01);
}

TEST(Odometry, KeepsItsKeyframeThroughADarkFrame) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  state = step(state, look(at(0, 0.03, 0))).state;
  state = step(state, all_of(0)).state;
  const Pose truth = at(0, 0.09, 2);
  const OdometryStep after = step(state, look(truth));
  EXPECT_EQ(after.motion.refusal, MotionRefusal::none);
  EXPECT_FALSE(after.motion.is_new_segment);
  EXPECT_LT(after.state.covariance[0], 0.01);
  EXPECT_LT(metres_apart(after.state.map_from_camera, truth), 0.01);
}

TEST(Odometry, DoesNotExtrapolateOverAGap) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  state = step(state, look(at(0, 0.03, 0))).state;
  const OdometryStep found = step(after_gap(state), look(at(0, 0.04, 0)));
  EXPECT_EQ(found.motion.refusal, MotionRefusal::none);
  EXPECT_LT(found.state.covariance[0], 0.01) << "the keyframe is seen again";
  EXPECT_FALSE(found.state.is_after_gap);

  const OdometryStep dark = step(after_gap(state), all_of(0));
  EXPECT_EQ(dark.motion.now_from_before.translation_m, Point3{}) << "it does not go on as before";
  EXPECT_GE(dark.state.covariance[0], 1);
  EXPECT_GE(dark.state.covariance[35], 900 * kDegrees * kDegrees);
  EXPECT_LT(step(state, all_of(0)).state.covariance[0], 0.1) << "without a gap";

  const Pose one = at(0, 0.05, 3);
  EXPECT_LT(step(after_gap(state), all_of(0), wheels(inverse(one))).state.covariance[0], 0.01)
      << "wheels go on through a gap";
}

TEST(Odometry, BeginsANewSegmentIfItSeesAnotherPlaceWhileLost) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  for (int k = 0; k < 8; ++k) state = step(state, all_of(0)).state;
  ASSERT_TRUE(state.lost);
  const Pose last_known = state.map_from_camera;
  const Pose elsewhere = at(0, 0, 180);
  for (int k = 0; k < 2; ++k) {
    const OdometryStep waiting = step(state, look(elsewhere * at(0, 0.02 * k, 0)));
    EXPECT_TRUE(waiting.state.lost) << k;
    EXPECT_FALSE(waiting.motion.is_new_segment) << k;
    state = waiting.state;
  }
  const OdometryStep begun = step(state, look(elsewhere * at(0, 0.04, 0)));
  EXPECT_EQ(begun.motion.refusal, MotionRefusal::none);
  EXPECT_FALSE(begun.state.lost);
  EXPECT_TRUE(begun.motion.is_new_segment);
  EXPECT_GE(begun.state.covariance[0], 1);
  EXPECT_GE(begun.state.covariance[35], 900 * kDegrees * kDegrees);
  EXPECT_LT(metres_apart(begun.state.map_from_camera, last_known), 0.1);

  const OdometryStep on = step(begun.state, look(elsewhere * at(0, 0.06, 0)));
  EXPECT_EQ(on.motion.refusal, MotionRefusal::none);
  EXPECT_FALSE(on.motion.is_new_segment) << "once";
  EXPECT_GE(on.state.covariance[0], 1);
}

TEST(Odometry, LinksEachKeyframeToThePreviousOne) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  bool has_changed = false;
  for (int k = 1; k <= 12; ++k) {
    const OdometryStep next = step(state, look(at(0, 0.02 * k, 3 * k)));
    ASSERT_EQ(next.motion.refusal, MotionRefusal::none);
    const double moved = sum_of_diagonal(next.motion.covariance);
    has_changed |= next.motion.is_new_keyframe;
    EXPECT_NEAR(sum_of_diagonal(next.state.key_covariance), next.motion.is_new_keyframe ? moved : 0, 1e-12);
    EXPECT_NEAR(sum_of_diagonal(covariance_since_key(next.state)), next.motion.is_new_keyframe ? 0 : moved,
                1e-12);
    state = next.state;
  }
  EXPECT_TRUE(has_changed);
}

TEST(Odometry, WithAFloorANewSegmentIsUncertainInPositionAndHeadingOnly) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  for (int k = 0; k < 8; ++k) state = step(state, all_of(0)).state;
  OdometryStep begun;
  for (int k = 0; k < 3; ++k) {
    begun = step(state, look(at(0, 0.02 * k, 180)));
    state = begun.state;
  }
  ASSERT_TRUE(begun.motion.is_new_segment);
  EXPECT_GE(state.key_covariance[0], 1);
  EXPECT_GE(state.key_covariance[35], 900 * kDegrees * kDegrees);
  Pose level = state.map_from_camera;
  level.translation_m.z = 0.8;
  const OdometryState stood = stood_on_floor(state, level);
  EXPECT_EQ(stood.map_from_camera.translation_m, level.translation_m);
  EXPECT_LT(metres_apart(stood.key.map_from_key, level), 1e-9);
  for (const std::size_t k : {2U, 3U, 4U}) EXPECT_LT(stood.covariance[7 * k], 0.01) << k;
  for (const std::size_t k : {0U, 1U}) EXPECT_GE(stood.covariance[7 * k], 1) << k;
  EXPECT_GE(stood.covariance[35], 900 * kDegrees * kDegrees);
  const OdometryStep on = step(stood, look(at(0, 0.06, 180)));
  EXPECT_EQ(on.motion.refusal, MotionRefusal::none);
  EXPECT_NEAR(on.state.map_from_camera.translation_m.z, 0.8, 0.05);
}

TEST(Odometry, StaysLostWhileFramesHaveNothingInCommon) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  for (int k = 0; k < 20; ++k) {
    const OdometryStep shown = step(state, k < 8 ? all_of(0) : look(at(0, 0, 120 * (k % 3) + 60)));
    EXPECT_FALSE(shown.motion.is_new_segment) << k;
    state = shown.state;
  }
  EXPECT_TRUE(state.lost);
}

TEST(Odometry, AJumpBeginsANewSegmentOfUncertainPosition) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  state = step(state, look(at(0, 0.03, 0))).state;
  const Pose elsewhere = at(0, 0, 180);
  const OdometryStep jumped = step(state, look(elsewhere));
  ASSERT_NE(jumped.motion.refusal, MotionRefusal::none);
  const OdometryStep after = step(jumped.state, look(elsewhere * at(0, 0.02, 0)));
  EXPECT_EQ(after.motion.refusal, MotionRefusal::none);
  EXPECT_TRUE(after.motion.is_new_segment);
  EXPECT_GE(after.state.covariance[0], 1);

  const Pose half = at(0, 0.01, 90);  // according to the wheels
  const OdometryStep driven = step(state, look(elsewhere), wheels(half));
  ASSERT_NE(driven.motion.refusal, MotionRefusal::none);
  const OdometryStep on = step(driven.state, look(elsewhere * at(0, 0.02, 0)));
  EXPECT_EQ(on.motion.refusal, MotionRefusal::none);
  EXPECT_FALSE(on.motion.is_new_segment) << "wheels tie the two together";
  EXPECT_LT(on.state.covariance[0], 0.1);
}

TEST(Odometry, UsesTheWheelsInTheDark) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  const Pose one = at(0, 0.05, 3);
  Pose truth;
  for (int k = 0; k < 10; ++k) {
    truth = truth * one;
    const OdometryStep dark = step(state, all_of(0), wheels(inverse(one)));
    EXPECT_EQ(dark.motion.refusal, MotionRefusal::few_points);
    EXPECT_FALSE(dark.state.lost);
    EXPECT_LT(metres_apart(dark.state.map_from_camera, truth), 1e-9);
    state = dark.state;
  }
}

TEST(Odometry, AnAgreeingPriorReducesTheUncertainty) {
  const OdometryState state = step(begin_odometry({}), look({})).state;
  const Pose truth = at(0.01, 0.05, 2);
  const OdometryStep alone = step(state, look(truth));
  const OdometryStep helped = step(state, look(truth), wheels(inverse(truth), 0.001, 0.01));
  EXPECT_EQ(helped.motion.refusal, MotionRefusal::none);
  EXPECT_LT(sum_of_diagonal(helped.motion.covariance), sum_of_diagonal(alone.motion.covariance));
  EXPECT_LT(metres_apart(helped.state.map_from_camera, truth), 0.005);
}

TEST(Odometry, UsesThePriorIfTheTwoDisagree) {
  const OdometryState state = step(begin_odometry({}), look({})).state;
  const Pose said = at(0, 0.10, 0);
  const OdometryStep moved = step(state, look(at(0, 0.02, 0)), wheels(inverse(said)));
  EXPECT_EQ(moved.motion.refusal, MotionRefusal::disagrees_with_prior);
  EXPECT_LT(metres_apart(moved.state.map_from_camera, said), 1e-9);
  EXPECT_TRUE(moved.motion.is_new_keyframe) << "what comes is measured from where the wheels say";
}

TEST(Odometry, TrustsTheImagesIfTheWheelsSlip) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  const Pose said = at(0, 0.10, 0);
  std::vector<MotionRefusal> refusals;
  for (int k = 0; k < 6; ++k) {
    const OdometryStep moved = step(state, look({}), wheels(inverse(said)));
    refusals.push_back(moved.motion.refusal);
    state = moved.state;
  }
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(refusals[k], MotionRefusal::disagrees_with_prior);
  for (std::size_t k = 2; k < 6; ++k) EXPECT_EQ(refusals[k], MotionRefusal::none) << k;
  EXPECT_NEAR(state.map_from_camera.translation_m.z, 0.2, 0.01) << "it went on for two frames only";
}

TEST(Odometry, ContradictsWheelsWhoseTurnsAreMirrored) {
  OdometryState state = step(begin_odometry({}), look({})).state;
  Pose truth;
  for (int k = 0; k < 4; ++k) {
    truth = truth * at(0, 0.02, 3);
    const OdometryStep turned = step(state, look(truth), wheels(inverse(at(0, 0.02, -3))));
    EXPECT_EQ(turned.motion.refusal, MotionRefusal::disagrees_with_prior) << k;
    EXPECT_FALSE(turned.state.lost);
    state = turned.state;
  }
}

TEST(Odometry, LateWheelsDisagreeWhereTheRobotStartsAndStopsOnly) {
  constexpr int kLate = 2;  // frames; 0.2 s at 10 Hz
  const std::vector<double> driven_m{0, 0, 0.08, 0.08, 0.08, 0.08, 0.08, 0, 0, 0, 0};
  OdometryState state = step(begin_odometry({}), look({})).state;
  double z_m = 0;
  std::vector<MotionRefusal> refusals;
  for (std::size_t k = 0; k < driven_m.size(); ++k) {
    z_m += driven_m[k];
    const double said_m = k < kLate ? 0 : driven_m[k - kLate];
    const OdometryStep moved = step(state, look(at(0, z_m, 0)), wheels(inverse(at(0, said_m, 0))));
    refusals.push_back(moved.motion.refusal);
    state = moved.state;
  }
  for (std::size_t k = 0; k < driven_m.size(); ++k) {
    const bool is_right = k < kLate || driven_m[k] == driven_m[k - kLate];
    EXPECT_EQ(refusals[k], is_right ? MotionRefusal::none : MotionRefusal::disagrees_with_prior) << k;
  }
  EXPECT_FALSE(state.lost);
  EXPECT_NEAR(state.map_from_camera.translation_m.z, z_m, 0.01) << "what was missed came late";
}

TEST(Odometry, AJumpOfTheExposureLeadsNowhere) {
  for (const double gain : {0.5, 1.6}) {
    OdometryState state = step(begin_odometry({}), look({})).state;
    for (int k = 1; k <= 8; ++k) {
      const Pose truth = at(0, 0.02 * k, 0.5 * k);
      Seen seen = look(truth);
      for (int y = 0; k >= 4 && y < room::kSize.height; ++y) {
        for (int x = 0; x < room::kSize.width; ++x)
          seen.left(x, y) = static_cast<Gray>(std::clamp(gain * seen.left(x, y) + 10, 0.0, 255.0));
      }
      const OdometryStep moved = step(state, seen);
      EXPECT_LT(metres_apart(moved.state.map_from_camera, truth), 0.02) << gain << " " << k;
      EXPECT_FALSE(moved.motion.is_new_segment);
      state = moved.state;
    }
  }
}

TEST(Odometry, AGyroscopeProvidesRotationOnly) {
  const OdometryState state = step(begin_odometry({}), look({})).state;
  const Pose truth = at(0.02, 0.05, 8);
  MotionPrior turned = wheels(inverse(at(7, 7, 8)), 0, 0.05);  // its translation must not matter
  turned.kind = PriorKind::gyroscope;
  const OdometryStep moved = step(state, look(truth), turned);
  EXPECT_EQ(moved.motion.refusal, MotionRefusal::none);
  EXPECT_LT(metres_apart(moved.state.map_from_camera, truth), 0.01);

  MotionPrior alone = turned;
  alone.now_from_before.translation_m.x = alone.covariance[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(metres_apart(step(state, look(truth), alone).state.map_from_camera, moved.state.map_from_camera),
            0);

  MotionPrior wrong = turned;
  wrong.now_from_before.rotation = inverse(at(0, 0, 2)).rotation;
  EXPECT_EQ(step(state, look(truth), wrong).motion.refusal, MotionRefusal::disagrees_with_prior);

  MotionPrior broken = turned;
  broken.now_from_before.rotation[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(step(state, look(truth), broken).motion.refusal, MotionRefusal::none) << "as if there were none";
}

TEST(Odometry, MakesEachFrameAKeyframeOnRequest) {
  OdometryConfig config;
  config.method = OdometryMethod::frame;
  OdometryState state = step(begin_odometry({}), look({}), {}, config).state;
  for (int k = 1; k <= 3; ++k) {
    const OdometryStep moved = step(state, look(at(0, 0.01 * k, 0)), {}, config);
    EXPECT_TRUE(moved.motion.is_new_keyframe);
    state = moved.state;
  }
  state = step(begin_odometry({}), look({})).state;
  EXPECT_FALSE(step(state, look(at(0, 0.01, 0))).motion.is_new_keyframe);
  EXPECT_TRUE(step(state, look(at(0, 0.01, 21))).motion.is_new_keyframe);
}

std::vector<Pose> run_with(int threads) {
  const int before = cv::getNumThreads();
  cv::setNumThreads(threads);
  std::vector<Pose> poses;
  OdometryState state = step(begin_odometry({}), look({})).state;
  for (int k = 1; k <= 8; ++k) {
    state = step(state, look(at(0.02 * k, 0.03 * k, 4 * k), 0.03 * k)).state;
    poses.push_back(state.map_from_camera);
  }
  cv::setNumThreads(before);
  return poses;
}

TEST(Odometry, FollowsItsKeyframeWithAnotherWindowThanItWasMadeWith) {
  for (const auto& [before_px, after_px] : {std::pair{11, 31}, {31, 11}}) {
    OdometryConfig config;
    config.win_size = before_px;
    const OdometryState state = step(begin_odometry({}), look({}), std::nullopt, config).state;
    config.win_size = after_px;
    const Pose truth = at(0.01, 0.05, 1);
    const OdometryStep moved = step(state, look(truth), std::nullopt, config);
    ASSERT_EQ(moved.motion.refusal, MotionRefusal::none) << before_px;
    EXPECT_LT(metres_apart(moved.state.map_from_camera, truth), 0.01) << before_px;
  }
}

TEST(Odometry, IsReproducibleBitForBitForAnyNumberOfThreads) {
  const std::vector<Pose> once = run_with(1);
  for (const int threads : {1, 2, 4}) {
    const std::vector<Pose> again = run_with(threads);
    for (std::size_t k = 0; k < once.size(); ++k) {
      EXPECT_EQ(once[k].rotation, again[k].rotation) << threads << " threads, frame " << k;
      EXPECT_EQ(once[k].translation_m, again[k].translation_m) << threads << " threads, frame " << k;
    }
  }
}

}  // namespace
}  // namespace cairn
