// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/input/laser_scans.hpp>
#include <cmath>
#include <limits>

#include <cairn/sequence/follower.hpp>
#include "support/samples.hpp"
#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

using support::refusal;
using support::TemporaryFolder;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Z = 100 · 0.1 / 5 = 2 m.
constexpr StereoRig kRig{.focal_px = 100, .cx_px = 20, .cy_px = 10, .baseline_m = 0.1F, .doffs_px = 0};
constexpr Size kSize{40, 20};

Reliability last_of(const samples::Sample& sample, const StereoPair& pair, int frames = 3) {
  FollowConfig config;
  config.segmentation = sample.suited();
  Follower follower(config, sample.calibration.rig);
  TrackedFrame step;
  for (int k = 0; k < frames; ++k) step = follower.next(pair, {k * std::int64_t{100'000'000}});
  return step.reliability;
}

TEST(Reliability, AGoodPairOfAStaticCameraIsReliable) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Reliability judged = last_of(sample, sample.pair());
  ASSERT_TRUE(judged.value);
  EXPECT_GT(*judged.value, 0.8F);
  EXPECT_GT(judged.witnesses.stereo.value(), 0.8F);
  EXPECT_GT(judged.witnesses.temporal.value(), 0.95F);
  EXPECT_GT(judged.witnesses.floor.value(), 0.95F);
  EXPECT_GT(judged.witnesses.odometry.value(), 0.9F);
  EXPECT_FALSE(judged.witnesses.scan);
  EXPECT_FALSE(judged.is_unreliable);
  EXPECT_GT(judged.steadiness, 0.5F);
}

TEST(Reliability, ABlackRightImageIsDetectedAndReportedAfterTenFrames) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Image<Gray> black(sample.pair().size(), Gray{0}, {});
  const StereoPair pair = StereoPair::from(sample.images.left.gray, black);
  const Reliability ninth = last_of(sample, pair, 9);
  ASSERT_TRUE(ninth.value);
  EXPECT_LT(*ninth.value, kUnreliable);
  EXPECT_FALSE(ninth.is_unreliable);
  EXPECT_LT(ninth.witnesses.photometric.value(), 0.5F);
  EXPECT_TRUE(last_of(sample, pair, 10).is_unreliable);
}

TEST(Reliability, ARightImageOfAnotherMomentLowersThePhotometricWitness) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Image<Gray> moved(sample.pair().size(), Gray{0}, {});
  for (int y = 0; y < moved.height(); ++y) {
    for (int x = 0; x < moved.width(); ++x) {
      moved(x, y) =
          sample.images.right.gray(std::min(x + 3, moved.width() - 1), std::min(y + 12, moved.height() - 1));
    }
  }
  const Reliability good = last_of(sample, sample.pair());
  const Reliability bad = last_of(sample, StereoPair::from(sample.images.left.gray, moved));
  EXPECT_LT(bad.witnesses.stereo.value(), good.witnesses.stereo.value() - 0.2F);
  EXPECT_LT(bad.witnesses.photometric.value(), good.witnesses.photometric.value() - 0.1F);
}

/// A step with one object of 10×10 px, 2 m away, and its track.
struct OneObject {
  TrackedFrame step;
  MaskPrediction warped{{}, Image<TrackId>(kSize, TrackId::none, {}), Image<float>(kSize, kNan, {})};

  explicit OneObject(int expected_at = 5) {
    step.index = 5;
    Frame& frame = step.frame;
    frame.disparity = {Image<float>(kSize, 5.0F, {}), Image<Reject>(kSize, Reject::none, {})};
    frame.objects.labels = Image<ObjectId>(kSize, ObjectId::none, {});
    Object object;
    object.id = ObjectId{1};
    object.confidence = 0.8F;
    object.box_px = {5, 5, 10, 10};
    object.pixel_count = 100;
    frame.objects.list.push_back(object);
    Track track;
    track.id = TrackId{1};
    track.confidence = 0.8F;
    track.recent = 0b11;
    track.object = ObjectId{1};
    step.tracks.list.push_back(track);
    warped.masks.push_back({TrackId{1}, 1, 100});
    for (int y = 5; y < 15; ++y) {
      for (int x = 0; x < 10; ++x) {
        frame.objects.labels(x + 5, y) = ObjectId{1};
        warped.ids(x + expected_at, y) = TrackId{1};
      }
    }
    step.motion.refusal = MotionRefusal::none;
    step.motion.inlier_share = 0.9F;
    step.map_from_camera = {{0, 0, 1, -1, 0, 0, 0, -1, 0}, {}};
  }
  [[nodiscard]] Reliability judged(const Reliability& before = {}, const LaserScan* scan = nullptr,
                                   bool looks_for_floor = false) const {
    const Image<Gray> none(kSize, Gray{0}, {});
    return assess_reliability(step, warped, {none, none, {}, kRig, looks_for_floor, scan}, before);
  }
};

TEST(TemporalWitness, IsTheOverlapOfExpectedAndFoundObjects) {
  EXPECT_NEAR(OneObject(5).judged().witnesses.temporal.value(), 1, 1e-6);
  EXPECT_NEAR(OneObject(10).judged().witnesses.temporal.value(), 5.0 / 15, 1e-6);
  EXPECT_NEAR(OneObject(20).judged().witnesses.temporal.value(), 0, 1e-6);
}

TEST(TemporalWitness, AnUnexpectedObjectHalvesIt) {
  OneObject one;
  Object second = one.step.frame.objects.list[0];
  second.id = ObjectId{2};
  one.step.frame.objects.list.push_back(second);
  Track new_track = one.step.tracks.list[0];
  new_track.id = TrackId{2};
  new_track.object = ObjectId{2};
  new_track.recent = 1;
  one.step.tracks.list.push_back(new_track);
  for (int y = 5; y < 15; ++y)
    for (int x = 25; x < 35; ++x) one.step.frame.objects.labels(x, y) = ObjectId{2};
  EXPECT_NEAR(one.judged().witnesses.temporal.value(), 0.5, 1e-6);
}

TEST(TemporalWitness, AnUnseenTrackIsNotExpected) {
  OneObject one;
  one.step.tracks.list[0].recent = 0b101;
  EXPECT_NEAR(one.judged().witnesses.temporal.value(), 0, 1e-6);  // the object is unexpected
  one.step.tracks.list[0].object = ObjectId::none;
  one.step.frame.objects.list.clear();
  one.step.frame.objects.labels = Image<ObjectId>(kSize, ObjectId::none, {});
  EXPECT_FALSE(one.judged().witnesses.temporal);  // nothing seen, nothing expected
}

TEST(OdometryWitness, IsTheInlierShareAndZeroIfTheMotionWasRefused) {
  OneObject one;
  EXPECT_FLOAT_EQ(one.judged().witnesses.odometry.value(), 0.9F);
  one.step.motion.refusal = MotionRefusal::disagrees_with_prior;
  EXPECT_EQ(one.judged().witnesses.odometry.value(), 0);
  EXPECT_EQ(one.judged().weakest, "odometry");
  one.step.motion.refusal = MotionRefusal::off;
  EXPECT_FALSE(one.judged().witnesses.odometry);
}

TEST(FloorWitness, FallsIfTheFloorIsMissingOrTilted) {
  OneObject one;
  EXPECT_FALSE(one.judged({}, nullptr, true).witnesses.floor);  // there may be none
  // Level camera 1 m over the floor: d = f·B·(v/f)/h = B·(y − cy)/h.
  one.step.frame.ground.plane = GroundPlane{0, 0.1F, -1};
  one.step.frame.ground.support = 0.8F;
  const Reliability first = one.judged({}, nullptr, true);
  EXPECT_NEAR(first.witnesses.floor.value(), 1, 1e-6);
  EXPECT_NEAR(one.judged(first, nullptr, true).witnesses.floor.value(), 1, 1e-4);
  one.step.frame.ground.plane = GroundPlane{0, 0.1F, -0.4F};  // 3.4 degrees
  EXPECT_LT(one.judged(first, nullptr, true).witnesses.floor.value(), 0.7F);
  one.step.frame.ground.plane.reset();
  const Reliability hidden = one.judged(first, nullptr, true);
  EXPECT_EQ(hidden.witnesses.floor.value(), 0);
  EXPECT_EQ(one.judged(hidden, nullptr, true).witnesses.floor.value(), 0);  // it is still expected
}

TEST(ScanWitness, IsTheShareOfBeamsThatTheDisparitiesConfirm) {
  OneObject one;
  LaserScan scan{{}, -0.1, 0.01, {}, {}};
  for (int i = 0; i <= 20; ++i) scan.ranges_m.push_back(static_cast<float>(2 / std::cos(-0.1 + 0.01 * i)));
  EXPECT_NEAR(one.judged({}, &scan).witnesses.scan.value(), 1, 1e-6);
  for (std::size_t i = 0; i < 21; i += 2) scan.ranges_m[i] = 0.5F;  // 20 px
  EXPECT_NEAR(one.judged({}, &scan).witnesses.scan.value(), 10.0 / 21, 1e-6);
  scan.ranges_m.resize(5);
  EXPECT_FALSE(one.judged({}, &scan).witnesses.scan);  // too few beams
}

TEST(Reliability, OneWitnessNearZeroIsDecisive) {
  Reliability before;
  before.weak_frames = kUnreliableFrames - 1;
  OneObject one;
  one.step.motion.refusal = MotionRefusal::few_inliers;
  const Reliability judged = one.judged(before);
  EXPECT_NEAR(judged.value.value(), std::sqrt(0.01), 1e-5);
  EXPECT_TRUE(judged.is_unreliable);
  one.step.motion.refusal = MotionRefusal::none;
  EXPECT_EQ(one.judged(judged).weak_frames, 0);
}

TEST(SteadinessOfObjects, ALargePlaneDoesNotCountButABulgeDoes) {
  OneObject one;  // a plane, 100 of 800 px
  one.step.tracks.list[0].state = TrackState::confirmed;
  EXPECT_EQ(steadiness(one.step, 1), 0);
  for (int y = 5; y < 15; ++y) {
    for (int x = 5; x < 15; ++x)
      one.step.frame.disparity.disparity_px(x, y) = 10 - 0.2F * static_cast<float>((x - 10) * (x - 10));
  }
  EXPECT_FLOAT_EQ(steadiness(one.step, 0.5F), 0.4F);
  one.step.tracks.list[0].state = TrackState::tentative;
  EXPECT_EQ(steadiness(one.step, 0.5F), 0);
}

TEST(LaserScans, AreReadWithTheirMounting) {
  const TemporaryFolder folder;
  const auto path =
      folder.with("scan.csv",
                  "# laser_in_level_camera_m: 0 0.75 -0.1\n"
                  "t_s,angle_min,angle_increment,r0,r1,r2\n0.1,-0.5,0.5,1.5,inf,\n0.2,-0.5,0.5,1,2,3\n");
  const std::vector<LaserScan> scans = input::load_scans(path);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].stamp.ns, 100'000'000);
  EXPECT_EQ(scans[0].in_level_camera_m, (Point3{0, 0.75, -0.1}));
  EXPECT_FLOAT_EQ(scans[0].ranges_m[0], 1.5F);
  EXPECT_TRUE(std::isnan(scans[0].ranges_m[1]));
  EXPECT_TRUE(std::isnan(scans[0].ranges_m[2]));
  EXPECT_EQ(input::scan_at(scans, {120'000'000}), scans.data());
  EXPECT_EQ(input::scan_at(scans, {160'000'000}), &scans[1]);
  EXPECT_EQ(input::scan_at(scans, {40'000'000}), nullptr);
}

TEST(LaserScans, EachRefusalHasAReason) {
  const TemporaryFolder folder;
  const std::string head = "t_s,angle_min,angle_increment,r0,r1\n";
  const auto refused = [&](const std::string& text) {
    return refusal([&] { input::load_scans(folder.with("scan.csv", text)); });
  };
  EXPECT_NE(refused("").find("expected a first line stamp,angle_min"), std::string::npos);
  EXPECT_NE(refused("a,b\n").find("found 'a,b'"), std::string::npos);
  EXPECT_NE(refused(head).find("has no scan"), std::string::npos);
  EXPECT_NE(refused(head + "0,0,0.1\n").find(":2: has 3 fields"), std::string::npos);
  EXPECT_NE(refused(head + "0,0,0.1,x,1\n").find("found 'x', expected a number"), std::string::npos);
  EXPECT_NE(refused(head + "0,-90,10,1,1\n").find("are they degrees"), std::string::npos);
  EXPECT_NE(refused(head + "0.2,0,0.1,1,1\n0.1,0,0.1,1,1\n").find("stamp"), std::string::npos);
  EXPECT_NE(refused("# laser_in_level_camera_m: 1\n" + head + "0,0,0.1,1,1\n").find("has 1 numbers"),
            std::string::npos);
}

}  // namespace
}  // namespace cairn
