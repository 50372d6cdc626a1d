// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/calibration_files.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/sequence/landmarks.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <support/collection.hpp>
#include <support/true_tracks.hpp>

/// Recognition alone: true masks and disparities of a rendered tour, on a path with the drift of odometry.
namespace cairn {
namespace {

namespace fs = std::filesystem;

fs::path tour() {
  return collection() / "rendered/tour_train";
}

Pose pose_in(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  Pose pose;
  std::vector<double> v;
  while (std::getline(in, line)) {
    if (line.starts_with("#")) continue;
    std::istringstream row(line);
    for (double x = 0; row >> x;) v.push_back(x);
  }
  EXPECT_EQ(v.size(), 16U);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) pose.rotation[3 * r + c] = v[4 * r + c];
  }
  pose.translation_m = {v[3], v[7], v[11]};
  return pose;
}

struct TourFrame {
  Pose map_from_camera;
  StereoRig rig;
  Image<Rgb> rgb;
  Image<Gray> left;
  Image<Gray> right;
  Image<float> disparity;
  Image<std::uint16_t> things;
};

const std::vector<TourFrame>& frames() {
  static const std::vector<TourFrame> all = [] {
    std::vector<TourFrame> list;
    for (int i = 0; i < 1000; ++i) {
      char name[8];
      std::snprintf(name, sizeof name, "%03d", i);
      const fs::path folder = tour() / name;
      if (!fs::exists(folder)) break;
      TourFrame frame;
      frame.map_from_camera = pose_in(folder / "pose.txt");
      frame.rig = *io::load_calibration(folder / "calib.txt").rig;
      io::LoadedPair pair = io::load_pair(folder / "left.png", folder / "right.png");
      frame.rgb = std::move(pair.left.rgb);
      frame.left = std::move(pair.left.gray);
      frame.right = std::move(pair.right.gray);
      frame.disparity = io::load_disparity(folder / "disp_left.png");
      frame.things = io::load_labels(folder / "objects.png").ids;
      list.push_back(std::move(frame));
    }
    return list;
  }();
  return all;
}

struct Outcome {
  int recognised = 0;  // tracks of objects that already were landmarks
  int wrong = 0;
  bool is_located = false;
  std::vector<LandmarkEvent> events;
  LandmarkMap map;
  std::map<LandmarkId, int> thing_of;
  double error_m = 0;  // at the end of the path, with the map
  double error_without_m = 0;
  double ms_per_frame = 0;
};

/// `drift`: share of the distance, and degrees over the whole tour. `odom_from_world`: for a run with unknown
/// start.
Outcome drive(double drift, double turn_deg, LandmarkMap known, int first_frame,
              const std::optional<Pose>& odom_from_world, std::map<LandmarkId, int> thing_of) {
  Outcome outcome;
  outcome.thing_of = std::move(thing_of);
  support::TrueTracks true_tracks;
  LandmarksState state = begin_landmarks(std::move(known), outcome.thing_of.empty() ? 1 : 2);
  const LandmarksConfig config;
  Pose odom;
  double way = 0;
  std::map<TrackId, bool> counted;
  double seconds = 0;
  const int count = static_cast<int>(frames().size());
  for (int i = first_frame; i < count; ++i) {
    const TourFrame& f = frames()[static_cast<std::size_t>(i)];
    if (i == first_frame) {
      odom = odom_from_world.value_or(Pose{}) * f.map_from_camera;
    } else {
      const Pose step =
          inverse(frames()[static_cast<std::size_t>(i) - 1].map_from_camera) * f.map_from_camera;
      Pose wrong = rotation_about({0, turn_deg * 3.14159 / 180 / count, 0});
      wrong.translation_m = (1 + drift) * step.translation_m;
      wrong.rotation =
          (rotation_about(rotation_vector(step)) * rotation_about({0, turn_deg * 3.14159 / 180 / count, 0}))
              .rotation;
      odom = odom * wrong;
      way += length(step.translation_m);
    }
    const Stamp now{static_cast<std::int64_t>(i) * 200'000'000};

    std::map<int, support::TrueTracks::Seen> things;
    std::map<int, std::vector<float>> depths;
    std::map<int, std::array<double, 7>> sums;  // x, y, count, box
    for (int y = 0; y < f.things.height(); ++y) {
      for (int x = 0; x < f.things.width(); ++x) {
        const int thing = f.things(x, y);
        if (thing == 0 || thing == 255) continue;
        auto [at, is_new] = sums.try_emplace(thing, std::array<double, 7>{0, 0, 0, 1e9, -1, 1e9, -1});
        auto& s = at->second;
        s[0] += x;
        s[1] += y;
        s[2] += 1;
        s[3] = std::min(s[3], static_cast<double>(x));
        s[4] = std::max(s[4], static_cast<double>(x));
        s[5] = std::min(s[5], static_cast<double>(y));
        s[6] = std::max(s[6], static_cast<double>(y));
        support::count_colour(things[thing].look, f.rgb(x, y));
        if (std::isfinite(f.disparity(x, y))) depths[thing].push_back(f.disparity(x, y));
      }
    }
    std::vector<support::TrueTracks::Seen> seen;
    std::map<int, std::size_t> at_of;
    for (auto& [thing, s] : sums) {
      constexpr double kMin = 80;
      if (s[2] < kMin || depths[thing].size() < 40) continue;
      auto& d = depths[thing];
      std::nth_element(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2), d.end());
      const auto p = f.rig.point_in_camera_m(static_cast<float>(s[0] / s[2]), static_cast<float>(s[1] / s[2]),
                                             d[d.size() / 2]);
      auto& one = things[thing];
      support::normalise(one.look, s[2]);
      one.thing = thing;
      one.in_camera_m = {static_cast<double>(p->x), static_cast<double>(p->y), static_cast<double>(p->z)};
      one.extent_m = {static_cast<float>(s[4] - s[3] + 1) * p->z / f.rig.focal_px,
                      static_cast<float>(s[6] - s[5] + 1) * p->z / f.rig.focal_px, 0.2F};
      one.is_cut = s[3] < 1 || s[5] < 1 || s[4] > f.things.width() - 2 || s[6] > f.things.height() - 2;
      one.is_moving = thing == 6 && i >= 6 && i <= 22;
      one.height_over_floor_m = static_cast<float>(f.map_from_camera(one.in_camera_m).z);
      at_of[thing] = seen.size();
      seen.push_back(one);
    }
    true_tracks.next(seen, odom, f.rig, now);
    Image<TrackId> ids(f.things.size());
    std::map<int, TrackId> track_of;
    for (const auto& [id, thing] : true_tracks.thing_of) {
      for (const Track& track : true_tracks.tracks.list) {
        if (track.id == id) track_of[thing] = id;
      }
    }
    for (int y = 0; y < ids.height(); ++y) {
      for (int x = 0; x < ids.width(); ++x) {
        const auto at = at_of.find(f.things(x, y));
        ids(x, y) = at == at_of.end() ? TrackId::none : track_of[at->first];
      }
    }
    LandmarkFrame frame;
    frame.index = i;
    frame.stamp = now;
    frame.odom_from_camera = odom;
    const double sigma = 0.01 * way + 0.001;
    const double yaw = 0.02 * way / 8 + 0.0005;
    for (std::size_t k = 0; k < 3; ++k) frame.pose_covariance[k * 7] = sigma * sigma;
    frame.pose_covariance[35] = yaw * yaw;
    frame.tracks = &true_tracks.tracks;
    frame.cut = true_tracks.cut;
    frame.ids = std::as_const(ids).view();
    frame.disparity_px = f.disparity.view();
    frame.left_rgb = f.rgb.view();
    frame.rig = f.rig;
    const auto began = std::chrono::steady_clock::now();
    LandmarkUpdate step = advance_landmarks(std::move(state), frame, config);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    state = std::move(step.state);
    for (const LandmarkEvent& event : step.events) {
      outcome.events.push_back(event);
    }
    for (const LandmarkOfTrack& t : step.tracks) {
      if (t.landmark == LandmarkId::none) continue;
      const int thing = true_tracks.thing_of.at(t.track);
      outcome.thing_of.try_emplace(t.landmark, thing);
      if (t.is_recognised && !counted[t.track]) {
        counted[t.track] = true;
        const bool is_right = outcome.thing_of[t.landmark] == thing;
        ++outcome.recognised;
        outcome.wrong += is_right ? 0 : 1;
      }
    }
    if (i == count - 1) {
      outcome.error_without_m = length(odom.translation_m - f.map_from_camera.translation_m);
      outcome.error_m =
          length(state.located.map_from_odom(odom.translation_m) - f.map_from_camera.translation_m);
    }
  }
  outcome.ms_per_frame = 1000 * seconds / (count - first_frame);
  outcome.map = state.map;
  outcome.is_located = state.is_located;
  return outcome;
}

/// The complete pipeline: segmentation, tracking and its own odometry.
Outcome follow() {
  Outcome outcome;
  const LandmarksConfig config;
  FollowConfig following;
  following.segmentation.match.num_disparities = 64;
  Follower follower(following, frames().front().rig);
  LandmarksState state = begin_landmarks({}, 1);
  std::map<TrackId, bool> counted;
  std::map<TrackId, std::map<int, int>> votes;
  Pose map_from_world;
  double seconds = 0;
  for (std::size_t i = 0; i < frames().size(); ++i) {
    const TourFrame& f = frames()[i];
    const TrackedFrame step = follower.next(StereoPair::from(f.left.view(), f.right.view(), f.rgb.view()),
                                            Stamp{static_cast<std::int64_t>(i) * 200'000'000});
    if (i == 0) map_from_world = step.map_from_camera * inverse(f.map_from_camera);
    for (int y = 0; y < step.ids.height(); ++y) {
      for (int x = 0; x < step.ids.width(); ++x) {
        if (step.ids(x, y) != TrackId::none) ++votes[step.ids(x, y)][f.things(x, y)];
      }
    }
    const auto thing_of = [&](TrackId track) {
      const auto& v = votes[track];
      return v.empty() ? -1 : std::max_element(v.begin(), v.end(), [](auto a, auto b) {
                                return a.second < b.second;
                              })->first;
    };
    const LandmarkFrame frame = landmark_frame(step, f.rig, f.left.view(), f.rgb.view());
    const auto began = std::chrono::steady_clock::now();
    LandmarkUpdate marked = advance_landmarks(std::move(state), frame, config);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    state = std::move(marked.state);
    for (const LandmarkOfTrack& t : marked.tracks) {
      if (t.landmark == LandmarkId::none) continue;
      const int thing = thing_of(t.track);
      outcome.thing_of.try_emplace(t.landmark, thing);
      if (t.is_recognised && !counted[t.track]) {
        counted[t.track] = true;
        ++outcome.recognised;
        outcome.wrong += outcome.thing_of[t.landmark] == thing ? 0 : 1;
      }
    }
    for (const LandmarkEvent& event : marked.events) {
      const Point3 by = inverse(map_from_world).rotated(event.moved_by_m);
      outcome.events.push_back(event);
      outcome.events.back().moved_by_m = by;
    }
    if (i + 1 == frames().size()) {
      const Pose truth = map_from_world * f.map_from_camera;
      outcome.error_without_m = length(step.map_from_camera.translation_m - truth.translation_m);
      outcome.error_m =
          length(state.located.map_from_odom(step.map_from_camera.translation_m) - truth.translation_m);
    }
  }
  outcome.ms_per_frame = 1000 * seconds / static_cast<double>(frames().size());
  outcome.map = state.map;
  outcome.is_located = state.is_located;
  return outcome;
}

class TourTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(tour())) GTEST_SKIP() << "no " << tour();
  }
};

/// Content of events.json: object 5 is carried from (0.95, 1.6) to (1.05, 2.6) while out of view.
void expect_the_one_change(const Outcome& o) {
  const auto changes = changes_of(o.events);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].kind, LandmarkEventKind::moved);
  EXPECT_EQ(o.thing_of.at(changes[0].landmark), 5);
  EXPECT_LT(std::hypot(changes[0].moved_by_m.x - 0.1, changes[0].moved_by_m.y - 1.0), 0.15);
  EXPECT_GE(changes[0].frames.size(), 5U);
}

TEST_F(TourTest, ObjectsAreRecognisedFromElsewhereAndTheCarriedOneIsMoved) {
  double with = 0;
  double without = 0;
  for (const auto& [drift, turn] : {std::pair{0.0, 0.0}, {0.01, 1.0}, {-0.01, -1.0}}) {
    const Outcome o = drive(drift, turn, {}, 0, std::nullopt, {});
    EXPECT_EQ(o.map.list.size(), 7U);
    EXPECT_GE(o.recognised, 5);  // four static ones and the carried one
    EXPECT_EQ(o.wrong, 0);
    expect_the_one_change(o);
    if (drift != 0) with += o.error_m;
    without += o.error_without_m;
    std::cout << "drift " << drift << ": end error " << o.error_m << " m, without the map "
              << o.error_without_m << " m; " << o.ms_per_frame << " ms a frame\n";
  }
  EXPECT_LT(with, 0.8 * without);
}

TEST_F(TourTest, OurOwnObjectsAndTracksGiveTheSameReport) {
  const Outcome o = follow();
  EXPECT_GE(o.map.list.size(), 7U);
  EXPECT_EQ(o.wrong, 0);
  expect_the_one_change(o);
  std::cout << "end error " << o.error_m << " m, without the map " << o.error_without_m << " m; "
            << o.ms_per_frame << " ms a frame\n";
}

TEST_F(TourTest, ASecondRunLocalisesItselfWhereverItBegins) {
  const Outcome first = drive(0, 0, {}, 0, std::nullopt, {});
  int right = 0;
  int wrong = 0;
  int unknown = 0;
  for (const int begin : {0, 5, 10, 15, 20, 83, 86, 89}) {
    Pose elsewhere = rotation_about({0, 0, 0.7 * begin});
    elsewhere.translation_m = {3, -1.0 * begin, 0};
    const Outcome o = drive(0, 0, first.map, begin, elsewhere, first.thing_of);
    if (!o.is_located) {
      ++unknown;
    } else {
      ++(o.error_m < 0.3 ? right : wrong);
    }
    EXPECT_EQ(o.wrong, 0) << "begun at frame " << begin;
  }
  std::cout << "relocation: " << right << " right, " << wrong << " wrong, " << unknown
            << " not known where\n";
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(right, 6);
}

}  // namespace
}  // namespace cairn
