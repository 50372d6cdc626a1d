// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <cairn/sequence/kalman.hpp>
#include <cairn/sequence/tracks.hpp>

namespace cairn {
namespace {

constexpr Covariance3 variances(double v) {
  return {v, 0, 0, 0, v, 0, 0, 0, v};
}
Covariance6 variances(double of_position, double of_velocity) {
  Covariance6 c{};
  for (std::size_t i = 0; i < 6; ++i) c.at(i * 7) = i < 3 ? of_position : of_velocity;
  return c;
}
Stamp seconds(double s) {
  return {std::llround(s * 1e9)};
}

// ---- an uncertain path ----

Track standing(Point3 at_m) {
  Track track;
  track.id = TrackId{1};
  track.has_place = true;
  track.position_m = at_m;
  track.as_static = {at_m, variances(0.01)};
  track.as_moving = {at_m, {}, variances(0.01, 1)};
  track.covariance_m2 = variances(0.01);
  track.against_label = 3;
  track.places.resize(4);
  return track;
}

TEST(Tracks, HaveTheUncertaintyOfTheLinkToANewKeyframe) {
  Covariance6 key{};
  key[0] = 0.04;   // x
  key[35] = 0.01;  // about z
  const Pose camera{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 1}};
  const Tracks before{{standing({0, 2, 1})}, 2, {}, false};
  const Track same = rebased_to_keyframe(before, camera, {}, false).list[0];
  EXPECT_EQ(same.as_static.covariance_m2, before.list[0].as_static.covariance_m2);
  EXPECT_EQ(same.places.size(), 4U);

  const Track tied = rebased_to_keyframe(before, camera, key, true).list[0];
  EXPECT_NEAR(tied.as_static.covariance_m2[0], 0.01 + 0.04 + 4 * 0.01, 1e-12);  // 2 m away, turned
  EXPECT_NEAR(tied.as_static.covariance_m2[4], 0.01, 1e-12);
  EXPECT_NEAR(tied.as_moving.covariance[0], 0.01 + 0.04 + 4 * 0.01, 1e-12);
  EXPECT_NEAR(tied.as_moving.covariance[21], 1, 1e-12);
  EXPECT_EQ(tied.as_static.position_m, before.list[0].as_static.position_m);
  EXPECT_TRUE(tied.places.empty()) << "the jump is the camera's";
  EXPECT_EQ(tied.against_label, 0);
}

TEST(Tracks, HaveThePosesUncertaintyInTheMapOnly) {
  Covariance6 pose{};
  pose[7] = 0.09;
  pose[21] = 0.01;  // about x: raises points ahead along y
  const Covariance3 in_map_m2 = covariance_in_map(standing({0, 3, 0}), {}, pose);
  EXPECT_NEAR(in_map_m2[0], 0.01, 1e-12);
  EXPECT_NEAR(in_map_m2[4], 0.1, 1e-12);
  EXPECT_NEAR(in_map_m2[8], 0.01 + 9 * 0.01, 1e-12);
}

// ---- the filters ----

TEST(Filter3, IsARandomWalkAndAveragesEqualUncertainties) {
  const Filter3 before{{1, 2, 3}, variances(1)};
  const Filter3 later = predicted(before, 4, 0.5);
  EXPECT_EQ(later.position_m, before.position_m);
  EXPECT_EQ(later.covariance_m2, variances(2));
  const Filter3 after = updated(later, {3, 2, 3}, variances(2));
  EXPECT_NEAR(after.position_m.x, 2, 1e-12);
  EXPECT_NEAR(after.position_m.y, 2, 1e-12);
  EXPECT_NEAR(after.covariance_m2[0], 1, 1e-12);
  EXPECT_NEAR(after.covariance_m2[1], 0, 1e-12);
}

TEST(Filter6, MovesWithItsVelocityAndLosesCertainty) {
  Filter6 before{{1, 0, 0}, {2, 0, -1}, variances(1, 4)};
  const Filter6 later = predicted(before, 0.5, 2);
  EXPECT_EQ(later.position_m, (Point3{2, 0, -0.5}));
  EXPECT_EQ(later.velocity_m_s, before.velocity_m_s);
  EXPECT_NEAR(later.covariance[0], 1 + 0.25 * 4 + 4 * 0.125 * 0.125, 1e-12);  // p + v·t² + a²·(t²/2)²
  EXPECT_NEAR(later.covariance[3], 0.5 * 4 + 4 * 0.125 * 0.5, 1e-12);         // v·t + a²·(t²/2)·t
  EXPECT_NEAR(later.covariance[3 * 7], 4 + 4 * 0.25, 1e-12);                  // v + a²·t²
  EXPECT_NEAR(of_position(later)[0], later.covariance[0], 0);
}

TEST(Filter6, EstimatesItsVelocityFromPositions) {
  Filter6 filter{{0, 0, 0}, {}, variances(0.01, 1)};
  for (int k = 1; k <= 40; ++k)
    filter = updated(predicted(filter, 0.1, 0.5), {0.03 * k, -0.01 * k, 0}, variances(1e-4));
  EXPECT_NEAR(filter.velocity_m_s.x, 0.3, 0.005);
  EXPECT_NEAR(filter.velocity_m_s.y, -0.1, 0.005);
  EXPECT_NEAR(filter.position_m.x, 1.2, 0.002);
}

TEST(Innovation, IsTheGaussiansExponentAndVolume) {
  const Innovation found = innovation({0, 0, 0}, variances(3), {4, 0, 0}, variances(1));
  EXPECT_NEAR(found.d2, 4, 1e-12);                            // 4² / (3 + 1)
  EXPECT_NEAR(found.log_widening, 3 * std::log(4.0), 1e-12);  // |4·I| / |I|
  EXPECT_NEAR(log_vagueness(variances(1)), -6 * std::log(0.15), 1e-12);
  EXPECT_EQ(log_vagueness(variances(0.01)), 0);
  EXPECT_NEAR(found.log_likelihood, -0.5 * (4 + std::log(64.0) + 3 * std::log(6.283185307179586)), 1e-9);
}

TEST(InMap, RotatesTheCovarianceAndAddsThePoses) {
  const Pose quarter = rotation_about({0, 0, 1.5707963267948966});
  Covariance3 wide_in_x = variances(1);
  wide_in_x[0] = 9;
  const Covariance3 turned = in_map(wide_in_x, {0, 0, 2}, quarter, {});
  EXPECT_NEAR(turned[0], 1, 1e-12);
  EXPECT_NEAR(turned[4], 9, 1e-12);
  // If the rotation about y is uncertain by 0.1 rad, a point 2 m ahead is uncertain by 0.2 m in x.
  Covariance6 pose{};
  pose[0] = 0.5;       // position in x
  pose[4 * 7] = 0.01;  // rotation about y
  const Covariance3 found = in_map(variances(0), {0, 0, 2}, {}, pose);
  EXPECT_NEAR(found[0], 0.5 + 0.04, 1e-12);
  EXPECT_NEAR(found[8], 0, 1e-12);
}

TEST(SeenAnew, TheVisibleSurfaceMovesAroundTheCentre) {
  const Vec3 extent{0.6F, 0.2F, 0};
  const double shift = nearer_surface::kShare * 0.6;
  const double sigma = nearer_surface::kSigma * 0.4;
  const Filter3 before{{1, 0, 0.5}, variances(0.01)};
  const Filter3 nearer = moved_viewpoint(before, extent, {3, 0, 0.5}, {2, 0, 0.5});
  EXPECT_EQ(nearer.position_m, before.position_m);  // from the same side
  EXPECT_EQ(nearer.covariance_m2, before.covariance_m2);
  const Filter3 quarter = moved_viewpoint(before, extent, {3, 0, 0.5}, {1, 3, 0.5});
  EXPECT_NEAR(quarter.position_m.x, 1 - shift, 1e-7);
  EXPECT_NEAR(quarter.position_m.y, shift, 1e-7);
  EXPECT_EQ(quarter.position_m.z, 0.5);
  EXPECT_NEAR(quarter.covariance_m2[0], 0.01 + 2 * sigma * sigma, 1e-7);  // a chord of √2
  const Filter3 behind = moved_viewpoint(before, extent, {3, 0, 0.5}, {-1, 0, 0.5});
  EXPECT_NEAR(behind.position_m.x, 1 - 2 * shift, 1e-7);
  EXPECT_NEAR(behind.covariance_m2[8], 0.01 + 4 * sigma * sigma, 1e-7);
  // Across the vertical axis, though the azimuth turns by 180°.
  const Filter3 above = moved_viewpoint(before, extent, {1.02, 0, 2.5}, {0.98, 0, 2.5});
  EXPECT_NEAR(above.position_m.x, 1 - 0.02 * shift, 1e-4);
  EXPECT_EQ(moved_viewpoint(before, extent, {3, 0, 0.5}, before.position_m).position_m, before.position_m);
}

TEST(DriftOf, IsTheSlopeOfTheStraightLine) {
  std::vector<Place> places;
  for (int k = 0; k < 3; ++k) places.push_back({seconds(k), {2.0 * k, 0, 1}, variances(0.08)});
  const Drift drift = drift_of(places);
  EXPECT_NEAR(drift.velocity_m_s.x, 2, 1e-12);
  EXPECT_NEAR(drift.velocity_m_s.z, 0, 1e-12);
  EXPECT_NEAR(drift.sigma_m_s, 0.2, 1e-12);  // √(0.08 / (1 + 0 + 1))
}

TEST(Likeness, IsOneForEqualAndZeroForDisjointColours) {
  ColourHistogram a{};
  a[0] = a[8] = 1;
  ColourHistogram b{};
  b[1] = b[9] = 1;
  EXPECT_FLOAT_EQ(likeness(a, a), 1);
  EXPECT_FLOAT_EQ(likeness(a, b), 0);
  b[1] = 0;
  b[0] = 1;  // equal lightness, another colour
  EXPECT_FLOAT_EQ(likeness(a, b), 0.5F);
}

// ---- tracks ----

Detection sighting_at(std::int32_t object, Point3 position_m, float confidence = 0.9F) {
  Detection seen;
  seen.object = ObjectId{object};
  seen.has_place = true;
  seen.position_in_camera_m = position_m;
  seen.covariance_in_camera_m2 = variances(4e-4);
  seen.extent_m = {0.3F, 0.3F, 0.1F};
  seen.confidence = confidence;
  seen.pixel_count = 100;
  seen.box_px = {10, 10, 10, 10};
  seen.look[0] = seen.look[8] = 1;
  return seen;
}

/// A static camera at 10 Hz.
struct Story {
  Tracks tracks;
  int frame = 0;
  TrackingConfig config;

  /// The default overlaps: each track is in view and unoccluded.
  [[nodiscard]] Overlaps plain(int objects) const {
    Overlaps overlaps;
    const std::size_t count = tracks.list.size();
    for (const Track& track : tracks.list) overlaps.tracks.push_back(track.id);
    overlaps.in_view.assign(count, 1);
    overlaps.area.assign(count, 100);
    overlaps.predicted.assign(count, 100);
    overlaps.nearer.assign(count, 0);
    overlaps.objects = objects;
    overlaps.common.assign(count * static_cast<std::size_t>(objects), 0);
    return overlaps;
  }
  void step(const std::vector<Detection>& detections, const Overlaps& overlaps, bool is_lost = false,
            const Pose& pose = {}) {
    const Stamp now = seconds(0.1 * ++frame);
    const auto matches =
        is_lost ? std::vector<Assignment>{} : associate(tracks, detections, overlaps, {now, pose}, config);
    tracks = advance_tracks(tracks, detections, matches, overlaps, {now, pose, {}, is_lost}, config);
  }
  void step(const std::vector<Detection>& detections) {
    step(detections, plain(static_cast<int>(detections.size())));
  }
  [[nodiscard]] std::vector<std::int64_t> ids() const {
    std::vector<std::int64_t> found;
    for (const Track& track : tracks.list) found.push_back(number(track.id));
    return found;
  }
  [[nodiscard]] const Track& only() const {
    EXPECT_EQ(tracks.list.size(), 1U);
    return tracks.list.at(0);
  }
};

TEST(Tracks, AreConfirmedByThreeSightingsOfFive) {
  Story story;
  story.step({sighting_at(1, {0, 0, 2}, 0.45F)});
  EXPECT_EQ(story.only().state, TrackState::tentative);
  story.step({});
  story.step({sighting_at(1, {0, 0, 2}, 0.45F)});
  EXPECT_EQ(story.only().state, TrackState::tentative);
  story.step({});
  story.step({sighting_at(1, {0, 0, 2}, 0.45F)});
  EXPECT_EQ(story.only().state, TrackState::confirmed);
  EXPECT_EQ(story.only().hits, 3);
  EXPECT_EQ(story.only().first, seconds(0.1));
  EXPECT_EQ(story.only().last, seconds(0.5));
}

TEST(Tracks, AreConfirmedAtOnceByAConfidentSighting) {
  Story story;
  story.step({sighting_at(1, {0, 0, 2}, 0.8F)});  // 1 − 0.8 ≤ (1 − 0.4)³
  EXPECT_EQ(story.only().state, TrackState::confirmed);
  Story two;
  two.step({sighting_at(1, {0, 0, 2}, 0.6F)});
  EXPECT_EQ(two.only().state, TrackState::tentative);
  two.step({sighting_at(1, {0, 0, 2}, 0.6F)});
  EXPECT_EQ(two.only().state, TrackState::confirmed);
}

TEST(Tracks, FiveHundredObjectsInAFrameKeepTheirIds) {
  constexpr std::int32_t kMany = 500;
  const auto at = [](std::int32_t thing) { return Point3{0.4 * (thing % 25), 0.4 * (thing / 25), 6}; };
  Story story;
  for (const std::int32_t stride : {1, 3, 7, 9}) {  // in each frame in another order
    std::vector<Detection> detections;
    for (std::int32_t i = 0; i < kMany; ++i) detections.push_back(sighting_at(i + 1, at(i * stride % kMany)));
    story.step(detections);
    ASSERT_EQ(story.tracks.list.size(), std::size_t{kMany}) << stride;
    for (std::int32_t thing = 0; thing < kMany; ++thing) {
      const Track& track = story.tracks.list[static_cast<std::size_t>(thing)];
      EXPECT_EQ(number(track.id), thing + 1);
      EXPECT_LT(length(track.position_m - at(thing)), 1e-9);
    }
  }
}

TEST(Tracks, AreCreatedByConfidentObjectsOnly) {
  Story story;
  story.step({sighting_at(1, {0, 0, 2}, 0.3F)});
  EXPECT_TRUE(story.tracks.list.empty());
  story.step({sighting_at(1, {0, 0, 2}, 0.5F)});
  story.step({sighting_at(1, {0, 0, 2}, 0.3F)});
  EXPECT_EQ(story.only().hits, 2);
}

TEST(Tracks, IdsAreNeverUsedAgain) {
  Story story;
  story.step({sighting_at(1, {0, 0, 2}, 0.5F), sighting_at(2, {1, 0, 2}, 0.5F)});
  EXPECT_EQ(story.ids(), (std::vector<std::int64_t>{1, 2}));
  for (int k = 0; k < 3; ++k) story.step({});  // neither was confirmed
  EXPECT_TRUE(story.tracks.list.empty());
  story.step({sighting_at(1, {0, 0, 2})});
  EXPECT_EQ(story.ids(), std::vector<std::int64_t>{3});
}

TEST(Tracks, EndAfterMissesInViewOnly) {
  Story story;
  story.config.max_age = 4;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2})});
  Overlaps hidden = story.plain(0);
  hidden.nearer[0] = 51;
  story.step({}, hidden);
  EXPECT_EQ(story.only().state, TrackState::occluded);
  hidden.nearer[0] = 0;
  hidden.predicted[0] = 40;  // another track's mask covers the rest
  story.step({}, hidden);
  EXPECT_EQ(story.only().state, TrackState::occluded);
  Overlaps outside = story.plain(0);
  outside.in_view[0] = 0.4F;
  story.step({}, outside);
  EXPECT_EQ(story.only().state, TrackState::out_of_view);
  EXPECT_EQ(story.only().misses, 0);
  for (int k = 0; k < 4; ++k) story.step({});
  EXPECT_EQ(story.only().state, TrackState::lost);
  EXPECT_EQ(story.only().misses, 4);
  story.step({});
  EXPECT_TRUE(story.tracks.list.empty());
}

TEST(Tracks, EndAfterLongOcclusion) {
  Story story;
  story.config.max_hidden = 1.0F;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2})});
  Overlaps outside = story.plain(0);
  outside.in_view[0] = 0;
  for (int k = 0; k < 10; ++k) story.step({}, outside);
  EXPECT_EQ(story.only().state, TrackState::out_of_view);
  story.step({}, outside);
  EXPECT_TRUE(story.tracks.list.empty());
}

TEST(Tracks, AReappearingObjectKeepsItsId) {
  Story story;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2})});
  for (int k = 0; k < 10; ++k) story.step({});
  EXPECT_EQ(story.only().state, TrackState::lost);
  story.step({sighting_at(1, {0.02, 0, 2})});
  EXPECT_EQ(story.only().state, TrackState::confirmed);
  EXPECT_EQ(number(story.only().id), 1);
  EXPECT_EQ(story.only().misses, 0);
}

TEST(Tracks, AverageThePositionOfAStaticObject) {
  Story story;
  for (int k = 0; k < 40; ++k) {
    Detection seen = sighting_at(1, {k % 2 == 0 ? 0.03 : -0.03, 0, 2});
    seen.steady_in_camera_m2 = variances(2e-4);
    story.step({seen});
  }
  EXPECT_FALSE(story.only().is_moving);
  EXPECT_NEAR(story.only().position_m.x, 0, 0.01);
  EXPECT_EQ(story.only().velocity_m_s, Point3{});
  // The mask's own error does not average out.
  EXPECT_GT(story.only().covariance_m2[0], 2e-4);
  EXPECT_LT(story.only().covariance_m2[0], 4e-4);
}

TEST(Tracks, StateTheErrorThatPersistsHoweverOftenTheyAreSeen) {
  Story story;
  Detection seen = sighting_at(1, {0, 0, 2});
  seen.steady_in_camera_m2 = variances(9e-4);
  for (int k = 0; k < 50; ++k) story.step({seen});
  const Track& track = story.only();
  for (const std::size_t i : {0U, 4U, 8U}) {
    EXPECT_GT(track.covariance_m2.at(i), 9e-4);
    EXPECT_NEAR(track.covariance_m2.at(i), 9e-4 + track.as_static.covariance_m2.at(i), 1e-12);
  }
}

TEST(Tracks, ARollingObjectIsDetectedAsMovingAndStoppedLater) {
  Story story;
  int moving_at = -1;
  for (int k = 0; k < 20; ++k) {
    story.step({sighting_at(1, {0.04 * k, 0, 2})});
    if (story.only().is_moving && moving_at < 0) moving_at = k;
  }
  EXPECT_GE(moving_at, 3);  // no two sightings suffice
  EXPECT_LE(moving_at, 5);
  EXPECT_NEAR(story.only().velocity_m_s.x, 0.4, 0.04);
  int stands_at = -1;
  for (int k = 0; k < 40; ++k) {
    story.step({sighting_at(1, {0.76, 0, 2})});
    if (!story.only().is_moving && stands_at < 0) stands_at = k;
  }
  EXPECT_GE(stands_at, 0);
  EXPECT_FALSE(story.only().is_moving);
  EXPECT_EQ(story.only().id, TrackId{1});
}

TEST(Tracks, ALongStaticObjectIsDetectedAsMovingAsSoon) {
  Story story;
  for (int k = 0; k < 100; ++k) story.step({sighting_at(1, {0, 0, 2})});
  int moving_at = -1;
  for (int k = 1; k < 20 && moving_at < 0; ++k) {
    story.step({sighting_at(1, {0.04 * k, 0, 2})});
    if (story.only().is_moving) moving_at = k;
  }
  EXPECT_GE(moving_at, 3);
  EXPECT_LE(moving_at, 6);
}

TEST(Tracks, AMaskThatJumpsOnceIsNotMotion) {
  Story story;
  for (int k = 0; k < 10; ++k) story.step({sighting_at(1, {0, 0, 2})});
  for (int k = 0; k < 10; ++k) {
    story.step({sighting_at(1, {0.06, 0, 2})});  // from now on with an additional piece
    EXPECT_FALSE(story.only().is_moving) << k;
  }
}

TEST(Tracks, ClippedOrUncertainObjectsAreNotMoving) {
  for (const bool is_cut : {true, false}) {
    Story story;
    for (int k = 0; k < 15; ++k) {
      Detection seen = sighting_at(1, {0.04 * k, 0, 2}, is_cut || k == 0 ? 0.9F : 0.3F);
      seen.is_cut = is_cut;
      story.step({seen});
      EXPECT_FALSE(story.only().is_moving) << k;
    }
    EXPECT_EQ(story.only().hits, 15);
  }
}

TEST(Tracks, IfMostObjectsMoveAtOnceTheCameraIsSuspected) {
  Story story;
  bool was_suspect = false;
  for (int k = 0; k < 12; ++k) {
    std::vector<Detection> detections;
    for (int i = 0; i < 3; ++i) detections.push_back(sighting_at(i + 1, {i + 0.04 * k, 0, 2}));
    story.step(detections);
    was_suspect = was_suspect || story.tracks.odometry_suspect;
    for (const Track& track : story.tracks.list) EXPECT_FALSE(track.is_moving);
  }
  EXPECT_TRUE(was_suspect);
}

TEST(Tracks, OneMovingOfThreeDoesNotBlameTheCamera) {
  Story story;
  for (int k = 0; k < 12; ++k) {
    story.step({sighting_at(1, {0.04 * k, 0, 2}), sighting_at(2, {1, 0, 2}), sighting_at(3, {2, 0, 2})});
    EXPECT_FALSE(story.tracks.odometry_suspect);
  }
  EXPECT_TRUE(story.tracks.list[0].is_moving);
  EXPECT_FALSE(story.tracks.list[1].is_moving);
}

TEST(Tracks, AMovingCameraDoesNotMoveObjects) {
  Story story;
  for (int k = 0; k < 15; ++k) {
    Pose pose = rotation_about({0, 0.02 * k, 0});
    pose.translation_m = {0, 0, 0.05 * k};
    const std::vector detections{sighting_at(1, inverse(pose)({0.3, 0.1, 3}))};
    story.step(detections, story.plain(1), false, pose);
  }
  EXPECT_FALSE(story.only().is_moving);
  EXPECT_NEAR(story.only().position_m.x, 0.3, 1e-3);
  EXPECT_NEAR(story.only().position_m.z, 3, 1e-9);
}

TEST(Tracks, FollowTheVisibleSurfaceAroundAnObject) {
  // The camera drives around an object at the origin, by 12° a frame, with a pause out of sight.
  Story story;
  double worst = 0;
  for (int k = 0; k < 24; ++k) {
    const double angle = 0.21 * k;
    const Point3 towards{std::cos(angle), std::sin(angle), 0};
    Pose pose = rotation_about({0, 0, angle});
    pose.translation_m = 2.0 * towards;
    if (k >= 10 && k < 14) {
      story.step({}, story.plain(0), false, pose);
      continue;
    }
    Detection seen = sighting_at(1, {});
    const Point3 visible = nearer_surface::kShare * double{seen.extent_m.x} * towards;
    seen.position_in_camera_m = inverse(pose)(visible);
    story.step({seen}, story.plain(k == 0 ? 0 : 1), false, pose);
    ASSERT_EQ(number(story.only().id), 1) << k;
    EXPECT_FALSE(story.only().is_moving) << k;
    worst = std::max(worst, length(story.only().position_m - visible));
  }
  EXPECT_LT(worst, 0.005);
}

TEST(Tracks, JoinedOnesSurviveAndKeepTheirPositions) {
  Story story;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2}), sighting_at(2, {0.3, 0, 2})});
  for (int k = 0; k < 30; ++k) {
    Overlaps overlaps = story.plain(1);
    overlaps.common = {90, 95};
    Detection both = sighting_at(1, {0.15, 0, 2});
    both.pixel_count = 200;
    story.step({both}, overlaps);
    ASSERT_EQ(story.ids(), (std::vector<std::int64_t>{1, 2}));
    EXPECT_TRUE(story.tracks.list[0].is_joined);
    EXPECT_TRUE(story.tracks.list[1].is_joined);
    EXPECT_EQ(story.tracks.list[0].object, ObjectId::none);
    EXPECT_EQ(story.tracks.list[1].object, ObjectId{1});
  }
  EXPECT_NEAR(story.tracks.list[0].position_m.x, 0, 1e-9);
  EXPECT_NEAR(story.tracks.list[1].position_m.x, 0.3, 1e-9);
  story.step({sighting_at(1, {0, 0, 2}), sighting_at(2, {0.3, 0, 2})});
  EXPECT_EQ(story.ids(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(story.tracks.list[0].object, ObjectId{1});
  EXPECT_FALSE(story.tracks.list[0].is_joined);
}

TEST(Tracks, AnObjectInFrontOfTwoIsANewOneAndHidesThem) {
  Story story;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 4}), sighting_at(2, {0.3, 0, 4})});
  Overlaps overlaps = story.plain(1);
  overlaps.common = {90, 95};
  overlaps.nearer = {85, 90};  // the image shows something nearer than the tracks there
  Detection front = sighting_at(1, {0.1, 0, 1.5});
  front.pixel_count = 800;
  EXPECT_TRUE(joined_objects(story.tracks, overlaps).empty());
  story.step({front}, overlaps);
  ASSERT_EQ(story.ids(), (std::vector<std::int64_t>{1, 2, 3}));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(story.tracks.list[i].state, TrackState::occluded);
    EXPECT_FALSE(story.tracks.list[i].is_joined);
    EXPECT_EQ(story.tracks.list[i].object, ObjectId::none);
  }
  EXPECT_EQ(story.tracks.list[2].object, ObjectId{1});
}

TEST(Tracks, AnObjectThatCoversTwoOfThemCreatesNone) {
  Story story;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2}), sighting_at(2, {0.3, 0, 2})});
  Overlaps overlaps = story.plain(1);
  overlaps.common = {90, 95};
  Detection both = sighting_at(1, {0.15, 0, 2});
  both.look = {};
  both.look[5] = both.look[60] = 1;  // similar to neither: it gets no id
  both.pixel_count = 400;
  story.step({both}, overlaps);
  EXPECT_EQ(story.ids(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(story.tracks.list[1].object, ObjectId::none);
  EXPECT_EQ(story.tracks.list[1].misses, 0);
}

TEST(Tracks, PiecesCreateNoTracksAtFirst) {
  Story story;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2})});
  const auto in_pieces = [&] {
    Overlaps overlaps = story.plain(2);
    overlaps.common[0] = 45;
    overlaps.common[1] = 45;
    std::vector detections{sighting_at(1, {-0.02, 0, 2}), sighting_at(2, {0.02, 0, 2})};
    for (Detection& seen : detections) seen.pixel_count = 50;
    story.step(detections, overlaps);
  };
  for (int k = 0; k < 5; ++k) {
    in_pieces();
    ASSERT_EQ(story.tracks.list.size(), 1U);
    EXPECT_EQ(story.only().parts.size(), 1U);
    EXPECT_NEAR(story.only().position_m.x, 0, 1e-6);
  }
  in_pieces();  // by now it is more likely two objects
  EXPECT_EQ(story.tracks.list.size(), 2U);
  EXPECT_TRUE(story.tracks.list[0].parts.empty());
}

TEST(Tracks, AreFrozenWhileTheCameraIsLost) {
  Story story;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2})});
  for (int k = 0; k < 20; ++k) story.step({sighting_at(1, {5, 0, 2})}, story.plain(1), true);
  EXPECT_EQ(story.only().state, TrackState::lost);
  EXPECT_EQ(story.only().object, ObjectId::none);
  EXPECT_EQ(story.only().hits, 3);
  EXPECT_EQ(story.only().misses, 0);
  EXPECT_NEAR(story.only().position_m.x, 0, 1e-9);
  story.step({sighting_at(1, {0, 0, 2})});
  EXPECT_EQ(story.only().state, TrackState::confirmed);
  EXPECT_EQ(story.only().id, TrackId{1});
}

TEST(Tracks, KeepMovingWhileTheCameraIsLost) {
  Story story;
  const auto rolling = [&] { return sighting_at(1, {0.05 * story.frame, 0, 2}); };  // 0.5 m/s
  for (int k = 0; k < 30; ++k) story.step({rolling()});
  ASSERT_TRUE(story.only().is_moving);
  const double sigma_before = story.only().covariance_m2[0];
  for (int k = 0; k < 10; ++k) story.step({}, story.plain(0), true);
  EXPECT_NEAR(story.only().position_m.x, 0.05 * (story.frame - 1), 0.1);
  EXPECT_GT(story.only().covariance_m2[0], 4 * sigma_before);
  story.step({rolling()});
  EXPECT_EQ(story.only().state, TrackState::confirmed);
  EXPECT_EQ(story.only().id, TrackId{1});
}

TEST(Tracks, EndIfTheCameraIsLostForLong) {
  Story story;
  story.config.max_hidden = 1.0F;
  for (int k = 0; k < 3; ++k) story.step({sighting_at(1, {0, 0, 2})});
  for (int k = 0; k < 10; ++k) story.step({}, story.plain(0), true);
  EXPECT_EQ(story.only().state, TrackState::lost);
  story.step({}, story.plain(0), true);
  EXPECT_TRUE(story.tracks.list.empty());
}

TEST(Tracks, WithoutPositionsAreFollowedByTheirMasks) {
  Story story;
  Detection seen = sighting_at(1, {});
  seen.has_place = false;
  for (int k = 0; k < 5; ++k) {
    Overlaps overlaps = story.plain(1);
    for (int& common : overlaps.common) common = 80;
    story.step({seen}, overlaps);
  }
  EXPECT_EQ(story.only().state, TrackState::confirmed);
  EXPECT_FALSE(story.only().has_place);
  EXPECT_EQ(story.only().hits, 5);
}

// ---- sightings ----

struct Picture {
  Frame frame;
  Image<Gray> left{{40, 30}, Gray{100}, {}};
  Image<Rgb> rgb{{40, 30}, Rgb{200, 40, 40}, {}};

  explicit Picture(Rect rect, float confidence = 0.9F) {
    frame.objects.labels = Image<ObjectId>({40, 30}, ObjectId::none, {});
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      for (int x = rect.x; x < rect.x + rect.width; ++x) frame.objects.labels(x, y) = ObjectId{1};
    Object object;
    object.id = ObjectId{1};
    object.box_px = rect;
    object.pixel_count = rect.width * rect.height;
    object.confidence = confidence;
    object.disparity_px = 5;
    object.disparity_sigma_px = 0.25F;
    object.position_in_camera_m = Vec3{0, 0, 2};
    object.extent_in_camera_m = Vec3{0.4F, 0.2F, 0};
    frame.objects.list.push_back(object);
  }
  [[nodiscard]] std::vector<Detection> sighted(bool with_rig = true) const {
    const StereoRig rig{.focal_px = 100, .cx_px = 20, .cy_px = 15, .baseline_m = 0.1F, .doffs_px = 0};
    return detect(frame, {left, rgb}, with_rig ? std::optional(rig) : std::nullopt, {});
  }
};

TEST(Sight, ReportsAPositionWithItsUncertainty) {
  const Detection seen = Picture({10, 10, 12, 8}, 1).sighted().at(0);
  EXPECT_TRUE(seen.has_place);
  EXPECT_FALSE(seen.is_cut);
  EXPECT_EQ(seen.position_in_camera_m, (Point3{0, 0, 2}));
  // 0.5 px are 1 cm at 2 m, 0.05 of the extent 2 and 1 cm; 0.25 px of disparity are 10 cm of depth.
  EXPECT_NEAR(seen.covariance_in_camera_m2[0], 0.01 * 0.01 + 0.02 * 0.02, 1e-8);
  EXPECT_NEAR(seen.covariance_in_camera_m2[4], 0.01 * 0.01 + 0.01 * 0.01, 1e-8);
  EXPECT_NEAR(seen.covariance_in_camera_m2[8], 0.01, 1e-8);
  // 1.5 times 0.32 px are 0.96 cm at 2 m. Odds of 1 to 99 against the mask, to the power of 0.516, are 0.0934: of
  // 0.066 of the width, 0.4 m, and of 0.1575 of the height, 0.2 m. 0.84 of 0.25 px of disparity are 8.4 cm of depth.
  EXPECT_NEAR(seen.steady_in_camera_m2[0], 0.0096 * 0.0096 + 0.002465 * 0.002465, 1e-7);
  EXPECT_NEAR(seen.steady_in_camera_m2[4], 0.0096 * 0.0096 + 0.002941 * 0.002941, 1e-7);
  EXPECT_NEAR(seen.steady_in_camera_m2[8], 0.084 * 0.084, 1e-6);
}

TEST(Sight, AnUncertainOrClippedMaskHasAMoreUncertainCentre) {
  const Detection whole = Picture({10, 10, 12, 8}, 1).sighted().at(0);
  const double sure = whole.covariance_in_camera_m2[0];
  EXPECT_GT(Picture({10, 10, 12, 8}, 0.5F).sighted().at(0).covariance_in_camera_m2[0], 2 * sure);
  const Detection cut = Picture({0, 10, 12, 8}, 1).sighted().at(0);
  EXPECT_TRUE(cut.is_cut);
  EXPECT_GT(cut.covariance_in_camera_m2[0], 10 * sure);
  EXPECT_LT(cut.covariance_in_camera_m2[4], sure);  // clipped at left and right, not at top and bottom
  const Detection unsure = Picture({10, 10, 12, 8}, 0.5F).sighted().at(0);
  EXPECT_GT(unsure.steady_in_camera_m2[0], 2 * whole.steady_in_camera_m2[0]);
  EXPECT_EQ(cut.steady_in_camera_m2, whole.steady_in_camera_m2);  // the centre is that of what is visible
}

TEST(Sight, OmitsObjectsBelowTheConfidenceThreshold) {
  EXPECT_TRUE(Picture({10, 10, 12, 8}, 0.05F).sighted().empty());
  EXPECT_EQ(Picture({10, 10, 12, 8}, 0.1F).sighted().size(), 1U);
}

TEST(Sight, HasColoursButNoPositionWithoutARig) {
  const Detection seen = Picture({10, 10, 12, 8}).sighted(false).at(0);
  EXPECT_FALSE(seen.has_place);
  float lightness = 0;
  float chroma = 0;
  for (std::size_t i = 0; i < seen.look.size(); ++i) (i < 8 ? lightness : chroma) += seen.look.at(i);
  EXPECT_FLOAT_EQ(lightness, 1);
  EXPECT_FLOAT_EQ(chroma, 1);
}

TEST(Sight, UsesColoursWellInsideTheMask) {
  Picture clean({10, 10, 12, 8});
  Picture framed({10, 10, 12, 8});
  for (int y = 10; y < 18; ++y) {
    for (int x = 10; x < 22; ++x) {
      if (x < 12 || x >= 20 || y < 12 || y >= 16) framed.rgb(x, y) = {20, 20, 250};
    }
  }
  EXPECT_EQ(clean.sighted().at(0).look, framed.sighted().at(0).look);
  framed.rgb.fill({20, 20, 250});
  EXPECT_LT(likeness(clean.sighted().at(0).look, framed.sighted().at(0).look), 0.6F);
}

}  // namespace
}  // namespace cairn
