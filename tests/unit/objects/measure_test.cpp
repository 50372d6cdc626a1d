// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/image/noise.hpp>
#include <cairn/objects/measure.hpp>
#include <cmath>
#include <limits>

#include "support/grids.hpp"

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A background of region 0 with rectangles as regions 1, 2, …; each region has one disparity.
struct Scene {
  Image<RegionId> labels;
  std::vector<bool> is_background;
  DisparityMap disparity;
  Image<Gray> left;

  Scene(Size size, const std::vector<std::pair<Rect, float>>& boards)
      : labels(size, RegionId{0}, {}),
        is_background{false},
        disparity{Image<float>(size, 2.0F, {}), Image<Reject>(size, Reject::none, {})},
        left(size, Gray{10}, {}) {
    for (const auto& [rect, d] : boards) {
      const RegionId id{static_cast<std::int32_t>(is_background.size())};
      for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
          labels(x, y) = id;
          disparity.disparity_px(x, y) = d;
          left(x, y) = static_cast<Gray>(100 + number(id));
        }
      }
      is_background.push_back(false);
    }
  }
  [[nodiscard]] Objects measured(const ObjectsConfig& config = {}) const {
    return measure(labels, is_background, disparity, {left, {}, noise_sigma(left)}, config, {});
  }
  [[nodiscard]] Objects measured_as_chosen(const std::vector<float>& scores, int threads = 1) const {
    return measure(labels, scores, disparity, {left, {}, noise_sigma(left)}, Exec::with_threads(threads));
  }
  [[nodiscard]] Objects measured_in_colour(View<const Rgb> rgb) const {
    return measure(labels, is_background, disparity, {left, rgb, noise_sigma(left)}, {}, {});
  }
};

TEST(Measure, NumbersObjectsNearestFirst) {
  const Objects objects =
      Scene({40, 20}, {{{2, 2, 5, 5}, 8}, {{10, 2, 5, 5}, 16}, {{20, 2, 5, 5}, 4}}).measured();
  ASSERT_EQ(objects.list.size(), 3U);
  EXPECT_EQ(objects.list[0].id, ObjectId{1});
  EXPECT_EQ(objects.list[0].disparity_px, 16);
  EXPECT_EQ(objects.list[0].box_px, (Rect{10, 2, 5, 5}));
  EXPECT_EQ(objects.list[2].disparity_px, 4);
  EXPECT_EQ(objects.labels(3, 3), ObjectId{2});
  EXPECT_EQ(objects.labels(0, 0), ObjectId::none);
}

TEST(Measure, DecidesEqualDisparitiesInRasterOrder) {
  const Objects objects =
      Scene({40, 20}, {{{20, 8, 5, 5}, 8}, {{2, 9, 5, 5}, 8}, {{10, 2, 5, 5}, 8}}).measured();
  EXPECT_EQ(objects.list[0].box_px.x, 10);
  EXPECT_EQ(objects.list[1].box_px.x, 20);
  EXPECT_EQ(objects.list[2].box_px.x, 2);
}

TEST(Measure, TheBackgroundIsNoObject) {
  Scene scene({40, 20}, {{{2, 2, 5, 5}, 8}, {{10, 2, 5, 5}, 9}});
  scene.is_background[1] = true;
  const Objects objects = scene.measured();
  ASSERT_EQ(objects.list.size(), 1U);
  EXPECT_EQ(objects.list[0].box_px.x, 10);
}

TEST(Measure, ARegionAtThreeBordersIsBackground) {
  const Scene scene({40, 20}, {{{0, 15, 40, 5}, 8}, {{0, 0, 10, 10}, 9}});
  const Objects objects = scene.measured();
  ASSERT_EQ(objects.list.size(), 1U);  // the corner touches two
  EXPECT_EQ(objects.list[0].disparity_px, 9);
}

TEST(Measure, ARegionOutsideTheAreaLimitsIsNoObject) {
  const Scene scene({40, 20}, {{{2, 2, 20, 12}, 8}, {{30, 2, 4, 2}, 9}});  // 30 % and 1 %
  EXPECT_EQ(scene.measured({.min_area = 1, .max_area = 30}).list.size(), 2U);
  EXPECT_EQ(scene.measured({.min_area = 1, .max_area = 29.9F}).list.size(), 1U);
  EXPECT_EQ(scene.measured({.min_area = 1.1F, .max_area = 30}).list.size(), 1U);
}

TEST(Measure, ARegionWithoutDisparityIsNoObject) {
  EXPECT_TRUE(Scene({40, 20}, {{{2, 2, 5, 5}, kNan}}).measured().list.empty());
}

TEST(Measure, UsesTheMedianOverValidPixels) {
  Scene scene({40, 20}, {{{2, 2, 2, 2}, 8}});
  scene.disparity.disparity_px(2, 2) = 100;
  scene.disparity.disparity_px(3, 2) = kNan;
  Objects objects = scene.measured();
  EXPECT_EQ(objects.list[0].disparity_px, 8);
  EXPECT_FLOAT_EQ(objects.list[0].valid_share, 0.75F);
  scene.disparity.disparity_px(3, 2) = 9;  // 8 8 9 100
  objects = scene.measured();
  EXPECT_EQ(objects.list[0].disparity_px, 8.5F);
}

TEST(Measure, CountsEdgesAlongTheOutline) {
  Scene scene({40, 20}, {{{10, 5, 4, 4}, 8}});
  const auto edges = [&] { return scene.measured().list[0].edge_share; };
  scene.left = Image<Gray>(Size{40, 20}, 100, {});
  EXPECT_EQ(edges(), 0);
  for (int y = 0; y < 20; ++y) std::fill_n(scene.left.row(y), 10, Gray{140});  // an edge along its left side
  EXPECT_EQ(edges(), 0.25F);
  scene.left(20, 2) = 200;  // elsewhere
  EXPECT_EQ(edges(), 0.25F);
}

TEST(Measure, FindsAnEdgeInColourThatGreyDoesNotShow) {
  Scene scene({40, 20}, {{{10, 5, 4, 4}, 8}});
  scene.left = Image<Gray>(Size{40, 20}, 100, {});
  Image<Rgb> rgb(Size{40, 20}, Rgb{100, 100, 100}, {});
  for (int y = 5; y < 9; ++y) std::fill_n(rgb.row(y) + 10, 4, Rgb{100, 60, 140});
  const Objects objects = scene.measured_in_colour(rgb);
  EXPECT_EQ(objects.list[0].edge_share, 1);
}

TEST(Measure, ReportsTheShareOfTheOutlineAtTheImageBorder) {
  const Objects objects = Scene({40, 20}, {{{0, 5, 4, 4}, 8}, {{10, 5, 4, 4}, 9}}).measured();
  EXPECT_EQ(objects.list[0].cut_share, 0);
  EXPECT_EQ(objects.list[1].cut_share, 0.25F);
}

TEST(Measure, IsMoreConfidentOfLargeOutlinedCompleteObjects) {
  const auto confidence = [](Rect box, bool outlined, int holes = 0) {
    Scene scene({40, 20}, {{box, 8}});
    scene.left = Image<Gray>(Size{40, 20}, 100, {});
    for (int y = box.y; outlined && y < box.y + box.height; ++y)
      std::fill_n(scene.left.row(y) + box.x, box.width, Gray{200});
    for (int i = 0; i < holes; ++i) scene.disparity.disparity_px(box.x + i % 4, box.y + i / 4) = kNan;
    return scene.measured({.min_area = 0, .max_area = 100}).list.at(0).confidence;
  };
  const float whole = confidence({10, 5, 4, 4}, true);
  EXPECT_GT(whole, 0.8F);
  EXPECT_LE(whole, 1);
  EXPECT_LT(confidence({10, 5, 4, 4}, false), 0.01F);
  EXPECT_LT(confidence({10, 5, 2, 2}, true), whole);
  EXPECT_LT(confidence({0, 5, 4, 4}, true), whole);
  EXPECT_EQ(confidence({10, 5, 4, 4}, true, 8), whole);
  EXPECT_FLOAT_EQ(confidence({10, 5, 4, 4}, true, 12), whole / 2);
}

TEST(Measure, ARegionBelowTheConfidenceThresholdGetsNoNumber) {
  Scene scene({40, 20}, {{{2, 2, 5, 5}, 16}, {{10, 2, 5, 5}, 8}, {{20, 2, 5, 5}, 12}, {{30, 2, 5, 5}, 4}});
  for (int y = 0; y < 20; ++y) {  // the first and the third have no outline
    for (const int x : {2, 20}) std::fill_n(scene.left.row(y) + x, 5, Gray{10});
  }
  ASSERT_EQ(scene.measured().list.size(), 4U);
  const Objects objects = scene.measured({.min_confidence = 0.2F});
  ASSERT_EQ(objects.list.size(), 2U);
  EXPECT_EQ(objects.list[0].id, ObjectId{1});
  EXPECT_EQ(objects.list[0].disparity_px, 8);
  EXPECT_EQ(objects.list[1].id, ObjectId{2});
  EXPECT_EQ(objects.list[1].disparity_px, 4);
  EXPECT_EQ(objects.labels(4, 4), ObjectId::none);
  EXPECT_EQ(objects.labels(12, 4), ObjectId{1});
  EXPECT_EQ(objects.labels(22, 4), ObjectId::none);
  EXPECT_EQ(objects.labels(32, 4), ObjectId{2});
}

TEST(Measure, ARegionAtTheConfidenceThresholdIsAnObject) {
  const Scene scene({40, 20}, {{{2, 2, 5, 5}, 8}});
  const float confidence = scene.measured().list.at(0).confidence;
  EXPECT_EQ(scene.measured({.min_confidence = confidence}).list.size(), 1U);
  EXPECT_TRUE(scene.measured({.min_confidence = std::nextafter(confidence, 1.0F)}).list.empty());
}

TEST(Measure, UsesTheMeanColourOfTheMask) {
  Scene scene({40, 20}, {{{2, 2, 2, 1}, 8}});
  EXPECT_EQ(scene.measured().list[0].mean_colour, (Rgb{101, 101, 101}));
  Image<Rgb> rgb(Size{40, 20}, Rgb{1, 2, 3}, {});
  rgb(2, 2) = {10, 20, 31};
  rgb(3, 2) = {20, 40, 60};
  const Objects objects = scene.measured_in_colour(rgb);
  EXPECT_EQ(objects.list[0].mean_colour, (Rgb{15, 30, 46}));
}

TEST(MeasureChosen, UsesTheScoresAsConfidences) {
  const Objects objects =
      Scene({40, 20}, {{{2, 2, 5, 5}, 8}, {{10, 2, 5, 5}, 16}}).measured_as_chosen({0, 0.25F, 0.5F});
  ASSERT_EQ(objects.list.size(), 2U);
  EXPECT_EQ(objects.list[0].disparity_px, 16);  // nearest first
  EXPECT_EQ(objects.list[0].confidence, 0.5F);
  EXPECT_EQ(objects.list[1].confidence, 0.25F);
  EXPECT_EQ(objects.labels(3, 3), ObjectId{2});
  EXPECT_EQ(objects.labels(12, 3), ObjectId{1});
  EXPECT_EQ(objects.labels(0, 0), ObjectId::none);
}

TEST(MeasureChosen, ARegionWithoutScoreOrDisparityIsNoObject) {
  const Objects objects = Scene({40, 20}, {{{2, 2, 5, 5}, 8}, {{10, 2, 5, 5}, kNan}, {{20, 2, 5, 5}, 4}})
                              .measured_as_chosen({0, 0, 0.9F, 0.1F});
  ASSERT_EQ(objects.list.size(), 1U);
  EXPECT_EQ(objects.list[0].disparity_px, 4);
  EXPECT_EQ(objects.labels(3, 3), ObjectId::none);
  EXPECT_EQ(objects.labels(12, 3), ObjectId::none);
}

TEST(MeasureChosen, SizeAndBordersDoNotMatter) {
  const Objects objects =
      Scene({40, 20}, {{{0, 5, 40, 15}, 8}, {{3, 1, 1, 1}, 9}}).measured_as_chosen({0, 0.5F, 0.5F});
  ASSERT_EQ(objects.list.size(), 2U);
  EXPECT_EQ(objects.list[0].pixel_count, 1);
  EXPECT_EQ(objects.list[1].pixel_count, 40 * 15);
}

TEST(MeasureChosen, MeasuresEverythingElseAsForCandidates) {
  const Scene scene({40, 20}, {{{2, 2, 5, 5}, 8}, {{0, 8, 5, 9}, 16}, {{20, 2, 5, 5}, 8}});
  const Objects candidates = scene.measured({.min_area = 0, .max_area = 50});
  for (const int threads : {1, 3}) {
    const Objects objects = scene.measured_as_chosen({0, 0.5F, 0.5F, 0.5F}, threads);
    ASSERT_EQ(objects.list.size(), candidates.list.size());
    for (std::size_t i = 0; i < objects.list.size(); ++i) {
      const Object& found = objects.list[i];
      const Object& expected = candidates.list[i];
      EXPECT_EQ(found.id, expected.id);
      EXPECT_EQ(found.box_px, expected.box_px);
      EXPECT_EQ(found.disparity_px, expected.disparity_px);
      EXPECT_EQ(found.valid_share, expected.valid_share);
      EXPECT_EQ(found.mean_colour, expected.mean_colour);
      EXPECT_EQ(found.edge_share, expected.edge_share);
      EXPECT_EQ(found.cut_share, expected.cut_share);
    }
    EXPECT_EQ(grids::numbers(objects.labels), grids::numbers(candidates.labels));
  }
}

}  // namespace
}  // namespace cairn
