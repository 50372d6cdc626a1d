// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <cairn/sequence/warp.hpp>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// Z = 100 · 0.1 / 5 = 2 m, where a pixel is 2 cm wide.
constexpr StereoRig kRig{.focal_px = 100, .cx_px = 20, .cy_px = 10, .baseline_m = 0.1F, .doffs_px = 0};
constexpr Size kSize{40, 20};

struct Scene {
  Objects objects{Image<ObjectId>(kSize, ObjectId::none, {}), {}};
  DisparityMap disparity{Image<float>(kSize, 1.0F, {}), Image<Reject>(kSize, Reject::none, {})};
  Tracks tracks;

  /// Tracks get ids from 1.
  void add(Rect rect, float d) {
    Object object;
    object.id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
    object.pixel_count = rect.width * rect.height;
    objects.list.push_back(object);
    Track track;
    track.id = TrackId{tracks.next++};
    track.state = TrackState::confirmed;
    track.object = object.id;
    tracks.list.push_back(track);
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      for (int x = rect.x; x < rect.x + rect.width; ++x) {
        objects.labels(x, y) = object.id;
        disparity.disparity_px(x, y) = d;
      }
    }
  }
  [[nodiscard]] MaskMemory remembered(const Pose& pose = {}) const {
    return remember({}, tracks, objects, disparity, pose, {}, kRig);
  }
};

MaskPrediction warped(const Scene& scene, const Pose& pose, std::int64_t now_ns = 100'000'000) {
  return warp(scene.remembered(), scene.tracks, pose, Stamp{now_ns}, kRig, kSize, {});
}

int count(const MaskPrediction& warped, std::int64_t id) {
  int found = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) found += warped.ids(x, y) == TrackId{id} ? 1 : 0;
  return found;
}

TEST(Warp, AStaticCameraSeesTheSame) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  scene.disparity.disparity_px(10, 5) = kNan;  // at a corner: not enclosed
  const MaskPrediction now = warped(scene, {});
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const bool is_in = x >= 10 && x < 16 && y >= 5 && y < 9 && !(x == 10 && y == 5);
      EXPECT_EQ(now.ids(x, y), is_in ? TrackId{1} : TrackId::none) << x << "," << y;
      EXPECT_EQ(std::isnan(now.disparity_px(x, y)), !is_in);
    }
  }
  EXPECT_NEAR(now.disparity_px(12, 6), 5, 1e-5);
  ASSERT_EQ(now.masks.size(), 1U);
  EXPECT_EQ(now.masks[0].area, 23);
  EXPECT_EQ(now.masks[0].in_view, 1);
}

TEST(Warp, ObjectsMoveLeftIfTheCameraMovesRight) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  Pose pose;
  pose.translation_m = {0.06, 0, 0};  // 3 px
  const MaskPrediction now = warped(scene, pose);
  EXPECT_EQ(now.ids(7, 5), TrackId{1});
  EXPECT_EQ(now.ids(12, 8), TrackId{1});
  EXPECT_EQ(now.ids(13, 8), TrackId::none);
  EXPECT_EQ(count(now, 1), 24);
}

TEST(Warp, ThePositionInTheMapDoesNotDependOnTheCamera) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  Pose before = rotation_about({0.3, -0.2, 0.9});
  before.translation_m = {4, 5, -6};
  const MaskPrediction now = warp(scene.remembered(before), scene.tracks, before, Stamp{1}, kRig, kSize, {});
  EXPECT_EQ(count(now, 1), 24);
  EXPECT_EQ(now.ids(10, 5), TrackId{1});
}

TEST(Warp, TheNearerOneHidesTheFarther) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);   // 2 m
  scene.add({16, 5, 6, 4}, 10);  // 1 m: moves twice as far
  Pose pose;
  pose.translation_m = {0.06, 0, 0};
  const MaskPrediction now = warped(scene, pose);
  EXPECT_EQ(now.ids(9, 5), TrackId{1});  // 10 … 15 moved to 7 … 12, 16 … 21 to 10 … 15
  EXPECT_EQ(now.ids(10, 5), TrackId{2});
  EXPECT_EQ(count(now, 1), 12);
  EXPECT_EQ(now.masks[0].area, 24);
}

TEST(Warp, GapsOfOnePixelAreClosedAndWiderOnesAreNot) {
  Scene scene;
  scene.add({15, 5, 10, 10}, 5);
  Pose nearer;
  nearer.translation_m = {0, 0, 0.8};  // 1.2 m before it: 10 px become 15 … 16
  const MaskPrediction now = warped(scene, nearer);
  EXPECT_GT(count(now, 1), 200);
  Pose much_nearer;
  much_nearer.translation_m = {0, 0, 1.5};  // 0.5 m: every fourth pixel
  EXPECT_LT(count(warped(scene, much_nearer), 1), 101);
}

TEST(Warp, AMovingTrackFollowsItsVelocity) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  scene.tracks.list[0].velocity_m_s = {0.4, 0, 0};
  EXPECT_EQ(warped(scene, {}).ids(10, 5), TrackId{1});  // it has a velocity, but is labelled static
  scene.tracks.list[0].is_moving = true;
  const MaskPrediction now = warped(scene, {});  // 0.1 s later: 2 px
  EXPECT_EQ(now.ids(11, 5), TrackId::none);
  EXPECT_EQ(now.ids(12, 5), TrackId{1});
  EXPECT_EQ(now.ids(17, 5), TrackId{1});
}

TEST(Warp, PixelsOutsideTheImageAreCounted) {
  Scene scene;
  scene.add({0, 5, 10, 4}, 5);
  Pose pose;
  pose.translation_m = {0.12, 0, 0};  // 6 px
  const MaskPrediction now = warped(scene, pose);
  EXPECT_NEAR(now.masks[0].in_view, 0.4, 1e-6);
  Pose turned = rotation_about({0, 3.14159265, 0});
  EXPECT_EQ(warped(scene, turned).masks[0].in_view, 0);  // behind the camera
}

TEST(Warp, ADeadTrackIsNotShown) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  const MaskMemory before = scene.remembered();
  const MaskPrediction now = warp(before, Tracks{}, {}, Stamp{1}, kRig, kSize, {});
  EXPECT_EQ(count(now, 1), 0);
  EXPECT_TRUE(now.masks.empty());
}

TEST(Remember, AMaskStaysUntilItsTrackIsSeenAgain) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  scene.add({25, 5, 3, 3}, 4);
  MaskMemory memory = scene.remembered();
  ASSERT_EQ(memory.masks.size(), 2U);
  EXPECT_EQ(memory.masks[0].points.size(), 24U);
  EXPECT_EQ(memory.masks[1].points.size(), 9U);

  Scene next;
  next.add({12, 5, 2, 2}, 5);
  next.tracks = scene.tracks;
  next.tracks.list[1].object = ObjectId::none;  // not seen
  memory = remember(std::move(memory), next.tracks, next.objects, next.disparity, {}, Stamp{7}, kRig);
  ASSERT_EQ(memory.masks.size(), 2U);
  EXPECT_EQ(memory.masks[0].points.size(), 4U);
  EXPECT_EQ(memory.masks[0].seen, Stamp{7});
  EXPECT_EQ(memory.masks[1].points.size(), 9U);
  EXPECT_EQ(memory.masks[1].seen, Stamp{0});

  next.tracks.list[0].is_joined = true;  // seen together with another: not its own mask
  next.tracks.list.pop_back();           // dead
  memory = remember(std::move(memory), next.tracks, next.objects, next.disparity, {}, Stamp{8}, kRig);
  ASSERT_EQ(memory.masks.size(), 1U);
  EXPECT_EQ(memory.masks[0].seen, Stamp{7});
}

TEST(Remember, PiecesAreOneMask) {
  Scene scene;
  scene.add({10, 5, 6, 4}, 5);
  scene.add({16, 5, 3, 3}, 5);
  scene.tracks.list.pop_back();
  scene.tracks.list[0].parts = {ObjectId{2}};
  const MaskMemory memory = scene.remembered();
  ASSERT_EQ(memory.masks.size(), 1U);
  EXPECT_EQ(memory.masks[0].points.size(), 33U);
}

TEST(OverlapsOf, CountsCurrentPixelsWhereATrackIsExpected) {
  Scene scene;
  scene.add({10, 5, 10, 4}, 5);
  const MaskMemory memory = scene.remembered();
  Scene now;
  now.add({8, 5, 6, 4}, 5);   // common: columns 10 … 13
  now.add({14, 5, 2, 4}, 7);  // nearer, columns 14 and 15
  for (int y = 5; y < 9; ++y) now.disparity.disparity_px(16, y) = kNan;
  // Columns 17 … 19 show the background, at 1 px.
  const Overlaps found = overlaps_of(warp(memory, scene.tracks, {}, Stamp{1}, kRig, kSize, {}), scene.tracks,
                                     now.objects, now.disparity);
  ASSERT_EQ(found.tracks, std::vector{TrackId{1}});
  EXPECT_EQ(found.area[0], 40);
  EXPECT_EQ(found.predicted[0], 40);
  EXPECT_EQ(found.in_view[0], 1);
  EXPECT_EQ(found.at(0, ObjectId{1}), 16);
  EXPECT_EQ(found.at(0, ObjectId{2}), 8);
  EXPECT_EQ(found.nearer[0], 8);
}

}  // namespace
}  // namespace cairn
