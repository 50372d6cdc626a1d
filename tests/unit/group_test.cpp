// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/objects/group.hpp>
#include <cstdlib>
#include <limits>

#include "support/noise.hpp"

namespace cairn {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{320, 120};
constexpr float kBehind = 4;

/// Facet 0 is the background; the others are drawn upon it.
struct Stage {
  Image<RegionId> labels{kSize, RegionId{0}, {}};
  Image<std::uint16_t> edges{kSize, 0, {}};
  Image<float> evidence{kSize, kNaN, {}};
  DisparityMap map{Image<float>(kSize, kBehind, {}), Image<Reject>(kSize, Reject::none, {})};
  std::vector<std::int32_t> figure{0};

  /// A new figure facet with a disparity for each pixel, NaN = none. Gives its number.
  template <class Disparity>
  int facet(Rect rect, Disparity disparity) {
    const int id = static_cast<int>(figure.size());
    figure.push_back(1);
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      for (int x = rect.x; x < rect.x + rect.width; ++x) {
        labels(x, y) = RegionId{id};
        map.disparity_px(x, y) = disparity(x, y);
        map.reject(x, y) = std::isnan(map.disparity_px(x, y)) ? Reject::no_texture : Reject::none;
      }
    }
    return id;
  }
  int level(Rect rect, float d) {
    return facet(rect, [d](int, int) { return d; });
  }
  [[nodiscard]] Segmentation group(const GroupConfig& config = {}) const {
    const Facets facets{labels.clone(), static_cast<int>(figure.size()), borders_of(labels, edges)};
    return group_facets(facets, figure, map, evidence, Background{{{0, 0, kBehind}}}, {}, config, {});
  }
};

TEST(Group, IsTheBackgroundWhereNothingIsFigure) {
  const Segmentation result = Stage().group();
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_TRUE(result.regions[0].is_floor);
  EXPECT_EQ(result.regions[0].pixel_count, kSize.area());
}

TEST(Group, HasTheBackgroundAsRegionZeroEvenWhereAnObjectComesFirst) {
  Stage stage;
  stage.level({0, 0, 60, 60}, 12);
  const Segmentation result = stage.group();
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_EQ(result.labels(0, 0), RegionId{1});
  EXPECT_EQ(result.labels(200, 100), RegionId{0});
  EXPECT_TRUE(result.regions[0].is_floor);
  EXPECT_FALSE(result.regions[1].is_floor);
  EXPECT_DOUBLE_EQ(result.regions[1].mean, 12);
  EXPECT_EQ(result.regions[1].pixel_count, 3600);
  EXPECT_EQ(result.regions[1].valid_count, 3600);
  EXPECT_EQ(result.regions[1].box, (Rect{0, 0, 60, 60}));
}

TEST(Group, HoldsASlantedSurfaceTogether) {
  Stage stage;  // disparity from 10 to 26 over four facets: means 4 px apart
  const auto slant = [](int x, int) { return 10 + 0.1F * static_cast<float>(x - 60); };
  for (int i = 0; i < 4; ++i) stage.facet({60 + 40 * i, 20, 40, 80}, slant);
  EXPECT_EQ(stage.group().regions.size(), 2U);
}

TEST(Group, HoldsASlantedSurfaceOfManySmallPiecesTogether) {
  Stage stage;  // pieces so small that each is nearly level: only the group's own plane follows the slant
  const auto slant = [](int x, int) { return 10 + 0.08F * static_cast<float>(x - 60); };
  for (int i = 0; i < 128; ++i) stage.facet({60 + 10 * (i % 16), 20 + 10 * (i / 16), 10, 10}, slant);
  EXPECT_EQ(stage.group().regions.size(), 2U);
}

TEST(Group, PartsAFoldThatIsDeeperThanTheDeviation) {
  Stage stage;  // no step anywhere
  const auto ridge = [](int x, int) { return 30 - 0.2F * static_cast<float>(std::abs(x - 160)); };
  for (int i = 0; i < 8; ++i) stage.facet({80 + 20 * i, 20, 20, 80}, ridge);
  GroupConfig loose;
  loose.deviation = 1000;
  EXPECT_GT(stage.group().regions.size(), 2U);
  EXPECT_EQ(stage.group(loose).regions.size(), 2U);
}

TEST(Group, GivesANearObjectItsShareBeforeAFarOne) {
  Stage stage;  // the middle piece could belong to either, but not both to it
  stage.level({60, 60, 60, 50}, 12.5F);
  stage.level({120, 60, 60, 50}, 12);
  stage.level({120, 10, 60, 50}, 11.5F);
  GroupConfig config;
  config.step = 3.125F;       // 1 px
  config.deviation = 1.625F;  // 0.52 px
  const Segmentation result = stage.group(config);
  ASSERT_EQ(result.regions.size(), 3U);
  EXPECT_EQ(result.labels(150, 90), result.labels(80, 90));
  EXPECT_NE(result.labels(150, 90), result.labels(150, 30));
}

TEST(Group, HoldsANoisySurfaceTogether) {
  Stage stage;
  support::Noise noise(4);
  const auto rough = [&](int, int) { return static_cast<float>(14 + noise.gaussian(0.4)); };
  for (int i = 0; i < 12; ++i) stage.facet({60 + 15 * (i % 4), 20 + 20 * (i / 4), 15, 20}, rough);
  EXPECT_EQ(stage.group().regions.size(), 2U);
}

TEST(Group, PartsTwoTouchingBoxesInDifferentDepth) {
  Stage stage;
  stage.level({60, 20, 60, 60}, 14);
  stage.level({120, 20, 60, 60}, 10);
  const Segmentation result = stage.group();
  ASSERT_EQ(result.regions.size(), 3U);
  EXPECT_NE(result.labels(80, 50), result.labels(150, 50));
}

TEST(Group, PartsThemThoughTheMatcherBlendsTheirBorder) {
  Stage stage;  // what a window matcher gives: one pixel each side of the edge lies between the two
  stage.facet({60, 20, 60, 60}, [](int x, int) { return x == 119 ? 12.5F : 14.0F; });
  stage.facet({120, 20, 60, 60}, [](int x, int) { return x == 120 ? 11.5F : 10.0F; });
  EXPECT_EQ(stage.group().regions.size(), 3U);
}

TEST(Group, PartsThemThoughThinPiecesLieAlongTheirBlendedBorder) {
  Stage stage;
  stage.level({60, 20, 57, 60}, 12);
  stage.facet({117, 20, 3, 60}, [](int x, int) { return x == 119 ? 11.35F : 12.0F; });
  stage.facet({120, 20, 3, 60}, [](int x, int) { return x == 120 ? 11.35F : 10.7F; });
  stage.level({123, 20, 57, 60}, 10.7F);
  const Segmentation result = stage.group();
  ASSERT_EQ(result.regions.size(), 3U);
  EXPECT_NE(result.labels(118, 50), result.labels(121, 50));
}

TEST(Group, UnitesTouchingBoxesOfOneDepth) {
  Stage stage;
  stage.level({60, 20, 60, 60}, 12);
  stage.level({120, 20, 60, 60}, 12.3F);
  EXPECT_EQ(stage.group().regions.size(), 2U);
}

TEST(Group, KeepsApartWhatDoesNotTouch) {
  Stage stage;
  stage.level({60, 20, 40, 60}, 12);
  stage.level({120, 20, 40, 60}, 12);
  EXPECT_EQ(stage.group().regions.size(), 3U);
}

TEST(Group, GivesASmallPieceToItsNeighbourButKeepsALargeOne) {
  for (const int side : {5, 30}) {
    Stage stage;
    stage.level({60, 20, 80, 80}, 12);
    stage.level({80, 40, side, side}, 16);
    EXPECT_EQ(stage.group().regions.size(), side == 5 ? 2U : 3U) << side;
  }
}

TEST(Group, GivesASmallPieceToTheNeighbourOfSmoothestBorder) {
  Stage stage;  // the piece touches both boxes over the same length
  stage.level({60, 20, 60, 60}, 20);
  stage.level({124, 20, 60, 60}, 10);
  stage.level({120, 40, 4, 4}, 12);
  const Segmentation result = stage.group();
  ASSERT_EQ(result.regions.size(), 3U);
  EXPECT_EQ(result.labels(121, 41), result.labels(150, 41));
}

TEST(Group, LetsAPieceWithoutDisparityFollowItsWeakestBorder) {
  for (const bool to_the_left : {true, false}) {
    Stage stage;
    stage.level({60, 20, 40, 60}, 14);
    stage.level({120, 20, 40, 60}, 10);
    stage.facet({100, 20, 20, 60}, [](int, int) { return kNaN; });
    stage.edges.fill(100);
    for (int y = 20; y < 80; ++y) {
      const int x = to_the_left ? 99 : 119;
      stage.edges(x, y) = stage.edges(x + 1, y) = 8;
    }
    const Segmentation result = stage.group();
    ASSERT_EQ(result.regions.size(), 3U);
    EXPECT_EQ(result.labels(110, 50), result.labels(to_the_left ? 80 : 140, 50));
    EXPECT_EQ(result.regions[index(result.labels(110, 50))].valid_count, 2400);
    EXPECT_EQ(result.regions[index(result.labels(110, 50))].pixel_count, 3600);
  }
}

TEST(Group, DoesNotCountDisparityOfTheBackgroundAsAnObjects) {
  Stage stage;  // half of the second facet shows the background through: it still belongs to the first
  stage.level({60, 20, 60, 60}, 12);
  stage.facet({120, 20, 60, 60}, [](int, int y) { return y % 2 == 0 ? kBehind : 12.0F; });
  EXPECT_EQ(stage.group().regions.size(), 2U);
}

TEST(Group, PartsMoreAsTheAllowedStepFalls) {
  Stage stage;
  for (int i = 0; i < 4; ++i) stage.level({40 + 50 * i, 20, 50, 60}, 12 + 0.5F * static_cast<float>(i));
  GroupConfig strict;
  strict.step = 0.3F;  // 0.1 px
  EXPECT_EQ(stage.group().regions.size(), 2U);
  EXPECT_EQ(stage.group(strict).regions.size(), 5U);
}

}  // namespace
}  // namespace cairn
