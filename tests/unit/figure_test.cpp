// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/grouping/figure.hpp>
#include <cairn/image/noise.hpp>
#include <limits>

namespace cairn {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{100, 20};
constexpr float kBehind = 2;  // the background's disparity
using Labels = std::vector<std::int32_t>;

Gray grey_of(int facet) {
  return static_cast<Gray>(30 + 50 * facet);
}

/// A row of upright bands, each of its own grey, and what is known of their disparity.
struct Stage {
  Image<Gray> grey{kSize, grey_of(0), {}};
  Image<Rgb> rgb{};
  Image<RegionId> labels{kSize, RegionId{0}, {}};
  Image<std::uint16_t> edges{kSize, 0, {}};
  Image<float> evidence{kSize, kNaN, {}};

  /// Facet `id` from column `first` up to `last`, over the rows from `top` on.
  void facet(int id, int first, int last, int top = 0) {
    for (int y = top; y < kSize.height; ++y) {
      for (int x = first; x < last; ++x) {
        labels(x, y) = RegionId{id};
        grey(x, y) = grey_of(id);
      }
    }
  }
  void see(int first, int last, float disparity_px, int top = 0, int bottom = kSize.height) {
    for (int y = top; y < bottom; ++y) {
      for (int x = first; x < last; ++x) evidence(x, y) = disparity_px;
    }
  }
  [[nodiscard]] Labels figure(int facets, const FigureConfig& config = {}, bool has_floor = false) const {
    return separate_figure({labels.clone(), facets, borders_of(labels, edges)}, grey, rgb, evidence,
                           Background{{{0, 0, kBehind}}, has_floor}, noise_sigma(grey), config, {});
  }
};

TEST(Figure, IsWhatEvidenceShowsBeforeTheBackground) {
  Stage stage;
  stage.facet(1, 30, 60);
  stage.see(0, 30, kBehind);
  stage.see(30, 60, 10);
  stage.see(60, 100, kBehind);
  EXPECT_EQ(stage.figure(2), (Labels{0, 1}));
}

TEST(Figure, IsNotWhatStandsWithinTheMargin) {
  for (const float before : {0.5F, 2.0F}) {  // in margins
    Stage stage;
    stage.facet(1, 30, 60);
    stage.see(0, 100, kBehind);
    FigureConfig config;
    stage.see(30, 60, kBehind + before * config.margin * 0.001F * kSize.width);
    EXPECT_EQ(stage.figure(2, config)[1], before > 1 ? 1 : 0) << before;
  }
}

TEST(Figure, TakesInThePlainInteriorBetweenEdgesOfEqualDepth) {
  Stage stage;
  stage.facet(1, 35, 37);  // the board's left edge, its face, its right edge
  stage.facet(2, 37, 53);
  stage.facet(3, 53, 55);
  stage.facet(4, 55, 100);
  stage.see(10, 30, kBehind);
  stage.see(35, 37, 10);
  stage.see(53, 55, 10);
  stage.see(60, 90, kBehind);
  EXPECT_EQ(stage.figure(5), (Labels{0, 1, 1, 1, 0}));
}

TEST(Figure, LeavesThePlainStretchBetweenFigureAndGroundToTheGround) {
  Stage stage;  // plain wall from 40 to 60 between a board's edge and the next mark on the wall
  stage.facet(1, 20, 40);
  stage.facet(2, 40, 60);
  stage.facet(3, 60, 100);
  stage.see(0, 20, kBehind);
  stage.see(20, 40, 10);
  stage.see(60, 100, kBehind);
  EXPECT_EQ(stage.figure(4), (Labels{0, 1, 0, 0}));
}

/// Figure by what is seen and by borders alone.
FigureConfig cut_only() {
  FigureConfig config;
  config.smoothness = 2;
  config.colour_weight = config.continuation_weight = 0;
  return config;
}

/// Two boards with a plain stretch between them (facet 2), ground above; what the stretch becomes when its
/// border to the boards or that to the ground is the weaker.
Labels between_boards(float left_px, float right_px, bool open_to_the_ground) {
  Stage stage;
  stage.facet(1, 20, 40, 5);
  stage.facet(2, 40, 60, 5);
  stage.facet(3, 60, 80, 5);
  stage.see(0, 100, kBehind, 0, 5);
  stage.see(0, 20, kBehind);
  stage.see(20, 40, left_px, 5);
  stage.see(60, 80, right_px, 5);
  stage.see(80, 100, kBehind);
  for (int x = 0; x < kSize.width; ++x) {
    stage.edges(x, 4) = stage.edges(x, 5) = open_to_the_ground ? 5 : 50;
  }
  for (int y = 6; y < kSize.height; ++y) {
    for (const int x : {39, 40, 59, 60}) stage.edges(x, y) = 10;
  }
  return stage.figure(4, cut_only());
}

TEST(Figure, IsSaidNothingOfBetweenObjectsInDifferentDepth) {
  EXPECT_EQ(between_boards(10, 16, true), (Labels{0, 1, 0, 1}));
  EXPECT_EQ(between_boards(10, 16, false), (Labels{0, 1, 1, 1}));
}

TEST(Figure, IsNotTakenAlongAcrossABorderThatCostsNothing) {
  Stage stage;
  stage.facet(1, 20, 40);
  stage.facet(2, 40, 60);  // between objects in different depth: nothing is said of it
  stage.facet(3, 60, 80);
  stage.see(0, 20, kBehind);
  stage.see(20, 40, 10);
  stage.see(60, 80, 16);
  stage.see(80, 100, kBehind);
  FigureConfig config = cut_only();
  EXPECT_EQ(stage.figure(4, config), (Labels{0, 1, 1, 1}));
  config.smoothness = 0;
  EXPECT_EQ(stage.figure(4, config), (Labels{0, 1, 0, 1}));
}

TEST(Figure, IsWhatLiesBetweenObjectsOfOneDepthWhateverItsBorders) {
  EXPECT_EQ(between_boards(10, 10, true), (Labels{0, 1, 1, 1}));
  EXPECT_EQ(between_boards(10, 10, false), (Labels{0, 1, 1, 1}));
}

TEST(Figure, DoesNotReachFromAnObjectToTheImagesBorder) {
  Stage stage;
  stage.facet(1, 40, 60);
  stage.facet(2, 60, 100);
  stage.see(40, 60, 10);
  EXPECT_EQ(stage.figure(3), (Labels{0, 1, 0}));
}

TEST(Figure, IsLeftToItsNeighboursAcrossAStretchLongerThanABridge) {
  const auto with_bridge = [](float longest_bridge) {
    Stage stage;  // a plain stretch of 40 columns whose only weak border is that to the ground above it
    stage.facet(1, 25, 30, 5);
    stage.facet(2, 30, 70, 5);
    stage.facet(3, 70, 75, 5);
    stage.see(0, 100, kBehind, 0, 5);
    stage.see(0, 25, kBehind);
    stage.see(25, 30, 10, 5);
    stage.see(70, 75, 10, 5);
    stage.see(75, 100, kBehind);
    for (int y = 6; y < kSize.height; ++y) {
      for (const int x : {29, 30, 69, 70}) stage.edges(x, y) = 20;
    }
    FigureConfig config;
    config.longest_bridge = longest_bridge;
    return stage.figure(4, config);
  };
  EXPECT_EQ(with_bridge(50), (Labels{0, 1, 1, 1}));
  EXPECT_EQ(with_bridge(30), (Labels{0, 1, 0, 1}));
}

/// A gap between two boards of one depth, painted like the ground or like the boards.
Stage with_gap(Gray painted) {
  Stage stage;
  stage.facet(1, 20, 40);
  stage.facet(2, 40, 60);
  stage.facet(3, 60, 80);
  stage.see(0, 20, kBehind);
  stage.see(20, 40, 10);
  stage.see(60, 80, 10);
  stage.see(80, 100, kBehind);
  for (int y = 0; y < kSize.height; ++y) std::fill_n(stage.grey.row(y) + 40, 20, painted);
  return stage;
}

TEST(Figure, IsNotAGapPaintedLikeTheGroundBetweenObjectsOfOneDepth) {
  EXPECT_EQ(with_gap(grey_of(0)).figure(4), (Labels{0, 1, 0, 1}));
  EXPECT_EQ(with_gap(grey_of(0) + 10).figure(4), (Labels{0, 1, 0, 1}));
}

TEST(Figure, KeepsAStripeOfAnObjectInItsOwnColour) {
  EXPECT_EQ(with_gap(grey_of(1)).figure(4), (Labels{0, 1, 1, 1}));
}

TEST(Figure, KeepsAStripeOfAnObjectInNobodysColour) {
  EXPECT_EQ(with_gap(grey_of(4)).figure(4), (Labels{0, 1, 1, 1}));
}

TEST(Figure, IsWhatTheImagesBorderCutsOffInAnObjectsColour) {
  for (const bool alike : {true, false}) {
    Stage stage;
    stage.facet(1, 50, 70);
    stage.facet(2, 70, 100);
    stage.see(0, 50, kBehind);
    stage.see(50, 70, 10);
    for (int y = 0; y < kSize.height; ++y) {
      std::fill_n(stage.grey.row(y) + 70, 30, alike ? grey_of(1) : grey_of(4));
    }
    EXPECT_EQ(stage.figure(3), (Labels{0, 1, alike ? 1 : 0}));
  }
}

/// Two boards with a plain gap between them in the wall's colour and clear edges all around, and far away a
/// third that is painted alike, so that this colour is as common in the figure as in the ground.
Labels beside_a_wall(bool boards_alike, float continuation_weight) {
  const Gray wall = grey_of(0);
  Stage stage;
  stage.facet(1, 22, 30);
  stage.facet(2, 30, 36);
  stage.facet(3, 36, 44);
  stage.facet(4, 92, 100);
  stage.edges.fill(60);
  stage.see(0, 22, kBehind);
  stage.see(22, 30, 10);
  stage.see(36, 44, 10);
  stage.see(44, 92, kBehind);
  stage.see(92, 100, 10);
  for (int y = 0; y < kSize.height; ++y) {
    std::fill_n(stage.grey.row(y) + 30, 6, wall);
    std::fill_n(stage.grey.row(y) + 92, 8, wall);
    if (!boards_alike) continue;
    std::fill_n(stage.grey.row(y) + 22, 8, wall);
    std::fill_n(stage.grey.row(y) + 36, 8, wall);
  }
  FigureConfig config;
  config.smoothness = 2;
  config.colour_weight = 0;
  config.continuation_weight = continuation_weight;
  return stage.figure(5, config);
}

TEST(Figure, IsNotAStripOfWallThatGoesOnBesideTheObjects) {
  EXPECT_EQ(beside_a_wall(false, 1), (Labels{0, 1, 0, 1, 1}));
  EXPECT_EQ(beside_a_wall(false, 0), (Labels{0, 1, 1, 1, 1}));
}

TEST(Figure, KeepsAStripInTheWallsColourWhereTheObjectsBesideItHaveThatToo) {
  EXPECT_EQ(beside_a_wall(true, 1), (Labels{0, 1, 1, 1, 1}));
}

TEST(Figure, KeepsAGapWhereColourIsNotAsked) {
  FigureConfig config;
  config.colour_weight = config.continuation_weight = 0;
  EXPECT_EQ(with_gap(grey_of(0)).figure(4, config), (Labels{0, 1, 1, 1}));
}

TEST(Figure, JudgesGapsByColourWhereThereIsColour) {
  Stage stage = with_gap(grey_of(0));  // like the ground in grey, but not in colour
  stage.rgb = Image<Rgb>(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const Gray g = stage.grey(x, y);
      stage.rgb(x, y) = x >= 40 && x < 60 ? Rgb{120, 0, 30} : Rgb{g, g, g};
    }
  }
  EXPECT_EQ(stage.figure(4), (Labels{0, 1, 1, 1}));
}

TEST(Figure, OfItsOwnTextureIsFigureInTheGroundsColourToo) {
  Stage stage = with_gap(grey_of(0));
  stage.see(45, 53, 10);
  EXPECT_EQ(stage.figure(4), (Labels{0, 1, 1, 1}));
}

/// Two boxes that stand before a wall, and between them its skirting board: facet 2, `height` rows of it
/// above the floor, which begins at row 15.
Labels before_a_skirting_board(int height, float skirting, bool has_floor = true, bool textured = false,
                               float wall_px = kBehind) {
  const Background room{{{0, 1, kBehind - 14.5F}, {0, 0, wall_px}}, has_floor};
  Stage stage;
  stage.facet(1, 20, 40);
  stage.facet(2, 40, 60, 15 - height);
  stage.facet(3, 60, 80);
  for (int y = 15; y < kSize.height; ++y) {
    for (int x = 40; x < 60; ++x) {
      stage.labels(x, y) = RegionId{0};
      stage.grey(x, y) = grey_of(0);
    }
  }
  stage.edges.fill(200);
  for (int y = 0; y < kSize.height; ++y) {
    stage.see(0, 100, room.disparity_px(0, static_cast<float>(y)), y, y + 1);
  }
  stage.see(20, 40, 10);
  stage.see(60, 80, 10);
  stage.see(40, 60, textured ? 10 : kNaN, 15 - height, 15);
  FigureConfig config = cut_only();
  config.skirting = skirting;
  return separate_figure({stage.labels.clone(), 4, borders_of(stage.labels, stage.edges)}, stage.grey, {},
                         stage.evidence, room, noise_sigma(stage.grey), config, {});
}

TEST(Figure, IsNotConcludedAlongTheFootOfAWall) {
  EXPECT_EQ(before_a_skirting_board(4, 5), (Labels{0, 1, 0, 1}));
  EXPECT_EQ(before_a_skirting_board(4, 0), (Labels{0, 1, 1, 1}));
  EXPECT_EQ(before_a_skirting_board(4, 2), (Labels{0, 1, 1, 1}));  // higher than that
  EXPECT_EQ(before_a_skirting_board(12, 5), (Labels{0, 1, 1, 1}));
}

TEST(Figure, IsSeenAlongTheFootOfAWallAsAnywhere) {
  EXPECT_EQ(before_a_skirting_board(4, 5, true, true), (Labels{0, 1, 1, 1}));
}

TEST(Figure, KnowsOfNoFootOfAWallWithoutAFloor) {
  EXPECT_EQ(before_a_skirting_board(4, 5, false), (Labels{0, 1, 1, 1}));
}

TEST(Figure, KnowsOfNoFootOfAWallAlongTheHorizon) {
  constexpr float kNowhere = -5;  // such a wall is nowhere the background
  EXPECT_EQ(before_a_skirting_board(4, 10, true, false, kNowhere), (Labels{0, 1, 1, 1}));
}

/// A facet `width` columns wide of which 12 of 20 rows are seen to be figure and the others to be ground.
std::int32_t with_evidence_of_both(int width, float border_weight) {
  Stage stage;
  stage.facet(1, 30, 30 + width);
  stage.see(0, 100, kBehind);
  stage.see(30, 30 + width, 10, 0, 12);
  FigureConfig config = cut_only();
  config.smoothness = 0;
  config.border_weight = border_weight;
  return stage.figure(2, config)[1];
}

TEST(Figure, ThatIsSeenBesideABorderCountsItsWeight) {
  // Both columns are beside a border: 24 of these against 16 for ground, and a twentieth of 40 in doubt.
  EXPECT_EQ(with_evidence_of_both(2, 1), 1);
  EXPECT_EQ(with_evidence_of_both(2, 0.8F), 1);
  EXPECT_EQ(with_evidence_of_both(2, 0.7F), 0);
  EXPECT_EQ(with_evidence_of_both(2, 0), 0);
}

TEST(Figure, ThatIsSeenAwayFromABorderCountsWhateverThatWeight) {
  // 8 of 10 columns are not beside a border: 96 against 80, and 10 in doubt.
  EXPECT_EQ(with_evidence_of_both(10, 0), 1);
}

/// A small object of which a part, facet 2 with 5 % of the picture, shows no evidence, and a large object in
/// another colour, so that the small one's colour is no more common in the figure than in its own part.
Labels with_a_plain_part(float largest_part, bool has_floor) {
  Stage stage;
  stage.facet(1, 20, 22);
  stage.facet(2, 22, 27);
  stage.facet(3, 60, 90);
  stage.edges.fill(200);
  stage.see(0, 20, kBehind);
  stage.see(20, 22, 10);
  stage.see(27, 60, kBehind);
  stage.see(60, 90, 10);
  stage.see(90, 100, kBehind);
  for (int y = 0; y < kSize.height; ++y) std::fill_n(stage.grey.row(y) + 22, 5, grey_of(1));
  FigureConfig config;
  config.largest_part = largest_part;
  return stage.figure(4, config, has_floor);
}

TEST(Figure, TakesInAPartInItsColourThatPassedForGround) {
  EXPECT_EQ(with_a_plain_part(5, true), (Labels{0, 1, 1, 1}));
}

TEST(Figure, LosesAPartThatSpeaksForItsColourAsGround) {
  EXPECT_EQ(with_a_plain_part(0, true), (Labels{0, 1, 0, 1}));
  EXPECT_EQ(with_a_plain_part(2, true), (Labels{0, 1, 0, 1}));  // larger than that
}

TEST(Figure, LeavesWhatMayBeAMirrorImageWhereNoFloorIsKnown) {
  EXPECT_EQ(with_a_plain_part(5, false), (Labels{0, 1, 0, 1}));
}

TEST(Figure, OutvotesAFewWrongDisparities) {
  Stage stage;
  stage.facet(1, 30, 60);
  stage.see(0, 100, kBehind);
  stage.see(30, 60, 10);
  stage.see(40, 44, kBehind, 3, 9);
  stage.see(5, 9, 12, 3, 9);
  EXPECT_EQ(stage.figure(2), (Labels{0, 1}));
}

TEST(Figure, IsNothingWithoutEvidence) {
  Stage stage;
  stage.facet(1, 30, 60);
  EXPECT_EQ(stage.figure(2), (Labels{0, 0}));
}

}  // namespace
}  // namespace cairn
