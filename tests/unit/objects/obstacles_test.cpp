// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/objects/obstacles.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{80, 60};
// 1 m above the floor, looking ahead: the horizon is row 20, d = 0.2·(y − 20).
constexpr StereoRig kRig{.focal_px = 100, .cx_px = 40, .cy_px = 20, .baseline_m = 0.2F, .doffs_px = 0};
constexpr GroundPlane kFloor{0, 0.2F, -4};
constexpr GroundPlane kWall{0, 0, 2};  // 10 m ahead, from row 30 up

/// A room: floor and a wall, with correct disparities.
struct Room {
  DisparityMap disparity;
  Image<float> confidence;
  Image<RegionId> superpixels;
  Image<ObjectId> objects;
  Ground ground{kFloor, 1, 0, Refusal::none};
  Background background{{kFloor, kWall}, true};
  Image<float> floor_probability;

  explicit Room(Size size = kSize)
      : disparity{Image<float>(size, kNan, {}), Image<Reject>(size, Reject::none, {})},
        confidence(size, 0.9F, {}),
        superpixels(size, RegionId{0}, {}),
        objects(size, ObjectId::none, {}) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        disparity.disparity_px(x, y) = std::max(2.0F, kFloor.disparity_px(0, static_cast<float>(y)));
        superpixels(x, y) = RegionId{y / 10 * 8 + x / 10};  // squares of 10 px
      }
    }
  }
  void board(Rect box, float d) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      std::fill_n(disparity.disparity_px.row(y) + box.x, box.width, d);
    }
  }
  [[nodiscard]] ObstacleCues cues() const {
    return {disparity,   {},      confidence,          ground, background,
            superpixels, objects, View<const float>{}, {},     floor_probability};
  }
  [[nodiscard]] Image<ObstacleLabel> space(int threads = 1) const {
    return label_obstacles(cues(), kRig, {}, Exec::with_threads(threads));
  }
  [[nodiscard]] ObstacleScan scan(const ObstaclesConfig& config) const {
    const Image<ObstacleLabel> shown = space();
    return scan_obstacles(shown, disparity.disparity_px, *floor_frame(kFloor, kRig), kRig, config);
  }
  [[nodiscard]] ObstacleGrid grid(const ObstaclesConfig& config) const {
    const Image<ObstacleLabel> shown = space();
    return map_obstacles(shown, disparity.disparity_px, *floor_frame(kFloor, kRig), kRig, config);
  }
  [[nodiscard]] std::vector<RejectedObstacle> left_out(const std::vector<float>& likeliest,
                                                       const std::optional<StereoRig>& rig,
                                                       int threads = 1) const {
    const Image<ObstacleLabel> shown = space();
    return rejected_obstacles(shown, cues(), likeliest, rig, {.min_area = 50, .wall_tolerance_px = 1},
                              Exec::with_threads(threads));
  }
};

TEST(LabelSpace, TheFloorIsFreeAndWallsAreObstacles) {
  const Image<ObstacleLabel> space = Room().space();
  EXPECT_EQ(space(5, 55), ObstacleLabel::floor);
  EXPECT_EQ(space(40, 35), ObstacleLabel::floor);
  EXPECT_EQ(space(40, 5), ObstacleLabel::obstacle);  // the wall, above the horizon
  EXPECT_EQ(space(40, 22), ObstacleLabel::obstacle);
}

TEST(LabelSpace, PixelsAboveTheFloorAreObstaclesEvenIfNoObject) {
  Room room;
  room.board({30, 35, 8, 12}, 8);
  const Image<ObstacleLabel> space = room.space();
  EXPECT_EQ(space(33, 36), ObstacleLabel::obstacle);
  EXPECT_EQ(space(33, 52), ObstacleLabel::floor);
}

TEST(LabelSpace, AHoleIsUnknown) {
  Room room;
  room.disparity.disparity_px(45, 55) = kNan;
  EXPECT_EQ(room.space()(45, 55), ObstacleLabel::unknown);
}

TEST(LabelSpace, TheProbabilityOfTheFloorDecidesWhereItIsKnown) {
  Room room;
  room.board({30, 35, 8, 12}, 8);
  room.floor_probability = Image<float>(kSize, kNan, {});
  room.floor_probability(33, 38) = kLikelyFloor;
  room.floor_probability(34, 38) = kLikelyFloor - 0.01F;
  room.floor_probability(45, 55) = kUnlikelyFloor;
  room.floor_probability(46, 55) = kUnlikelyFloor - 0.01F;
  room.disparity.disparity_px(46, 55) = kNan;
  room.objects(33, 39) = ObjectId{1};
  room.floor_probability(33, 39) = 1;
  const Image<ObstacleLabel> space = room.space();
  EXPECT_EQ(space(33, 38), ObstacleLabel::floor);
  EXPECT_EQ(space(34, 38), ObstacleLabel::unknown);
  EXPECT_EQ(space(45, 55), ObstacleLabel::unknown);
  EXPECT_EQ(space(46, 55), ObstacleLabel::obstacle);
  EXPECT_EQ(space(33, 39), ObstacleLabel::obstacle) << "an object goes first";
  EXPECT_EQ(space(35, 38), ObstacleLabel::obstacle) << "by its disparity";
}

TEST(LabelSpace, UnreliableDisparitiesAreNoObstacle) {
  Room room;
  room.board({30, 35, 8, 12}, 8);
  room.confidence(33, 38) = 0.4F;
  const Image<ObstacleLabel> space = room.space();
  EXPECT_EQ(space(33, 38), ObstacleLabel::unknown);
  EXPECT_EQ(space(34, 38), ObstacleLabel::obstacle);
}

TEST(LabelSpace, AnObjectIsAnObstacleWithItsHoles) {
  Room room;
  room.objects(45, 55) = ObjectId{1};
  room.disparity.disparity_px(45, 55) = kNan;
  EXPECT_EQ(room.space()(45, 55), ObstacleLabel::obstacle);
}

TEST(LabelSpace, WhatIsRejectedAsSkyIsSky) {
  Room room;
  room.disparity.disparity_px(15, 5) = kNan;
  room.disparity.reject(15, 5) = Reject::sky;
  EXPECT_EQ(room.space()(15, 5), ObstacleLabel::sky);
  EXPECT_EQ(room.space()(16, 5), ObstacleLabel::obstacle) << "the wall";
  room.objects(15, 5) = ObjectId{1};
  EXPECT_EQ(room.space()(15, 5), ObstacleLabel::obstacle) << "an object goes first";
}

TEST(LabelSpace, WithoutAnyPlaneAllThatIsNearerThanInfinityIsAnObstacle) {
  Room room;
  room.ground = {};
  room.background = {};
  room.objects(45, 55) = ObjectId{1};
  room.disparity.disparity_px(46, 55) = kNan;
  room.disparity.disparity_px(47, 55) = GroundConfig{}.margin;
  room.confidence(48, 55) = 0.4F;
  const Image<ObstacleLabel> space = room.space();
  EXPECT_EQ(space(45, 55), ObstacleLabel::obstacle);
  EXPECT_EQ(space(46, 55), ObstacleLabel::unknown);
  EXPECT_EQ(space(47, 55), ObstacleLabel::unknown);
  EXPECT_EQ(space(48, 55), ObstacleLabel::unknown);
  EXPECT_EQ(space(49, 55), ObstacleLabel::obstacle);
}

TEST(LeftOutOf, WithoutAnyPlaneWhateverIsNotAnObjectIsListed) {
  Room room;
  room.ground = {};
  room.background = {};
  const std::vector<RejectedObstacle> left_out = room.left_out({}, kRig);
  ASSERT_FALSE(left_out.empty());
  for (const RejectedObstacle& left : left_out) EXPECT_NE(left.reason, RejectionReason::background);
}

TEST(LabelSpace, WithoutAFloorObstaclesAreInFrontOfTheWalls) {
  Room room;
  room.ground = {};
  room.background = {{kWall}, false};
  room.board({30, 2, 8, 8}, 5);
  const Image<ObstacleLabel> space = room.space();
  EXPECT_EQ(space(33, 5), ObstacleLabel::obstacle);
  EXPECT_EQ(space(60, 5), ObstacleLabel::unknown);
}

TEST(LabelSpace, DoesNotDependOnThreads) {
  Room room(Size{80, 300});  // more rows than one parallel range
  room.board({30, 35, 8, 220}, 80);
  const Image<ObstacleLabel> one = room.space();
  const Image<ObstacleLabel> three = room.space(3);
  EXPECT_EQ(room.left_out({}, kRig).size(), 2U);
  EXPECT_EQ(room.left_out({}, kRig, 3).front().pixel_count, room.left_out({}, kRig).front().pixel_count);
  for (int y = 0; y < one.height(); ++y)
    EXPECT_TRUE(std::equal(one.row(y), one.row(y) + one.width(), three.row(y)));
}

TEST(FloorOf, IsTheFloorOfTheSpace) {
  const Image<ObstacleLabel> space = Room().space();
  const Image<std::uint8_t> floor = floor_of(space, {});
  EXPECT_EQ(floor(5, 55), 255);
  EXPECT_EQ(floor(40, 5), 0);
}

// ---- scan and grid ----

TEST(ScanObstacles, HasTheNearestInEachDirection) {
  Room room;
  room.board({60, 30, 10, 20}, 10);  // 2 m ahead and (65 − 40)·2/100 = 0.5 m to the right
  const ObstacleScan scan = room.scan({.max_height = 3, .range = 20, .cell_size = 0.05F});
  const auto range_at = [&](double x, double y) {
    const double angle = std::atan2(y, x);
    return scan.ranges_m.at(
        static_cast<std::size_t>(std::lround((angle - scan.angle_min_rad) / scan.angle_increment_rad)));
  };
  EXPECT_NEAR(range_at(2, -0.5), std::hypot(2, 0.5), 0.02);
  EXPECT_NEAR(range_at(10, 1), 10, 0.2);  // the wall
}

TEST(ScanObstacles, IgnoresPointsAboveTheHeightOrBeyondTheRange) {
  Room room;
  room.board({60, 5, 10, 10}, 10);  // 0.1 to 0.3 m above the camera, which is 1 m above the floor
  const auto scan = [&](float height, float range) {
    return room.scan({.max_height = height, .range = range, .cell_size = 0.05F});
  };
  const auto seen = [](const ObstacleScan& s) {
    return std::count_if(s.ranges_m.begin(), s.ranges_m.end(), [](float r) { return !std::isnan(r); });
  };
  EXPECT_GT(seen(scan(2, 5)), 3);
  EXPECT_EQ(seen(scan(1, 5)), 0);
  EXPECT_EQ(seen(scan(2, 1)), 0);
}

TEST(ScanObstacles, IsAsWideAsTheImageOnTheFloor) {
  // With a pitch of 30 degrees, the lower corner sees farther to the side than the middle row.
  GroundConfig config;
  config.source = GroundSource::pose;
  config.known.camera_height_m = 1.0F;
  config.known.camera_pitch_deg = 30;
  const StereoRig rig{.focal_px = 300, .cx_px = 159.5F, .cy_px = 119.5F, .baseline_m = 0.1F, .doffs_px = 4};
  const Image<float> none({320, 240}, kNan, {});
  const GroundPlane plane = *fit_ground(none.view(), rig, config, {}).plane;
  const FloorFrame floor = *floor_frame(plane, rig);
  Image<ObstacleLabel> space({320, 240}, ObstacleLabel::unknown, {});
  Image<float> d({320, 240}, kNan, {});
  for (int y = 230; y < 240; ++y) {
    for (int x = 0; x < 4; ++x) {
      space(x, y) = ObstacleLabel::obstacle;
      d(x, y) = plane.disparity_px(static_cast<float>(x), static_cast<float>(y)) + 2;
    }
  }
  const ObstacleScan scan = scan_obstacles(space, d, floor, rig, {});
  std::size_t seen = scan.ranges_m.size();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!std::isnan(scan.ranges_m[i])) seen = i;
  }
  ASSERT_LT(seen, scan.ranges_m.size());
  const Vec3 corner = floor.to_floor(*rig.point_in_camera_m(1, 235, d(1, 235)));
  const float angle = scan.angle_min_rad + static_cast<float>(seen) * scan.angle_increment_rad;
  EXPECT_NEAR(angle, std::atan2(corner.y, corner.x), 0.03);
  EXPECT_GT(angle, 32 * std::numbers::pi / 180);  // a level camera's view ends at 28
  EXPECT_EQ(scan.range_max_m, 6);
}

TEST(ScanObstacles, ThreeWrongPixelsAreNoObstacle) {
  Room room;
  room.board({60, 40, 1, 3}, 30);
  const auto scan = [&] { return room.scan({.max_height = 2, .range = 3, .cell_size = 0.05F}); };
  for (const float range : scan().ranges_m) EXPECT_TRUE(std::isnan(range));
  room.board({60, 40, 1, 4}, 30);
  const std::vector<float> ranges = scan().ranges_m;
  EXPECT_TRUE(std::any_of(ranges.begin(), ranges.end(), [](float r) { return r < 1; }));
}

TEST(MapObstacles, KnowsFreeOccupiedAndUnknown) {
  Room room;
  room.board({36, 25, 8, 25}, 10);  // 2 m ahead
  const ObstacleGrid grid = room.grid({.max_height = 2, .range = 5, .cell_size = 0.1F});
  EXPECT_EQ(grid.width, 50);
  EXPECT_EQ(grid.height, 100);
  const auto at = [&](float x, float y) {
    const auto column = static_cast<std::size_t>((x - grid.origin_x_m) / grid.cell_size_m);
    const auto row = static_cast<std::size_t>((y - grid.origin_y_m) / grid.cell_size_m);
    return grid.cells.at(row * static_cast<std::size_t>(grid.width) + column);
  };
  EXPECT_EQ(at(2.05F, 0.05F), ObstacleGrid::kOccupied);
  EXPECT_EQ(at(3.05F, 1.05F), ObstacleGrid::kFree);     // floor next to it
  EXPECT_EQ(at(4.05F, 0.05F), ObstacleGrid::kUnknown);  // hidden behind it
  EXPECT_EQ(at(0.55F, 0.05F), ObstacleGrid::kUnknown);  // nearer than the image shows
  EXPECT_EQ(at(1.05F, 4.05F), ObstacleGrid::kUnknown);  // outside of the view
}

// ---- obstacles left out ----

TEST(LeftOutOf, HasAReasonForEachObstacle) {
  Room room;
  room.board({30, 32, 12, 14}, 12);  // an obstacle: 168 px
  room.board({60, 40, 4, 3}, 14);    // a small one: 12 px
  room.board({10, 32, 10, 10}, 16);  // an object
  for (int y = 32; y < 42; ++y) std::fill_n(room.objects.row(y) + 10, 10, ObjectId{1});
  const std::vector<float> likeliest(48, 0.125F);
  const auto left = room.left_out(likeliest, kRig);
  ASSERT_EQ(left.size(), 3U);
  EXPECT_EQ(left[0].reason, RejectionReason::too_small);  // sorted by distance
  EXPECT_EQ(left[0].box_px, (Rect{60, 40, 4, 3}));
  EXPECT_EQ(left[1].reason, RejectionReason::low_confidence);
  EXPECT_EQ(left[1].box_px, (Rect{30, 32, 12, 14}));
  EXPECT_EQ(left[1].pixel_count, 12 * 14);
  EXPECT_EQ(left[1].confidence, 0.125F);
  ASSERT_TRUE(left[1].position_in_camera_m);
  EXPECT_NEAR(left[1].position_in_camera_m->z, 20.0 / 12, 1e-3);
  EXPECT_EQ(left[2].reason, RejectionReason::background);
  EXPECT_EQ(left[2].disparity_px, 2);
}

TEST(LeftOutOf, IgnoresSpecks) {
  Room room;
  room.board({60, 40, 2, 1}, 14);  // 2 of 4800 px: less than 0.05 %
  const auto left = room.left_out({}, {});
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].reason, RejectionReason::background);
  EXPECT_FALSE(left[0].position_in_camera_m);  // no rig
}

TEST(LeftOutOf, AnObjectSplitsAnObstacleOfItsDisparity) {
  Room room;
  room.board({30, 32, 12, 14}, 12);
  for (int y = 32; y < 46; ++y) room.objects(36, y) = ObjectId{1};  // through the centre
  for (const int threads : {1, 3}) {
    const auto left = room.left_out({}, kRig, threads);
    ASSERT_EQ(left.size(), 3U);
    EXPECT_EQ(left[0].pixel_count + left[1].pixel_count, 11 * 14);
  }
}

/// A pixel each. Obstacles: by the refined disparity; by the match, as that is unlikely; on the floor; an object on the
/// floor. Floor: off the floor; on it; a hole.
TEST(ObstacleDisparities, AreThoseThatDoNotContradictTheLabel) {
  const auto filled = [](std::initializer_list<float> values) {
    Image<float> image({static_cast<int>(values.size()), 1});
    std::copy(values.begin(), values.end(), image.row(0));
    return image;
  };
  Image<ObstacleLabel> space({7, 1}, ObstacleLabel::floor, {});
  std::fill_n(space.row(0), 4, ObstacleLabel::obstacle);
  Image<ObjectId> objects({7, 1}, ObjectId::none, {});
  objects(3, 0) = ObjectId{1};
  const DisparityMap disparity{filled({kNan, 9, 5.5F, 5.5F, 9, 5.5F, kNan}),
                               Image<Reject>({7, 1}, Reject::none, {})};
  const Image<float> refined = filled({12, 4, 5, 5, 5, 5, 5});
  const Image<float> likely = filled({0.9F, 0.5F, 0.5F, 0.5F, 0.9F, 0.9F, 0.9F});
  const Ground ground{GroundPlane{0, 0, 5}, 1, 0, Refusal::none};
  const Background background;
  const Image<float> d =
      obstacle_disparities(space, {disparity, {}, {}, ground, background, {}, objects, refined, likely}, {});
  EXPECT_EQ(d(0, 0), 12);
  EXPECT_EQ(d(1, 0), 9);
  EXPECT_TRUE(std::isnan(d(2, 0)));
  EXPECT_EQ(d(3, 0), 5.5F);
  EXPECT_TRUE(std::isnan(d(4, 0)));
  EXPECT_EQ(d(5, 0), 5.5F);
  EXPECT_TRUE(std::isnan(d(6, 0)));
  EXPECT_EQ(obstacle_disparities(space, {disparity, {}, {}, ground, background, {}, objects}, {})(4, 0), 9)
      << "without refined disparities, a label comes from the match";
}

}  // namespace
}  // namespace cairn
