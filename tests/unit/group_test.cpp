// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/grouping/group.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

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

  /// A new figure facet with a disparity for each pixel, NaN = none, that is evidence too. Gives its number.
  template <class Disparity>
  int facet(Rect rect, Disparity disparity) {
    const int id = static_cast<int>(figure.size());
    figure.push_back(1);
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      for (int x = rect.x; x < rect.x + rect.width; ++x) {
        labels(x, y) = RegionId{id};
        evidence(x, y) = map.disparity_px(x, y) = disparity(x, y);
        map.reject(x, y) = std::isnan(map.disparity_px(x, y)) ? Reject::no_texture : Reject::none;
      }
    }
    return id;
  }
  int level(Rect rect, float d) {
    return facet(rect, [d](int, int) { return d; });
  }
  /// The same without any evidence.
  int plain(Rect rect, float d) {
    const int id = level(rect, d);
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      for (int x = rect.x; x < rect.x + rect.width; ++x) evidence(x, y) = kNaN;
    }
    return id;
  }
  [[nodiscard]] Segmentation group(const GroupConfig& config = {},
                                   const std::optional<StereoRig>& rig = std::nullopt) const {
    const Facets facets{labels.clone(), static_cast<int>(figure.size()), borders_of(labels, edges)};
    return group_facets(facets, figure, map, evidence, Background{{{0, 0, kBehind}}}, rig, {}, config, {});
  }
};

TEST(Group, IsTheBackgroundWhereNothingIsFigure) {
  const Segmentation result = Stage().group();
  ASSERT_EQ(result.regions.size(), 1U);
  EXPECT_TRUE(result.regions[0].is_background);
  EXPECT_EQ(result.regions[0].pixel_count, kSize.area());
}

TEST(Group, HasTheBackgroundAsRegionZeroEvenWhereAnObjectComesFirst) {
  Stage stage;
  stage.level({0, 0, 60, 60}, 12);
  const Segmentation result = stage.group();
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_EQ(result.labels(0, 0), RegionId{1});
  EXPECT_EQ(result.labels(200, 100), RegionId{0});
  EXPECT_TRUE(result.regions[0].is_background);
  EXPECT_FALSE(result.regions[1].is_background);
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
  config.step_share = config.deviation_share = 0;
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
  strict.step_share = 0;
  EXPECT_EQ(stage.group().regions.size(), 2U);
  EXPECT_EQ(stage.group(strict).regions.size(), 5U);
}

/// Two facets that touch, the second a step farther, grouped by shares of the disparity.
std::size_t groups_across_a_step(float d, float step_px, const std::optional<StereoRig>& rig = std::nullopt) {
  Stage stage;
  stage.level({60, 20, 60, 60}, d);
  stage.level({120, 20, 60, 60}, d - step_px);
  GroupConfig config;
  config.step = 2;  // 0.64 px
  config.step_share = 6;
  config.deviation = 4;
  config.deviation_share = 12;
  return stage.group(config, rig).regions.size() - 1;
}

TEST(Group, PartsAtAStepThatIsALargeShareOfTheDisparityAndJoinsAtASmallOne) {
  EXPECT_EQ(groups_across_a_step(14, 1.5F), 2U);
  EXPECT_EQ(groups_across_a_step(40, 1.5F), 1U);
  EXPECT_EQ(groups_across_a_step(40, 3), 2U);
  EXPECT_EQ(groups_across_a_step(7, 0.6F), 1U);  // more than the share, but less than the least step
}

TEST(Group, TakesSharesOfTheDisparityFromInfinityOn) {
  const StereoRig rig{300, 160, 60, 0.2F, 26};  // disparity 14 is 40 from infinity
  EXPECT_EQ(groups_across_a_step(14, 1.5F, rig), 1U);
  EXPECT_EQ(groups_across_a_step(14, 3, rig), 2U);
}

TEST(Group, LetsADeepFoldBeAShareOfTheDisparity) {
  Stage stage;  // no step anywhere; 4 px lower at its ends than in the middle
  const auto ridge = [](int x, int) { return 40 - 0.05F * static_cast<float>(std::abs(x - 160)); };
  for (int i = 0; i < 8; ++i) stage.facet({80 + 20 * i, 20, 20, 80}, ridge);
  GroupConfig config;
  config.deviation = 4;
  config.deviation_share = 12;
  EXPECT_EQ(stage.group(config).regions.size(), 2U);
  config.deviation_share = 0;
  EXPECT_GT(stage.group(config).regions.size(), 2U);
}

/// Two objects of 60 rows, and between their upper ends a facet of their depth.
std::size_t groups_across_a_bar(bool with_evidence, int bar_height, float gap_share) {
  Stage stage;
  stage.level({60, 20, 60, 60}, 12);
  stage.level({160, 20, 60, 60}, 12);
  const Rect bar{120, 20, 40, bar_height};
  if (with_evidence) {
    stage.level(bar, 12);
  } else {
    stage.plain(bar, 12);
  }
  GroupConfig config;
  config.gap_share = gap_share;
  return stage.group(config).regions.size() - 1;
}

TEST(Group, IsNotConnectedByAFacetWithoutEvidenceThatMostlyBordersOnGround) {
  EXPECT_EQ(groups_across_a_bar(false, 10, 50), 2U);  // 80 of 100 px of its border
  EXPECT_EQ(groups_across_a_bar(true, 10, 50), 1U);
  EXPECT_EQ(groups_across_a_bar(false, 60, 50), 1U);  // 80 of 200
  EXPECT_EQ(groups_across_a_bar(false, 60, 30), 2U);
  EXPECT_EQ(groups_across_a_bar(false, 10, 100), 1U);
}

/// The groups where a thing of `middle` px lies between two halves, `wide` apart.
std::size_t groups_around(float left, float middle, float right, int wide = 20, float occluded_gap = 10) {
  Stage stage;
  stage.level({60, 20, 40, 60}, left);
  stage.level({100, 10, wide, 80}, middle);
  stage.level({100 + wide, 20, 40, 60}, right);
  GroupConfig config;
  config.occluded_gap = occluded_gap;
  return stage.group(config).regions.size() - 1;
}

TEST(Group, UnitesWhatANearerObjectParts) {
  EXPECT_EQ(groups_around(12, 20, 12), 2U);
  EXPECT_EQ(groups_around(12, 20, 12, 20, 0), 3U);
}

TEST(Group, KeepsApartWhatANearerObjectPartsButDepthToo) {
  EXPECT_EQ(groups_around(12, 20, 14), 3U);
}

TEST(Group, KeepsApartWhatIsFarFromEachOtherBehindANearerObject) {
  EXPECT_EQ(groups_around(12, 20, 12, 40), 3U);  // 32 px are allowed
  EXPECT_EQ(groups_around(12, 20, 12, 40, 20), 2U);
}

TEST(Group, KeepsApartWhatNothingNearerParts) {
  EXPECT_EQ(groups_around(12, 8, 12), 3U);  // something farther does
  Stage stage;
  stage.level({60, 20, 40, 60}, 12);
  stage.level({120, 20, 40, 60}, 12);
  stage.level({60, 90, 40, 20}, 20);  // something nearer touches neither
  EXPECT_EQ(stage.group().regions.size(), 4U);
}

TEST(Group, UnitesAllPiecesOfWhatSeveralNearerObjectsPart) {
  // A bar behind three posts. Every order of the pieces, for they are united pair by pair.
  std::array<int, 4> order{0, 1, 2, 3};
  do {
    Stage stage;
    for (const int place : order) stage.level({20 + 60 * place, 40, 40, 40}, 12);
    for (int post = 0; post < 3; ++post) stage.level({60 + 60 * post, 10, 20, 100}, 20);
    const Segmentation result = stage.group();
    EXPECT_EQ(result.regions.size(), 5U) << order[0] << order[1] << order[2] << order[3];
  } while (std::next_permutation(order.begin(), order.end()));
}

}  // namespace
}  // namespace cairn
