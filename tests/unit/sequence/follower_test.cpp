// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>

#include <cairn/sequence/follower.hpp>
#include "support/samples.hpp"

namespace cairn {
namespace {

Stamp frame_stamp(int frame) {
  return {frame * std::int64_t{100'000'000}};
}

FollowConfig config_for(const samples::Sample& sample) {
  FollowConfig config;
  config.segmentation = sample.suited();
  return config;
}

std::string refused(Follower& follower, const StereoPair& pair, Stamp stamp) {
  try {
    follower.next(pair, stamp);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Follower, AStaticCameraGivesStaticObjectsStableIds) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  const TrackedFrame first = follower.next(sample.pair(), frame_stamp(1));
  ASSERT_GE(first.tracks.list.size(), 2U);
  EXPECT_EQ(first.index, 0);
  EXPECT_GT(first.map_from_camera.translation_m.z, 0.1);  // above the floor
  TrackedFrame last;
  for (int k = 2; k <= 6; ++k) last = follower.next(sample.pair(), frame_stamp(k));
  EXPECT_EQ(last.index, 5);
  ASSERT_EQ(last.tracks.list.size(), first.tracks.list.size());
  for (std::size_t i = 0; i < last.tracks.list.size(); ++i) {
    const Track& track = last.tracks.list[i];
    EXPECT_EQ(track.id, first.tracks.list[i].id);
    EXPECT_EQ(track.object, first.tracks.list[i].object);
    EXPECT_EQ(track.state, TrackState::confirmed);
    EXPECT_FALSE(track.is_moving);
  }
  // The id image agrees with the list.
  for (int y = 0; y < last.ids.height(); ++y) {
    for (int x = 0; x < last.ids.width(); ++x) {
      const ObjectId object = last.frame.objects.labels(x, y);
      const auto track = std::ranges::find_if(
          last.tracks.list, [&](const Track& t) { return object != ObjectId::none && t.object == object; });
      ASSERT_EQ(last.ids(x, y), track == last.tracks.list.end() ? TrackId::none : track->id);
    }
  }
}

TEST(Follower, FramesBegunEarlyAreDroppedWhenOptionsChange) {
  const std::array different{samples::load("four_in_a_row"), samples::load("overlap")};
  const auto sample = [&](int k) -> const samples::Sample& {
    return different.at(static_cast<std::size_t>(k % 2));
  };
  const auto follow = [&](bool begins_early) {
    Follower follower(config_for(different[0]), different[0].calibration.rig, Exec::with_threads(2));
    std::vector<TrackedFrame> steps;
    for (int k = 0; k < 6; ++k) {
      if (begins_early) follower.prefetch(sample(k + 1).pair());
      if (k == 3) {
        FollowConfig changed = follower.config();
        changed.segmentation.objects.min_area = 3;
        follower.set_config(changed);
      }
      steps.push_back(follower.next(sample(k).pair(), frame_stamp(k)));
    }
    return steps;
  };
  const std::vector<TrackedFrame> expected = follow(false);
  const std::vector<TrackedFrame> found = follow(true);
  EXPECT_LT(expected[4].frame.objects.list.size(), expected[2].frame.objects.list.size())
      << "the option has no effect";
  for (std::size_t k = 0; k < expected.size(); ++k) {
    SCOPED_TRACE(k);
    EXPECT_EQ(found[k].map_from_camera.translation_m.x, expected[k].map_from_camera.translation_m.x);
    ASSERT_EQ(found[k].frame.objects.list.size(), expected[k].frame.objects.list.size());
    for (std::size_t i = 0; i < expected[k].frame.objects.list.size(); ++i)
      EXPECT_EQ(found[k].frame.objects.list[i].box_px, expected[k].frame.objects.list[i].box_px);
    ASSERT_EQ(found[k].tracks.list.size(), expected[k].tracks.list.size());
    for (std::size_t i = 0; i < expected[k].tracks.list.size(); ++i)
      EXPECT_EQ(found[k].tracks.list[i].position_m, expected[k].tracks.list[i].position_m);
  }
}

TEST(Follower, UsesAGivenPoseUnchanged) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  Pose pose;
  pose.translation_m = {1, 2, 3};
  follower.next(sample.pair(), frame_stamp(1), std::nullopt, pose);
  Pose next = pose;
  next.translation_m.z = 3.5;
  const TrackedFrame step = follower.next(sample.pair(), frame_stamp(2), std::nullopt, next);
  EXPECT_EQ(step.map_from_camera.translation_m, next.translation_m);
  EXPECT_NEAR(step.motion.now_from_before.translation_m.z, -0.5, 1e-12);
  EXPECT_FALSE(step.is_lost);
}

TEST(Follower, ContinuesFromTheLastGivenPose) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  Pose pose;
  pose.translation_m = {1, 2, 3};
  follower.next(sample.pair(), frame_stamp(1), std::nullopt, pose);
  TrackedFrame step;
  for (int k = 2; k < 4; ++k) step = follower.next(sample.pair(), frame_stamp(k));
  EXPECT_NEAR(length(step.map_from_camera.translation_m - pose.translation_m), 0, 0.01);
}

TEST(Follower, FindsItsTracksAgainAfterAPause) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  TrackedFrame before;
  for (int k = 1; k <= 3; ++k) before = follower.next(sample.pair(), frame_stamp(k));
  ASSERT_FALSE(before.tracks.list.empty());
  follower.forget();
  const TrackedFrame after = follower.next(sample.pair(), frame_stamp(60));
  EXPECT_EQ(after.motion.refusal, MotionRefusal::none);
  EXPECT_LT(after.pose_covariance[0], 0.01);
  ASSERT_EQ(after.tracks.list.size(), before.tracks.list.size());
  for (std::size_t i = 0; i < after.tracks.list.size(); ++i)
    EXPECT_EQ(after.tracks.list[i].id, before.tracks.list[i].id);
}

TEST(Follower, IsLostAfterAPauseThatEndsInTheDark) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Image<Gray> black(sample.pair().size(), Gray{0}, {});
  for (const bool has_gap : {false, true}) {
    Follower follower(config_for(sample), sample.calibration.rig);
    for (int k = 1; k <= 3; ++k) follower.next(sample.pair(), frame_stamp(k));
    if (has_gap) follower.forget();
    const TrackedFrame dark = follower.next(StereoPair::from(black, black), frame_stamp(4));
    EXPECT_NE(dark.motion.refusal, MotionRefusal::none);
    EXPECT_EQ(dark.pose_covariance[0] >= 1, has_gap);
  }
}

TEST(Follower, APersonBeforeTheLensForFiveSecondsCostsNoIds) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Size size = sample.pair().size();
  // A speckled surface at a quarter of the nearest disparity that is searched for.
  const int near_px = sample.suited().match.num_disparities / 4 * 3;
  Image<Gray> left(size);
  Image<Gray> right(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto speckle = [&](int u) {
        return static_cast<Gray>(60 +
                                 (static_cast<std::uint32_t>(u * 7919 + y * 104729) * 2654435761U >> 25U));
      };
      left(x, y) = speckle(x);
      right(x, y) = speckle(x + near_px);
    }
  }
  const StereoPair covered = StereoPair::from(left, right);
  Follower follower(config_for(sample), sample.calibration.rig);
  TrackedFrame before;
  int frame = 0;
  for (int k = 0; k < 5; ++k) before = follower.next(sample.pair(), frame_stamp(frame++));
  ASSERT_GE(before.tracks.list.size(), 2U);
  for (int k = 0; k < 50; ++k) {
    const TrackedFrame dark = follower.next(covered, frame_stamp(frame++));
    for (const Track& track : before.tracks.list) {
      EXPECT_TRUE(std::ranges::any_of(dark.tracks.list, [&](const Track& t) { return t.id == track.id; }))
          << number(track.id) << " ended after " << k << " frames";
    }
  }
  TrackedFrame after;
  for (int k = 0; k < 5; ++k) after = follower.next(sample.pair(), frame_stamp(frame++));
  EXPECT_FALSE(after.is_lost);
  EXPECT_LT(length(after.map_from_camera.translation_m - before.map_from_camera.translation_m), 0.02);
  for (const Track& track : before.tracks.list) {
    const auto found =
        std::ranges::find_if(after.tracks.list, [&](const Track& t) { return t.id == track.id; });
    ASSERT_NE(found, after.tracks.list.end()) << number(track.id);
    EXPECT_EQ(found->object, track.object);
    EXPECT_FALSE(found->is_moving);
  }
}

TEST(Follower, RefusesStampsThatDoNotIncrease) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  follower.next(sample.pair(), frame_stamp(2));
  EXPECT_NE(refused(follower, sample.pair(), frame_stamp(2)).find("is not later"), std::string::npos);
  EXPECT_NE(refused(follower, sample.pair(), frame_stamp(1)).find("frame 1: its stamp 100000000 ns"),
            std::string::npos);
  EXPECT_EQ(follower.next(sample.pair(), frame_stamp(3)).index, 1);  // and continues
}

TEST(Follower, BeginsANewRunWhereTheClockIsSetBack) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  follower.next(sample.pair(), frame_stamp(100));
  const TrackedFrame before = follower.next(sample.pair(), frame_stamp(101));
  const TrackedFrame again = follower.next(sample.pair(), frame_stamp(2));
  EXPECT_EQ(again.index, 2);
  EXPECT_TRUE(again.motion.is_new_keyframe);
  ASSERT_FALSE(again.tracks.list.empty());
  for (const Track& track : again.tracks.list) {
    EXPECT_EQ(track.first, frame_stamp(2));
    EXPECT_GE(number(track.id), before.tracks.next);  // ids are not used twice
  }
  // As from the beginning, but for the ids.
  Follower fresh(config_for(sample), sample.calibration.rig);
  fresh.next(sample.pair(), frame_stamp(2));
  const TrackedFrame expected = fresh.next(sample.pair(), frame_stamp(3));
  const TrackedFrame found = follower.next(sample.pair(), frame_stamp(3));
  EXPECT_EQ(found.map_from_camera.translation_m.x, expected.map_from_camera.translation_m.x);
  ASSERT_EQ(found.tracks.list.size(), expected.tracks.list.size());
  for (std::size_t i = 0; i < found.tracks.list.size(); ++i)
    EXPECT_EQ(found.tracks.list[i].hits, expected.tracks.list[i].hits);
}

TEST(Follower, RefusesAnImageOfAnotherSize) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample), sample.calibration.rig);
  follower.next(sample.pair(), frame_stamp(1));
  const Image<Gray> smaller({200, 100}, Gray{7}, {});
  EXPECT_NE(refused(follower, StereoPair::from(smaller, smaller), frame_stamp(2)).find("is 200x100"),
            std::string::npos);
}

TEST(Follower, RefusesAnImpossibleRig) {
  EXPECT_THROW(Follower({}, StereoRig{}), Error);
  FollowConfig config;
  config.tracking.low_confidence = 0.9F;
  EXPECT_THROW(Follower{config}, Error);
  config = {};
  config.odometry.max_features = 30;
  config.odometry.min_inliers = 31;
  EXPECT_THROW(Follower{config}, Error) << "no frame would have a motion";
}

TEST(Follower, FollowsACameraWithoutObjects) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config = config_for(sample);
  config.segmentation.objects.min_area = 100;  // % of the image
  Follower follower(config, sample.calibration.rig);
  for (int k = 1; k < 4; ++k) {
    const TrackedFrame step = follower.next(sample.pair(), frame_stamp(k));
    EXPECT_TRUE(step.frame.objects.list.empty());
    EXPECT_TRUE(step.tracks.list.empty());
    EXPECT_EQ(step.ids(0, 0), TrackId::none);
  }
}

TEST(Follower, WithoutARigThereAreIdsButNoPositions) {
  const samples::Sample sample = samples::load("four_in_a_row");
  Follower follower(config_for(sample));
  std::vector<TrackId> first;
  for (int k = 1; k <= 4; ++k) {
    const TrackedFrame step = follower.next(sample.pair(), frame_stamp(k));
    EXPECT_EQ(step.motion.refusal, MotionRefusal::no_rig);
    std::vector<TrackId> ids;
    for (const Track& track : step.tracks.list) {
      ids.push_back(track.id);
      EXPECT_FALSE(track.has_place);
      EXPECT_FALSE(track.is_moving);
      if (k >= 3) {
        EXPECT_EQ(track.state, TrackState::confirmed);
      }
    }
    if (k == 1) first = ids;
    ASSERT_FALSE(ids.empty());
    EXPECT_EQ(ids, first);
  }
}

}  // namespace
}  // namespace cairn
