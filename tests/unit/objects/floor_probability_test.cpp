// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/objects/floor_probability.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/region_features.hpp>
#include <cmath>
#include <limits>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{40, 20};
// The horizon is row 4: d = y − 4, so the camera's height is that of the image's lower border.
constexpr GroundPlane kFloor{0, 1, -4};

/// Two superpixels side by side on a floor; the refined disparities are those of the floor, and likely.
struct Scene {
  DisparityMap disparity;
  Image<float> confidence, refined, likely;
  Image<RegionId> superpixels;
  Image<ObjectId> objects;
  Image<ObjectHint> hints{{20, 10}, ObjectHint{}, {}};
  Ground ground{kFloor, 1, 0, Refusal::none};
  Background background{{kFloor}, true};

  explicit Scene(Size size = kSize)
      : disparity{Image<float>(size), Image<Reject>(size, Reject::none, {})},
        confidence(size, 0.5F, {}),
        refined(size),
        likely(size, 0.9F, {}),
        superpixels(size),
        objects(size, ObjectId::none, {}) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        superpixels(x, y) = RegionId{x < size.width / 2 ? 0 : 1};
        disparity.disparity_px(x, y) = refined(x, y) = kFloor.disparity_px(0, static_cast<float>(y));
      }
    }
  }
  [[nodiscard]] ObstacleCues cues() const {
    return {disparity, {}, confidence, ground, background, superpixels, objects, refined, likely};
  }
  [[nodiscard]] FloorGroups groups(const std::optional<StereoRig>& rig = {}, int threads = 1) const {
    return group_by_floor(cues(), hints, rig, {}, Exec::with_threads(threads));
  }
};

std::size_t feature(std::string_view name) {
  const auto names = floor_feature_names();
  const auto at = std::find(names.begin(), names.end(), name);
  EXPECT_NE(at, names.end()) << name;
  return static_cast<std::size_t>(at - names.begin());
}
FloorFeatures features(const FloorGroups& groups, int superpixel, FloorKind kind) {
  return groups.features.at(FloorGroups::group(RegionId{superpixel}, kind));
}

TEST(GroupByFloor, LikelyRefinedDisparitiesSayWhatAPixelIs) {
  Scene scene;
  scene.disparity.disparity_px(3, 10) = 20;  // corrected by its refined one
  scene.disparity.disparity_px(4, 10) = 20;
  scene.likely(4, 10) = kLikelyRefined - 0.01F;
  scene.disparity.disparity_px(5, 10) = 1;
  scene.likely(5, 10) = 0;
  scene.disparity.disparity_px(6, 10) = kNan;
  scene.likely(6, 10) = 0;
  scene.objects(7, 10) = ObjectId{1};
  scene.disparity.reject(8, 10) = Reject::sky;
  const FloorGroups groups = scene.groups();
  EXPECT_EQ(groups.kinds(3, 10), FloorKind::on_floor);
  EXPECT_EQ(groups.kinds(4, 10), FloorKind::in_front);
  EXPECT_EQ(groups.kinds(5, 10), FloorKind::behind);
  EXPECT_EQ(groups.kinds(6, 10), FloorKind::hole);
  EXPECT_EQ(groups.kinds(7, 10), FloorKind::not_judged);
  EXPECT_EQ(groups.kinds(8, 10), FloorKind::not_judged);
  EXPECT_EQ(groups.kinds(9, 4), FloorKind::not_judged) << "at the horizon";
  EXPECT_EQ(groups.kinds(9, 5), FloorKind::on_floor);
  EXPECT_EQ(groups.pixels[FloorGroups::group(RegionId{0}, FloorKind::in_front)], 1);
  EXPECT_EQ(groups.pixels[FloorGroups::group(RegionId{1}, FloorKind::on_floor)], 20 * 15 / 2);
}

TEST(GroupByFloor, AWallHidesTheFloor) {
  Scene scene;
  scene.background.planes.push_back({0, 0, 3});
  const FloorGroups groups = scene.groups();
  EXPECT_EQ(groups.kinds(9, 6), FloorKind::not_judged);
  EXPECT_EQ(groups.kinds(9, 7), FloorKind::on_floor);
}

TEST(GroupByFloor, DescribesAGroupAndItsSuperpixel) {
  Scene scene;
  for (int y = 10; y < 12; ++y) {
    for (int x = 0; x < 20;
         ++x) {  // a tenth of the first superpixel: matches 4 px in front, no refined disparity
      scene.disparity.disparity_px(x, y) += 4;
      scene.refined(x, y) = kNan;
      scene.likely(x, y) = 0;
    }
    scene.disparity.disparity_px(8 + y, y) = kNan;
  }
  for (int x = 0; x < 10; ++x) scene.hints(x, 5).object = 32;  // rows 10 and 11 of the first superpixel
  const FloorFeatures front = features(scene.groups(), 0, FloorKind::in_front);
  EXPECT_EQ(front[feature("matched: in front of the floor, px")], 4);
  EXPECT_EQ(front[feature("matched: confidence")], 0.5F);
  EXPECT_EQ(front[feature("refined: in front of the floor, px")], kUnknown);
  EXPECT_EQ(front[feature("refined: confidence")], 0);
  EXPECT_EQ(front[feature("height above the floor, share of the camera's")], kUnknown);
  EXPECT_EQ(front[feature("hints: object")], 2);
  EXPECT_FLOAT_EQ(front[feature("superpixel: hints: object")], 0.2F);
  EXPECT_EQ(front[feature("superpixel: share of the image")], 0.5F);
  EXPECT_FLOAT_EQ(front[feature("disparity of the floor, share of its nearest")], 6.5F / 15);
  EXPECT_FLOAT_EQ(front[feature("height in the image")], 10.5F / 20);
  EXPECT_FLOAT_EQ(front[feature("superpixel: matched, share")], 198.0F / 200);
  EXPECT_FLOAT_EQ(front[feature("superpixel: matched in front of the floor, share")], 18.0F / 200);
  EXPECT_FLOAT_EQ(front[feature("superpixel: refined on the floor, by confidence")],
                  180.0F / 200 * 230 / 256);
}

TEST(GroupByFloor, HeightsAreSharesOfTheCamerasWhateverTheCalibrationsOffset) {
  Scene scene;
  for (int x = 0; x < 20; ++x) scene.refined(x, 12) = 8 + 4;  // half as high as the camera at disparity 8
  const FloorFeatures plain = features(scene.groups(), 0, FloorKind::in_front);
  EXPECT_FLOAT_EQ(plain[feature("height above the floor, share of the camera's")], 0.5F);
  const StereoRig rig{.focal_px = 100, .cx_px = 20, .cy_px = 4, .baseline_m = 0.2F, .doffs_px = 8};
  const FloorFeatures offset = features(scene.groups(rig), 0, FloorKind::in_front);
  EXPECT_FLOAT_EQ(offset[feature("height above the floor, share of the camera's")], 0.25F);
}

TEST(FloorProbability, IsThatOfTheTreesForEachGroup) {
  Scene scene;
  for (int x = 0; x < 20; ++x) scene.refined(x, 12) += 4;
  const std::vector<FittedTrees::Node> nodes{
      {static_cast<std::int16_t>(feature("kind")), 1, 1.5F}, {-1, 0, 3}, {-1, 0, -3}};
  const FittedTrees on_floor_is_floor(0, std::vector<std::int16_t>{0}, nodes);
  const Image<float> likely = floor_probability(scene.groups(), scene.superpixels, on_floor_is_floor, {});
  EXPECT_GT(likely(3, 11), 0.95F);
  EXPECT_LT(likely(3, 12), 0.05F);
  EXPECT_TRUE(std::isnan(likely(3, 2))) << "above the horizon";
  scene.ground = {};
  EXPECT_TRUE(std::isnan(floor_probability(scene.groups(), scene.superpixels, on_floor_is_floor, {})(3, 11)));
}

TEST(GroupByFloor, UnknownInputsAreUnknownOrTrusted) {
  Scene scene;
  ObstacleCues cues = scene.cues();
  cues.confidence = {};
  const FloorFeatures floor = features(group_by_floor(cues, {}, {}, {}, {}), 0, FloorKind::on_floor);
  EXPECT_EQ(floor[feature("hints: object")], kUnknown);
  EXPECT_EQ(floor[feature("superpixel: hints: object")], kUnknown);
  EXPECT_EQ(floor[feature("matched: confidence")], 1);
}

TEST(GroupByFloor, ReflectionsAreTheFloorThatTheyHide) {
  Scene scene;
  Image<float> surface = scene.disparity.disparity_px.clone();
  for (int x = 0; x < 20; ++x) {
    scene.disparity.disparity_px(x, 12) = kNan;
    scene.likely(x, 12) = 0;
  }
  EXPECT_EQ(scene.groups().kinds(3, 12), FloorKind::hole);
  ObstacleCues cues = scene.cues();
  cues.surface_disparity_px = surface;
  EXPECT_EQ(group_by_floor(cues, scene.hints, {}, {}, {}).kinds(3, 12), FloorKind::on_floor);
}

TEST(FloorProbability, ASuperpixelBetweenThePixelsLookedAtIsNotJudged) {
  Scene scene;
  scene.superpixels(4, 11) = RegionId{2};  // the last one
  const FittedTrees all_floor(3, std::vector<std::int16_t>{}, std::vector<FittedTrees::Node>{});
  const Image<float> likely = floor_probability(scene.groups(), scene.superpixels, all_floor, {});
  EXPECT_TRUE(std::isnan(likely(4, 11)));
  EXPECT_GT(likely(5, 11), 0.9F);
}

TEST(GroupByFloor, DoesNotDependOnThreadsOrTargets) {
  Scene scene(Size{40, 300});  // more rows than one parallel range
  for (int y = 0; y < 300; y += 3) scene.refined(y % 40, y) += static_cast<float>(y % 7);
  scene.disparity.reject(7, 30) = Reject::sky | Reject::left_right;
  const FloorGroups one = scene.groups();
  for (const Target target : supported_targets()) {
    const FloorGroups three =
        group_by_floor(scene.cues(), scene.hints, {}, {}, Exec::with_threads(3, target));
    EXPECT_EQ(one.features, three.features);
    EXPECT_EQ(one.pixels, three.pixels);
    for (int y = 0; y < 300; ++y)
      EXPECT_TRUE(std::equal(one.kinds.row(y), one.kinds.row(y) + 40, three.kinds.row(y)));
  }
}

}  // namespace
}  // namespace cairn
