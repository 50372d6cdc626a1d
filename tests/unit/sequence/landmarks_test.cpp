// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/sequence/landmarks.hpp>
#include <functional>
#include <optional>
#include <set>
#include <support/drawn_room.hpp>

namespace cairn {
namespace {

using support::camera_at;
using support::Cylinder;
using support::DrawnRoom;
using support::DrawnView;
using support::TrueTracks;

constexpr double kTurn = 2 * std::numbers::pi;

/// A run through a rendered room. Odometry starts at its own origin if the test requires.
class Excursion {
 public:
  LandmarksState state;
  std::vector<LandmarkEvent> events;
  std::map<LandmarkId, std::set<int>> things_of;  // all objects that were matched with it
  std::map<LandmarkRefusal, int> refusals;
  int recognised = 0;
  Pose odom_from_map;
  double drift_rad = 0;  // per step, about the vertical
  bool holes = false;
  bool dark = false;  // matching then gives random far disparities, and there are no objects
  MotionRefusal motion = MotionRefusal::none;
  bool suspect = false;
  double unsure_m2 = 0;  // stated by odometry in addition to its drift
  double unsure_rad2 = 0;
  LandmarksConfig config;

  explicit Excursion(LandmarkMap map = {}, std::int64_t run = 1,
                     const std::optional<Pose>& start = std::nullopt)
      : state(begin_landmarks(std::move(map), run, start)) {}

  /// Odometry fails and continues from a guess: since the previous frame, the camera seems to be rotated by
  /// `turned_rad` and moved by `moved_m`.
  void break_odometry(double turned_rad, Point3 moved_m) {
    const Point3 here = odom_.translation_m;
    odom_.rotation = (rotation_about({0, 0, turned_rad}) * odom_).rotation;
    odom_.translation_m = here + moved_m;
    constexpr double kRad = 30 * kTurn / 360;
    unsure_m2 += 1;
    unsure_rad2 += kRad * kRad;
    for (Track& track : tracks_.tracks.list) {  // as done by rebased_to_keyframe()
      for (const std::size_t k : {0U, 4U, 8U}) track.covariance_m2[k] += 1;
    }
    is_new_segment_ = true;
  }

  void frame(const DrawnRoom& room, const Pose& map_from_camera) {
    const DrawnView view = support::draw(room, map_from_camera, random_);
    if (!before_) {
      odom_ = odom_from_map * map_from_camera;
    } else {
      Pose step = inverse(*before_) * map_from_camera;
      const Pose turn = rotation_about({0, 0, drift_rad});
      const Point3 here = odom_.translation_m;
      odom_ = odom_ * step;
      const Point3 there = odom_.translation_m;
      odom_.rotation = (turn * odom_).rotation;
      odom_.translation_m = here + turn.rotated(there - here);
      // Growth as in odometry: 7 cm and 1° per lap; heading uncertainty adds position uncertainty.
      const double way_m = length(step.translation_m);
      const Point3 moved = odom_.translation_m - here;
      for (std::size_t c = 0; c < 4; ++c) {
        covariance_[0][c] -= moved.y * covariance_[3][c];
        covariance_[1][c] += moved.x * covariance_[3][c];
      }
      for (auto& row : covariance_) {
        row[0] -= moved.y * row[3];
        row[1] += moved.x * row[3];
      }
      for (std::size_t k = 0; k < 4; ++k) covariance_[k][k] += way_m * (k < 3 ? 6e-4 : 3.5e-5);
    }
    before_ = map_from_camera;
    const Stamp now{std::int64_t{index} * 200'000'000};
    auto seen = support::things_in(view, room, map_from_camera);
    if (dark) seen.clear();
    tracks_.next(seen, odom_, DrawnRoom::kRig, now);
    Image<TrackId> ids(DrawnRoom::kSize);
    std::map<int, TrackId> track_of;
    for (const Track& track : tracks_.tracks.list) {
      if (track.object != ObjectId::none) track_of[tracks_.thing_of.at(track.id)] = track.id;
    }
    Image<float> disparity(DrawnRoom::kSize);
    for (int y = 0; y < ids.height(); ++y) {
      for (int x = 0; x < ids.width(); ++x) {
        const auto at = track_of.find(view.things(x, y));
        ids(x, y) = at == track_of.end() ? TrackId::none : at->second;
        if (dark) {
          disparity(x, y) = 1;
          continue;
        }
        disparity(x, y) = holes ? std::numeric_limits<float>::quiet_NaN() : view.disparity(x, y);
      }
    }
    LandmarkFrame frame;
    frame.index = index;
    frame.stamp = now;
    frame.odom_from_camera = odom_;
    constexpr std::array<std::size_t, 4> kOfPose{0, 1, 2, 5};
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c)
        frame.pose_covariance[kOfPose[r] * 6 + kOfPose[c]] = covariance_[r][c];
      frame.pose_covariance[kOfPose[r] * 7] += 1e-6 + (r < 3 ? unsure_m2 : unsure_rad2);
    }
    frame.is_new_segment = is_new_segment_;
    is_new_segment_ = false;
    frame.motion_refusal = motion;
    frame.odometry_suspect = suspect;
    frame.tracks = &tracks_.tracks;
    frame.cut = tracks_.cut;
    frame.ids = std::as_const(ids).view();
    frame.disparity_px = std::as_const(disparity).view();
    frame.rig = DrawnRoom::kRig;
    LandmarkUpdate step = advance_landmarks(std::move(state), frame, config);
    state = std::move(step.state);
    for (LandmarkEvent& event : step.events) events.push_back(std::move(event));
    for (const LandmarkOfTrack& t : step.tracks) {
      if (t.landmark != LandmarkId::none) things_of[t.landmark].insert(tracks_.thing_of.at(t.track));
      ++refusals[t.refusal];
      if (t.is_recognised && recognised_.insert(t.track).second) ++recognised;
    }
    ++index;
  }

  static constexpr int kLap = 110;
  static Pose on_lap(double angle) {
    return camera_at(1.5 * std::cos(angle), 1.5 * std::sin(angle), angle + 0.3);
  }
  /// One lap around the centre at 1.5 m, looking outwards; 22 s.
  void lap(const DrawnRoom& room, double first_angle = 0) {
    for (int i = 0; i < kLap; ++i) frame(room, on_lap(first_angle + kTurn * i / kLap));
  }

  [[nodiscard]] double pose_error_m() const {
    return length((state.located.map_from_odom * odom_).translation_m - before_->translation_m);
  }
  [[nodiscard]] std::vector<LandmarkEvent> of_kind(LandmarkEventKind kind) const {
    std::vector<LandmarkEvent> some;
    for (const LandmarkEvent& event : events) {
      if (event.kind == kind) some.push_back(event);
    }
    return some;
  }
  [[nodiscard]] LandmarkId of_thing(int thing) const {
    for (const auto& [id, things] : things_of) {
      if (things.contains(thing)) return id;
    }
    return LandmarkId::none;
  }
  int index = 0;

 private:
  TrueTracks tracks_;
  std::set<TrackId> recognised_;
  std::optional<Pose> before_;
  Pose odom_;
  std::array<std::array<double, 4>, 4> covariance_{};  // of odom_: x, y, z, yaw
  bool is_new_segment_ = false;
  std::mt19937 random_{11};
};

TEST(Landmarks, AreTheStaticObjectsOfARoomAndRecognisedLater) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DrawnRoom room = DrawnRoom::random(seed, 10);
    Excursion run;
    run.lap(room);
    run.lap(room);
    run.lap(room, 0.05);
    EXPECT_EQ(run.state.map.list.size(), run.things_of.size());
    EXPECT_GE(run.state.map.list.size(), 9U) << "room " << seed;
    for (const auto& [id, things] : run.things_of) EXPECT_EQ(things.size(), 1U) << "landmark " << number(id);
    EXPECT_GE(run.recognised, 14) << "room " << seed;
    EXPECT_TRUE(changes_of(run.events).empty()) << "room " << seed;
    for (const Landmark& landmark : run.state.map.list) {
      const Cylinder& thing = room.things[static_cast<std::size_t>(*run.things_of[landmark.id].begin()) - 1];
      EXPECT_LT(std::hypot(landmark.position_m.x - thing.x, landmark.position_m.y - thing.y), 0.2);
    }
  }
}

TEST(Landmarks, AreNotCreatedFromFewSightingsOrOneViewpoint) {
  const DrawnRoom room = DrawnRoom::random(3, 10);
  Excursion run;
  run.config.min_frames = 8;
  const Cylinder& thing = room.things.front();
  for (int i = 0; i < 20; ++i) run.frame(room, camera_at(0, 0, std::atan2(thing.y, thing.x)));
  EXPECT_TRUE(run.state.map.list.empty());
  EXPECT_GT(run.refusals[LandmarkRefusal::tentative], 0);
  EXPECT_GT(run.refusals[LandmarkRefusal::too_few_frames], 0);
  EXPECT_GT(run.refusals[LandmarkRefusal::one_viewpoint], 0);
  Excursion sure;
  sure.config.max_sigma = 0.005F;
  sure.lap(room);
  EXPECT_TRUE(sure.state.map.list.empty());
  EXPECT_GT(sure.refusals[LandmarkRefusal::uncertain], 0);
}

TEST(Landmarks, AreReportedMovedWithBothPositions) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DrawnRoom before = DrawnRoom::random(seed, 8);
    Excursion run;
    run.lap(before);
    // The object of the first landmark moves to a free place on the same circle.
    const int thing = *run.things_of.begin()->second.begin();
    DrawnRoom after = before;
    Cylinder& moved = after.things[static_cast<std::size_t>(thing) - 1];
    for (double angle = 0; angle < kTurn; angle += 0.1) {
      const double x = 3.6 * std::cos(angle);
      const double y = 3.6 * std::sin(angle);
      double nearest = 100;
      for (const Cylinder& c : before.things) nearest = std::min(nearest, std::hypot(c.x - x, c.y - y));
      if (nearest < 1) continue;
      moved.x = x;
      moved.y = y;
      break;
    }
    run.lap(after);
    run.lap(after);
    const auto changes = changes_of(run.events);
    ASSERT_EQ(changes.size(), 1U) << "room " << seed;
    EXPECT_EQ(changes[0].kind, LandmarkEventKind::moved);
    EXPECT_EQ(changes[0].landmark, run.things_of.begin()->first);
    const Cylinder& was = before.things[static_cast<std::size_t>(thing) - 1];
    EXPECT_NEAR(changes[0].moved_by_m.x, moved.x - was.x, 0.15);
    EXPECT_NEAR(changes[0].moved_by_m.y, moved.y - was.y, 0.15);
    EXPECT_GE(changes[0].frames.size(), 5U);
    EXPECT_GT(changes[0].probability, 0.5);
  }
}

/// A room, and the same after a thing was carried by 60 cm to a free place on the same circle.
std::optional<DrawnRoom> with_thing_beside(const DrawnRoom& room, int thing) {
  DrawnRoom after = room;
  Cylinder& moved = after.things[static_cast<std::size_t>(thing) - 1];
  const double angle = std::atan2(moved.y, moved.x), radius = std::hypot(moved.x, moved.y);
  for (const double turn : {0.6 / radius, -0.6 / radius}) {
    moved.x = radius * std::cos(angle + turn), moved.y = radius * std::sin(angle + turn);
    const bool is_free = std::ranges::all_of(room.things, [&](const Cylinder& c) {
      return c.thing == thing || std::hypot(c.x - moved.x, c.y - moved.y) > 0.9;
    });
    if (is_free) return after;
  }
  return std::nullopt;
}

TEST(Landmarks, RecognisedBesideTheirEmptyPlaceHaveMoved) {
  int rooms = 0, reported = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const DrawnRoom before = DrawnRoom::random(seed, 8);
    Excursion run;
    run.lap(before);
    // The one that has been out of view for longest but one: no track of it is left.
    const auto list = run.state.map.list;
    const auto unseen = std::ranges::min_element(
        list, {}, [&](const Landmark& l) { return l.id == list.front().id ? Stamp{INT64_MAX} : l.last; });
    const LandmarkId id = unseen->id;
    const int thing = *run.things_of.at(id).begin();
    const auto after = with_thing_beside(before, thing);
    if (!after) continue;
    ++rooms;
    // With an uncertain place, half a metre is within the gate of recognition, 16.3, but beyond 9: apart.
    for (Landmark& landmark : run.state.map.list) {
      if (landmark.id == id) landmark.covariance_m2 = {0.018, 0, 0, 0, 0.018, 0, 0, 0, 0.01};
    }
    run.lap(*after);
    run.lap(*after);  // one lap sees the thing from few places
    const auto changes = changes_of(run.events);
    ASSERT_LE(changes.size(), 1U) << "room " << seed;
    if (changes.empty()) continue;
    ++reported;
    EXPECT_EQ(changes[0].kind, LandmarkEventKind::moved);
    EXPECT_EQ(changes[0].landmark, id);
    EXPECT_NEAR(std::hypot(changes[0].moved_by_m.x, changes[0].moved_by_m.y), 0.6, 0.2);
    const Cylinder& now = after->things[static_cast<std::size_t>(thing) - 1];
    const Point3 known = find(run.state.map, id)->position_m;
    EXPECT_LT(std::hypot(known.x - now.x, known.y - now.y), 0.15) << "its old place does not count any more";
  }
  EXPECT_GE(rooms, 5);
  EXPECT_EQ(reported, rooms);
}

TEST(Landmarks, WithAWrongPlaceHaveNotMovedWhileNothingShowsIt) {
  const DrawnRoom room = DrawnRoom::random(1, 8);
  Excursion run;
  run.lap(room);
  const LandmarkId id = run.things_of.begin()->first;
  for (Landmark& landmark : run.state.map.list) {
    if (landmark.id != id) continue;
    landmark.position_m.x += 0.5;
    landmark.covariance_m2 = {0.02, 0, 0, 0, 0.02, 0, 0, 0, 0.01};
  }
  run.holes = true;  // so nothing is seen of its place
  run.lap(room);
  EXPECT_TRUE(changes_of(run.events).empty());
}

TEST(Landmarks, AreReportedGoneOnceTheirPositionIsSeenEmptyAndBackLater) {
  const DrawnRoom before = DrawnRoom::random(2, 8);
  Excursion run;
  run.lap(before);
  const LandmarkId id = run.things_of.begin()->first;
  const int thing = *run.things_of.begin()->second.begin();
  DrawnRoom after = before;
  std::erase_if(after.things, [&](const Cylinder& c) { return c.thing == thing; });
  run.lap(after);
  auto changes = changes_of(run.events);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].kind, LandmarkEventKind::gone);
  EXPECT_EQ(changes[0].landmark, id);
  EXPECT_GE(changes[0].frames.size(), 5U);
  EXPECT_TRUE(find(run.state.map, id)->is_gone);
  run.lap(before);
  EXPECT_EQ(run.of_kind(LandmarkEventKind::back).size(), 1U);
  EXPECT_FALSE(find(run.state.map, id)->is_gone);
  EXPECT_TRUE(changes_of(run.events).empty());
}

TEST(Landmarks, AreNeverGoneOutOfViewOrInHoles) {
  const DrawnRoom before = DrawnRoom::random(2, 8);
  DrawnRoom empty;
  Excursion away;
  away.lap(before);
  for (int i = 0; i < 100; ++i) away.frame(empty, camera_at(4.5, 4.5, 0.785));  // into a corner
  EXPECT_TRUE(away.of_kind(LandmarkEventKind::gone).empty());
  Excursion blind;
  blind.lap(before);
  blind.holes = true;
  blind.lap(empty);
  EXPECT_TRUE(blind.of_kind(LandmarkEventKind::gone).empty());
  // With sight, all are gone.
  Excursion sees;
  sees.lap(before);
  sees.lap(empty);
  EXPECT_GE(sees.of_kind(LandmarkEventKind::gone).size(), before.things.size() - 1);
}

TEST(Landmarks, AreNeverGoneOrNewInFramesWithAGuessedPose) {
  const DrawnRoom before = DrawnRoom::random(2, 8);
  const auto after_darkness = [&](MotionRefusal refusal, bool suspect) {
    Excursion run;
    run.lap(before);
    const auto floor = run.state.map.floor;
    const std::size_t known = run.state.map.list.size();
    run.dark = true;
    run.motion = refusal;
    run.suspect = suspect;
    run.lap(before);
    EXPECT_EQ(run.state.map.list.size(), known);
    const std::size_t gone = run.of_kind(LandmarkEventKind::gone).size();
    if (gone == 0) {
      EXPECT_EQ(run.state.map.floor, floor);
    }
    // When it is light again, the landmarks are as before.
    run.dark = false;
    run.motion = MotionRefusal::none;
    run.suspect = false;
    if (gone == 0) {
      run.lap(before);
      EXPECT_EQ(run.state.map.list.size(), known);
      EXPECT_TRUE(changes_of(run.events).empty());
    }
    return gone;
  };
  EXPECT_EQ(after_darkness(MotionRefusal::few_points, false), 0U);
  EXPECT_EQ(after_darkness(MotionRefusal::disagrees_with_prior, false), 0U);
  EXPECT_EQ(after_darkness(MotionRefusal::none, true), 0U);
  // Interpreted as observations, all would be gone.
  EXPECT_GE(after_darkness(MotionRefusal::none, false), before.things.size() - 1);
}

TEST(Landmarks, AreNewIfTheirPositionWasSeenAsFloor) {
  DrawnRoom room = DrawnRoom::random(4, 5);
  Excursion run;
  run.lap(room);
  run.lap(room);
  Cylinder fresh;
  fresh.thing = 99;
  fresh.radius = 0.2;
  fresh.height = 0.6;
  std::mt19937 random(77);
  fresh.look = support::random_look(random);
  for (double angle = 0; angle < kTurn; angle += 0.1) {
    fresh.x = 3.5 * std::cos(angle);
    fresh.y = 3.5 * std::sin(angle);
    double nearest = 100;
    for (const Cylinder& c : room.things)
      nearest = std::min(nearest, std::hypot(c.x - fresh.x, c.y - fresh.y));
    if (nearest > 1.2) break;
  }
  room.things.push_back(fresh);
  run.lap(room);
  run.lap(room);
  const auto changes = changes_of(run.events);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].kind, LandmarkEventKind::found);
  EXPECT_LT(std::hypot(changes[0].position_m.x - fresh.x, changes[0].position_m.y - fresh.y), 0.15);
}

TEST(Landmarks, HaveTheUncertaintyOfAPoseAlongTheMapsAxes) {
  const Pose quarter = rotation_about({0, 0, std::numbers::pi / 2});
  Tracks tracks;
  LandmarkFrame frame;
  frame.tracks = &tracks;
  frame.pose_covariance[0] = 0.04;  // along odometry's x, which is the map's y
  frame.pose_covariance[7] = 0.01;
  frame.pose_covariance[14] = 0.0025;
  frame.pose_covariance[21] = 0.0004;  // roll
  frame.pose_covariance[28] = 0.0001;  // pitch
  frame.pose_covariance[35] = 0.0009;
  const LandmarksState state = advance_landmarks(begin_landmarks({}, 1, quarter), frame, {}).state;
  EXPECT_NEAR(state.located.covariance[0], 0.01, 1e-12);
  EXPECT_NEAR(state.located.covariance[5], 0.04, 1e-12);
  EXPECT_NEAR(state.located.covariance[10], 0.0025, 1e-12);
  EXPECT_NEAR(state.located.covariance[15], 0.0009, 1e-12);
  // Includes the uncertainty of relocalisation; roll and pitch are odometry's.
  MapLocation located = state.located;
  located.covariance[0] += 1;
  located.covariance[3] = located.covariance[12] = 0.002;
  const Covariance6 camera = camera_covariance(located, frame.pose_covariance);
  EXPECT_NEAR(camera[0], 1.01, 1e-12);
  EXPECT_NEAR(camera[7], 0.04, 1e-12);
  EXPECT_NEAR(camera[5], 0.002, 1e-12);
  EXPECT_NEAR(camera[21], 0.0001, 1e-12);
  EXPECT_NEAR(camera[28], 0.0004, 1e-12);
  EXPECT_NEAR(camera[35], 0.0009, 1e-12);
}

TEST(Landmarks, CorrectAPathThatDrifts) {
  double with = 0;
  double without = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DrawnRoom room = DrawnRoom::random(seed, 10);
    for (const double drift : {-1e-4, 1e-4}) {  // 0.6 degrees a lap
      Excursion run;
      run.drift_rad = drift;
      run.lap(room);
      run.lap(room);
      with += run.pose_error_m();
      Excursion alone;
      alone.drift_rad = drift;
      alone.config.min_pairs = 20;
      alone.lap(room);
      alone.lap(room);
      without += alone.pose_error_m();
      EXPECT_TRUE(changes_of(run.events).empty()) << "room " << seed;
    }
  }
  EXPECT_LT(with, 0.7 * without);
}

TEST(Landmarks, LocaliseASegmentOfOdometryAndKeepItSeparateUntilThen) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DrawnRoom room = DrawnRoom::random(seed, 12);
    for (const double side : {-1.0, 1.0}) {
      Excursion run;
      run.lap(room);
      const std::size_t known = run.state.map.list.size();
      ASSERT_GE(known, 6U);
      run.break_odometry(0.35 * side, {0.5 * side, -0.4, 0});
      run.frame(room, Excursion::on_lap(1));
      EXPECT_FALSE(run.state.is_located);
      EXPECT_GT(run.state.located.covariance[0], 0.9);
      int waited = 1;
      for (; waited < Excursion::kLap && !run.state.is_located; ++waited) {
        EXPECT_EQ(run.state.map.list.size(), known) << "held apart";
        run.frame(room, Excursion::on_lap(1 + kTurn * waited / Excursion::kLap));
      }
      ASSERT_TRUE(run.state.is_located) << "room " << seed;
      EXPECT_LT(run.pose_error_m(), 0.3) << "room " << seed;
      EXPECT_EQ(run.of_kind(LandmarkEventKind::relocated).size(), 1U);
      // The uncertainty given by the landmarks, from a prior of 1 m and 30 degrees.
      EXPECT_LT(std::sqrt(run.state.located.covariance[0]), 0.25);
      EXPECT_LT(std::sqrt(run.state.located.covariance[15]), 6 * kTurn / 360);
      run.lap(room, 1);
      EXPECT_LT(run.pose_error_m(), 0.25) << "room " << seed;
      std::map<int, int> landmarks_of;
      for (const Landmark& landmark : run.state.map.list) {
        ASSERT_EQ(run.things_of[landmark.id].size(), 1U) << "landmark " << number(landmark.id);
        EXPECT_EQ(++landmarks_of[*run.things_of[landmark.id].begin()], 1) << "no thing twice";
      }
      EXPECT_TRUE(changes_of(run.events).empty()) << "room " << seed;
    }
  }
}

TEST(Landmarks, OfOneRoomAreUnaffectedByASegmentInAnother) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Excursion run;
    run.lap(DrawnRoom::random(seed, 12));
    const LandmarkMap known = run.state.map;
    run.break_odometry(0.2, {0.3, 0, 0});
    run.lap(DrawnRoom::random(100 + seed, 12));
    EXPECT_FALSE(run.state.is_located) << "room " << seed;
    ASSERT_EQ(run.state.map.list.size(), known.list.size());
    for (std::size_t i = 0; i < known.list.size(); ++i) {
      EXPECT_EQ(run.state.map.list[i].position_m, known.list[i].position_m);
      EXPECT_EQ(run.state.map.list[i].log_odds, known.list[i].log_odds);
    }
    EXPECT_EQ(run.state.map.floor, known.floor);
    EXPECT_TRUE(run.of_kind(LandmarkEventKind::relocated).empty());
    EXPECT_TRUE(changes_of(run.events).empty());
    EXPECT_GT(run.refusals[LandmarkRefusal::not_located], 0);
  }
}

TEST(Landmarks, TooFewForLocalisationAreDroppedByANewSegment) {
  const DrawnRoom room = DrawnRoom::random(2, 12);
  Excursion run;
  int i = 0;
  while (i < Excursion::kLap && run.state.map.list.empty())
    run.frame(room, Excursion::on_lap(kTurn * i++ / Excursion::kLap));
  ASSERT_EQ(run.state.map.list.size(), 1U);
  const std::int64_t next = run.state.map.next;
  run.break_odometry(0.3, {0.5, 0, 0});
  run.frame(room, Excursion::on_lap(kTurn * i++ / Excursion::kLap));
  EXPECT_TRUE(run.state.is_located);
  EXPECT_TRUE(run.state.map.list.empty());
  EXPECT_EQ(run.state.map.next, next) << "no id twice";
  EXPECT_LT(run.state.located.covariance[0], 1e-3);
  for (; i < Excursion::kLap; ++i) run.frame(room, Excursion::on_lap(kTurn * i / Excursion::kLap));
  EXPECT_GE(run.state.map.list.size(), 4U);
  EXPECT_TRUE(changes_of(run.events).empty());

  // A loaded map does not belong to this run, so it is not discarded.
  Excursion second(run.state.map, 2, Pose{});
  second.state.map.list.resize(1);
  second.break_odometry(0, {});
  second.frame(room, Excursion::on_lap(0));
  EXPECT_FALSE(second.state.is_located);
  EXPECT_EQ(second.state.map.list.size(), 1U);
}

TEST(Landmarks, HaveThePathsUncertaintyAfterAFewDarkFramesOnly) {
  const DrawnRoom room = DrawnRoom::random(1, 10);
  Excursion run;
  run.config.min_pairs = 20;  // no corrections
  for (int i = 0; i < 10; ++i) run.frame(room, Excursion::on_lap(0.01 * i));
  const double before = run.state.located.covariance[0];
  for (int i = 0; i < 10; ++i) {
    run.unsure_m2 = i % 2 == 0 ? 0.05 : 0;  // the keyframe is lost and found repeatedly
    run.motion = i % 2 == 0 ? MotionRefusal::few_points : MotionRefusal::none;
    run.frame(room, Excursion::on_lap(0.1 + 0.01 * i));
  }
  EXPECT_LT(run.state.located.covariance[0], before + 0.001);
}

TEST(Landmarks, LocaliseTheStartOfARun) {
  int right = 0;
  int wrong = 0;
  int unknown = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const DrawnRoom room = DrawnRoom::random(seed, 14);
    Excursion first;
    first.lap(room);
    first.lap(room);
    for (int start = 0; start < 6; ++start) {
      Excursion second(first.state.map, 2);
      second.odom_from_map = camera_at(0, 0, 0) * inverse(camera_at(1, -3, 0.4 + start));
      EXPECT_FALSE(second.state.is_located);
      const double from = kTurn * start / 6;
      for (int i = 0; i < Excursion::kLap && !second.state.is_located; ++i)
        second.frame(room, Excursion::on_lap(from + kTurn * i / Excursion::kLap));
      if (!second.state.is_located) {
        ++unknown;
      } else {
        ++(second.pose_error_m() < 0.3 ? right : wrong);
        EXPECT_EQ(second.of_kind(LandmarkEventKind::relocated).size(), 1U);
      }
    }
  }
  EXPECT_GE(right, 20) << right << " right, " << wrong << " wrong, " << unknown << " not known where";
  EXPECT_EQ(wrong, 0);
}

TEST(Landmarks, AHundredThousandElsewhereDisturbNoRun) {
  const DrawnRoom room = DrawnRoom::random(1, 14);
  Excursion first;
  first.lap(room);
  LandmarkMap map = first.state.map;
  const std::vector<Landmark> here = map.list;
  ASSERT_GE(here.size(), 5U);
  // The same things in other places, 100 m away and more.
  constexpr int kMany = 100'000;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> far_m(100, 1000);
  while (map.list.size() < kMany) {
    Landmark other = here[map.list.size() % here.size()];
    other.id = LandmarkId{map.next++};
    other.position_m = {far_m(random), far_m(random), other.position_m.z};
    map.list.push_back(std::move(other));
  }

  Excursion second(map, 2, Pose{});
  constexpr int kFrames = 30;
  for (int i = 0; i < kFrames; ++i) second.frame(room, Excursion::on_lap(kTurn * i / Excursion::kLap));
  EXPECT_GE(second.recognised, 3);
  EXPECT_EQ(second.state.map.list.size(), std::size_t{kMany});
  for (const auto& [id, things] : second.things_of) EXPECT_LE(number(id), number(here.back().id));
  EXPECT_TRUE(changes_of(second.events).empty());

  // A run that does not know where it begins must not be placed among the others.
  Excursion lost(std::move(map), 3);
  lost.odom_from_map = camera_at(0, 0, 0) * inverse(camera_at(1, -3, 0.4));
  for (int i = 0; i < kFrames; ++i) lost.frame(room, Excursion::on_lap(kTurn * i / Excursion::kLap));
  EXPECT_TRUE(!lost.state.is_located || lost.pose_error_m() < 0.3) << lost.pose_error_m();
}

TEST(Landmarks, DoNotLocaliseInAnotherRoom) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Excursion first;
    first.lap(DrawnRoom::random(seed, 14));
    const std::size_t known = first.state.map.list.size();
    Excursion second(first.state.map, 2);
    second.lap(DrawnRoom::random(100 + seed, 14));
    EXPECT_FALSE(second.state.is_located) << "room " << seed;
    EXPECT_EQ(second.state.map.list.size(), known);
    EXPECT_GT(second.refusals[LandmarkRefusal::not_located], 0);
  }
}

TEST(Maps, OfOneRoomAreMergedWhateverTheirOrigins) {
  const DrawnRoom room = DrawnRoom::random(5, 12);
  Excursion first;
  first.lap(room);
  first.lap(room);
  Excursion second;
  second.odom_from_map = camera_at(0, 0, 0) * inverse(camera_at(1, -3, 2));
  second.lap(room);
  second.lap(room, 1);
  const MapMerge merged = merge(first.state.map, second.state.map, std::nullopt, {});
  ASSERT_TRUE(merged.map_from_other.has_value());
  EXPECT_GE(merged.pairs.size(), 8U);
  EXPECT_EQ(merged.map.list.size(),
            first.state.map.list.size() + second.state.map.list.size() - merged.pairs.size());
  for (const LandmarkPair& pair : merged.pairs) {
    EXPECT_EQ(*second.things_of[LandmarkId{number(pair.track)}].begin(),
              *first.things_of[pair.landmark].begin());
  }
  Excursion other;
  other.lap(DrawnRoom::random(105, 12));
  EXPECT_FALSE(merge(first.state.map, other.state.map, std::nullopt, {}).map_from_other.has_value());
}

}  // namespace
}  // namespace cairn
