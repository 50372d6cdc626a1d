// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/input/true_frames.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <thread>

#include "lab/worlds/frames.hpp"
#include "lab/worlds/shapes.hpp"
#include "lab/worlds/tours.hpp"
#include "support/temporary_folder.hpp"

namespace cairn::worlds {
namespace {

/// Small worlds without the sensor's faults.
WorldOptions small(double outdoor_share) {
  WorldOptions options;
  options.size = {96, 72};
  options.outdoor_share = outdoor_share;
  return options;
}

struct Traced {
  World world;
  Rendered seen;
};

Traced traced(const WorldOptions& options, int index, int samples) {
  Traced made{make_world(options, index), {}};
  made.world.scene.rig.right_row_offset_px = 0;
  made.seen = render(made.world.scene, samples);
  return made;
}

float grey(const Picture& picture, int x, int y) {
  const Vec3 c = picture.colour[static_cast<std::size_t>(y * picture.size.width + x)];
  return (c.x + c.y + c.z) / 3;
}

double share(int part, int all) {
  return static_cast<double>(part) / std::max(1, all);
}

TEST(WorldTruth, TheRightImageShowsWhatTheDisparitySays) {
  for (const double outdoor_share : {0.0, 1.0}) {
    std::vector<double> with_truth, without;
    for (int index = 0; index < 4; ++index) {
      const auto [world, seen] = traced(small(outdoor_share), index, 16);
      for (int y = 0; y < seen.left.size.height; ++y) {
        for (int x = 0; x + 1 < seen.left.size.width; ++x) {
          const float d = seen.truth.disparity_px(x, y);
          if (seen.truth.occlusion(x, y) != 0 || d <= 0) continue;
          const float at = static_cast<float>(x) - d;
          const int left = static_cast<int>(std::floor(at));
          if (left < 0) continue;
          const float part = at - static_cast<float>(left);
          const float there = (1 - part) * grey(seen.right, left, y) + part * grey(seen.right, left + 1, y);
          const float here = grey(seen.left, x, y), scale = 0.02F + here;
          with_truth.push_back(std::abs(here - there) / scale);
          without.push_back(std::abs(here - grey(seen.right, std::max(0, left - 4), y)) / scale);
        }
      }
    }
    ASSERT_GT(with_truth.size(), 6'000U);
    const auto median = [](std::vector<double>& values) {
      std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
      return values[values.size() / 2];
    };
    const double right = median(with_truth), wrong = median(without);
    EXPECT_LT(right, 0.08) << "outdoors " << outdoor_share;
    EXPECT_LT(right, 0.7 * wrong) << "four pixels off is hardly worse, outdoors " << outdoor_share;
  }
}

TEST(WorldTruth, WhatTheRightCameraSeesHasNothingInFront) {
  int visible = 0, covered = 0, hidden = 0, explained = 0;
  for (int index = 0; index < 16; ++index) {
    const auto [world, seen] = traced(small(0.3), index, 1);
    const Truth& truth = seen.truth;
    for (int y = 0; y < truth.ids.height(); ++y) {
      for (int x = 0; x < truth.ids.width(); ++x) {
        const float d = truth.disparity_px(x, y), at = static_cast<float>(x) - d;
        bool has_nearer = at < -0.5F;
        for (int other = x + 1; other < truth.ids.width() && !has_nearer; ++other) {
          const float nearer = truth.disparity_px(other, y);
          has_nearer = nearer > d + 0.5F && std::abs(static_cast<float>(other) - nearer - at) < 0.4F;
        }
        const bool is_hidden = truth.occlusion(x, y) != 0;
        (is_hidden ? hidden : visible) += 1;
        if (has_nearer) (is_hidden ? explained : covered) += 1;
      }
    }
  }
  EXPECT_GT(hidden, visible / 50);
  EXPECT_LT(share(covered, visible), 0.02);
  // What only the right camera sees may hide a point, too.
  EXPECT_GT(share(explained, hidden), 0.7);
}

TEST(WorldTruth, TheDisparityOfAFloorIsAPlane) {
  int rooms = 0;
  for (int index = 0; index < 24; ++index) {
    const auto [world, seen] = traced(small(0), index, 1);
    const Rig& rig = world.scene.rig;
    const float floor_z = 0;
    for (int y = 0; y < rig.size.height; ++y) {
      for (int x = 0; x < rig.size.width; ++x) {
        if (seen.truth.ground(x, y) == 0) continue;
        const Vec3 ray = rig.forward + (static_cast<float>(x) - rig.cx_px) / rig.focal_px * rig.right +
                         (static_cast<float>(y) - rig.cy_px) / rig.focal_px * rig.down;
        if (ray.z > -0.02F) continue;
        const float expected = rig.focal_px * rig.baseline_m * ray.z / (floor_z - rig.eye.z);
        if (world.place == Place::table) continue;  // has rounded edges
        ASSERT_NEAR(seen.truth.disparity_px(x, y), expected, 0.002 * double{expected} + 1e-3)
            << index << " at " << x << ", " << y;
        ++rooms;
      }
    }
  }
  EXPECT_GT(rooms, 20'000);
}

TEST(WorldTruth, IdsAreThoseOfTheThings) {
  std::set<std::string> ways;
  int things = 0, empty = 0;
  for (int index = 0; index < 60; ++index) {
    const World world = make_world(small(0.25), index);
    empty += world.things.empty() ? 1 : 0;
    for (std::size_t k = 0; k < world.things.size(); ++k) {
      EXPECT_EQ(world.things[k].id, static_cast<int>(k) + 1);
      ways.insert(world.things[k].placed);
      ++things;
    }
    std::set<int> of_bodies;
    for (const Body& body : world.scene.bodies) of_bodies.insert(body.id);
    EXPECT_EQ(of_bodies.size(), world.things.size() + 1) << "the background, and one body for each thing";
  }
  EXPECT_GT(things, 150);
  EXPECT_GT(empty, 0);
  for (const char* way : {"free", "wall", "on", "touch", "edge"}) EXPECT_TRUE(ways.contains(way)) << way;
}

TEST(Worlds, OfTheYardstickNeverHaveAnotherBackground) {
  std::size_t bodies = 0, triangles = 0;
  for (int index = 0; index < 20; ++index) {
    const World world =
        make_world({.seed = 4200, .use = Use::yardstick, .size = {320, 240}, .outdoor_share = 1}, index);
    for (const Body& body : world.scene.bodies) {
      bodies += body.id == 0 ? 1 : 0;
      triangles += body.id == 0 ? body.mesh.triangles.size() : 0;
    }
  }
  EXPECT_EQ(bodies, 3181U);
  EXPECT_EQ(triangles, 2301886U);
}

TEST(Worlds, AreTheSameForTheSameNumberOnAnyThread) {
  WorldOptions options = small(0.3);
  const WorldFrame first = make_frame(make_world(options, 7), 4);
  std::array<WorldFrame, 2> others;
  {
    std::vector<std::jthread> threads;
    for (WorldFrame& other : others)
      threads.emplace_back([&] { other = make_frame(make_world(options, 7), 4); });
  }
  const auto differing = [&](const Image<Rgb>& a, const Image<Rgb>& b) {
    int count = 0;
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) count += a(x, y) == b(x, y) ? 0 : 1;
    return count;
  };
  for (const WorldFrame& other : others) {
    EXPECT_EQ(differing(first.left, other.left), 0);
    EXPECT_EQ(differing(first.right, other.right), 0);
  }
  EXPECT_GT(differing(first.left, make_frame(make_world(options, 8), 4).left), 1000) << "another number";
  options.use = Use::yardstick;
  EXPECT_GT(differing(first.left, make_frame(make_world(options, 7), 4).left), 1000) << "another use";
}

TEST(Laboratory, ShowsItsObjectsInEveryFrameFromAMovingRobot) {
  for (int sequence = 0; sequence < kLaboratorySequences; ++sequence) {
    std::vector<std::array<int, 4>> areas;
    for (const int number : {0, 100, kLaboratoryFrames - 1}) {
      const WorldFrame frame = make_frame(make_laboratory(sequence, number), 1);
      std::array<int, 4> area{};
      for (int y = 0; y < frame.left.height(); ++y)
        for (int x = 0; x < frame.left.width(); ++x) ++area.at(frame.truth.ids(x, y));
      for (std::size_t id = 1; id <= 3; ++id)
        EXPECT_EQ(area.at(id) >= 200, sequence < 3 || id < 3) << sequence << ' ' << number << ' ' << id;
      areas.push_back(area);
    }
    EXPECT_GT(areas[2][2], areas[0][2]) << "the robot comes nearer";
  }
}

/// A point of the world, from a pixel of a frame.
Vec3 point_at(const World& world, const Truth& truth, int x, int y) {
  const Rig& rig = world.scene.rig;
  const float z = rig.focal_px * rig.baseline_m / truth.disparity_px(x, y);
  return rig.eye + z * (rig.forward + (static_cast<float>(x) - rig.cx_px) / rig.focal_px * rig.right +
                        (static_cast<float>(y) - rig.cy_px) / rig.focal_px * rig.down);
}

TEST(Tours, ShowAThingThatWasCarriedWhileTheRobotLookedAway) {
  int carried = 0, moving = 0, tours = 0;
  for (int index = 0; index < 8; ++index) {
    const Tour tour = make_tour(small(0), index);
    ++tours;
    const int last = static_cast<int>(tour.path.size()) - 1;
    const auto things_at = [&](int frame) {
      const World world = world_of(tour, frame);
      const Truth truth = truth_of(world.scene);
      std::map<int, std::pair<Vec3, int>> middles;
      for (int y = 0; y < truth.ids.height(); ++y) {
        for (int x = 0; x < truth.ids.width(); ++x) {
          auto& [sum, count] = middles[truth.ids(x, y)];
          sum = sum + point_at(world, truth, x, y), ++count;
        }
      }
      return middles;
    };
    for (const Move& move : tour.moves) {
      const bool is_carried = move.first_frame == move.last_frame;
      (is_carried ? carried : moving) += 1;
      const Thing before =
          world_of(tour, move.first_frame - 1).things.at(static_cast<std::size_t>(move.id - 1));
      const Thing after = world_of(tour, move.last_frame).things.at(static_cast<std::size_t>(move.id - 1));
      EXPECT_NEAR(before.centre.x, move.from.x, 1e-4);
      EXPECT_NEAR(after.centre.x, move.to.x, 1e-4);
      EXPECT_NEAR(after.centre.y, move.to.y, 1e-4);
      EXPECT_GT(std::hypot(move.to.x - move.from.x, move.to.y - move.from.y), 0.5F);
      if (!is_carried) continue;
      EXPECT_FALSE(things_at(move.first_frame).contains(move.id)) << "while it is carried, nobody looks";
      const auto early = things_at(tour.first_look - 1), late = things_at(last);
      ASSERT_TRUE(early.contains(move.id) && late.contains(move.id)) << index;
      // Its visible points are around the place that the truth names.
      for (const auto& [seen, at] :
           {std::pair(early.at(move.id), move.from), std::pair(late.at(move.id), move.to)}) {
        const Vec3 middle = 1.0F / static_cast<float>(seen.second) * seen.first;
        const float reach =
            worlds::length(tour.world.things.at(static_cast<std::size_t>(move.id - 1)).size_m) / 2;
        EXPECT_LT(std::hypot(middle.x - at.x, middle.y - at.y), reach);
      }
    }
    // What stands still is at one place for all frames, so the poses are right.
    const auto early = things_at(0), late = things_at(last);
    for (const Thing& thing : tour.world.things) {
      if (std::ranges::find(tour.moves, thing.id, &Move::id) != tour.moves.end()) continue;
      for (const auto& frame : {early, late}) {
        if (!frame.contains(thing.id)) continue;
        const Vec3 middle = 1.0F / static_cast<float>(frame.at(thing.id).second) * frame.at(thing.id).first;
        EXPECT_LT(worlds::length(middle - thing.centre), worlds::length(thing.size_m) / 2 + 0.01F)
            << thing.kind;
      }
    }
    EXPECT_EQ(things_at(tour.first_look + 20).size(), 1U) << "looks away from all things";
  }
  EXPECT_GE(carried, tours / 2);
  EXPECT_GE(moving, 1);
}

TEST(Tours, AreWrittenAsASequenceWithItsTruth) {
  const support::TemporaryFolder folder;
  const Tour tour = make_tour(small(0), 0);
  ASSERT_FALSE(tour.moves.empty());
  for (int i = 0; i < 3; ++i)
    write_frame(make_frame(world_of(tour, i), 1), folder.path() / std::to_string(i));
  write_tour_files(tour, folder.path());
  const input::TrueSequence truth = input::load_truth(folder.path());
  ASSERT_EQ(truth.frames.size(), 3U);
  ASSERT_TRUE(truth.has_events);
  ASSERT_EQ(truth.events.size(), tour.moves.size());
  EXPECT_EQ(truth.events.back().id, tour.moves.back().id);
  ASSERT_TRUE(truth.frames[1].world_from_camera);
  EXPECT_NEAR(truth.frames[1].world_from_camera->translation_m.x, tour.path[1].at.x, 1e-3);
  EXPECT_FALSE(truth.frames[1].places.empty());
}

TEST(Projector, LightsTheSamePointsForBothCameras) {
  WorldOptions options = small(0);
  options.size = {320, 240};  // a spot needs a pixel
  World world = make_world(options, 3);
  world.scene.rig.right_row_offset_px = 0;
  const Rendered dark = render(world.scene, 4);
  world.scene.has_projector = true;
  const Rendered lit = render(world.scene, 4);
  const auto spot = [&](const Picture& with, const Picture& without, int x, int y) {
    return grey(with, x, y) - grey(without, x, y);
  };
  int spots = 0, shared = 0, visible = 0;
  for (int y = 0; y < lit.left.size.height; ++y) {
    for (int x = 0; x < lit.left.size.width; ++x) {
      EXPECT_EQ(lit.truth.disparity_px(x, y), dark.truth.disparity_px(x, y));
      const int right = static_cast<int>(std::lround(static_cast<float>(x) - lit.truth.disparity_px(x, y)));
      if (spot(lit.left, dark.left, x, y) < 0.05F) continue;
      ++spots;
      if (lit.truth.occlusion(x, y) != 0 || right < 1) continue;
      ++visible;
      float seen = 0;
      for (const int beside : {-1, 0, 1})
        seen = std::max(seen, spot(lit.right, dark.right, std::min(right + beside, 319), y));
      shared += seen > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(spots, 100);
  EXPECT_GT(share(shared, visible), 0.9);
  world.sensor.is_grey = true;
  const support::TemporaryFolder folder;
  write_frame(make_frame(world, 1), folder.path() / "world");
  const Image<float> depth = io::load_depth(folder.path() / "world" / "depth.png");
  const StereoRig rig = *io::load_calibration(folder.path() / "world" / "calib.txt").rig;
  const auto point = rig.point_in_camera_m(0, 0, lit.truth.disparity_px(160, 200));
  ASSERT_TRUE(point);
  EXPECT_NEAR(depth(160, 200), point->z, 2e-3);
}

TEST(Worlds, AreWrittenAsADataSetOfFrames) {
  const support::TemporaryFolder folder;
  const WorldFrame frame = make_frame(make_world(small(0), 3), 1);
  write_frame(frame, folder.path() / "world");
  const io::LoadedPair pair =
      io::load_pair(folder.path() / "world" / "left.png", folder.path() / "world" / "right.png");
  EXPECT_EQ(pair.left.gray.size(), frame.left.size());
  const io::Calibration calibration = io::load_calibration(folder.path() / "world" / "calib.txt");
  ASSERT_TRUE(calibration.rig.has_value());
  EXPECT_NEAR(calibration.rig->baseline_m, frame.world.scene.rig.baseline_m, 1e-5);
  const Image<float> disparity = io::load_disparity(folder.path() / "world" / "disp_left.png");
  float most = 0;
  for (int y = 0; y < disparity.height(); ++y) {
    for (int x = 0; x < disparity.width(); ++x) {
      most = std::max(most, frame.truth.disparity_px(x, y));
      const float d = frame.truth.disparity_px(x, y);
      if (d > 0 && d < 255) {
        EXPECT_NEAR(disparity(x, y), d, 1.0 / 256);
      }
    }
  }
  EXPECT_GT(calibration.num_disparities.value_or(0), static_cast<int>(std::min(most, 500.0F)));
}

}  // namespace
}  // namespace cairn::worlds
