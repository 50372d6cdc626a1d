// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/regions/merge_tree.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/region_scene.hpp"

namespace cairn {
namespace {

using grids::grid;
using support::RegionScene;

/// Score by brightness difference: 3 below 5 grey levels, 1 below 50, −1 below 100, −2 above.
class ByBrightness {
 public:
  ByBrightness() {
    const auto names = merge_feature_names();
    const auto feature = static_cast<std::int16_t>(
        std::find(names.begin(), names.end(), "difference of brightness, grey levels") - names.begin());
    nodes_ = {{feature, 1, 50}, {feature, 3, 5}, {feature, 5, 100}, {-1, 0, 3},
              {-1, 0, 1},       {-1, 0, -1},     {-1, 0, -2}};
  }
  [[nodiscard]] FittedTrees trees() const { return {0, roots_, nodes_}; }

 private:
  std::vector<FittedTrees::Node> nodes_;
  std::vector<std::int16_t> roots_{0};
};

using Parts = std::vector<std::pair<std::int32_t, std::int32_t>>;

Parts parts_of(const MergeTree& tree) {
  Parts parts;
  for (std::size_t i = slot(tree.superpixels); i < tree.nodes.size(); ++i)
    parts.push_back(std::minmax({tree.nodes[i].part_a, tree.nodes[i].part_b}));
  return parts;
}

MergeTree grown(const RegionScene& scene) {
  return grow_merge_tree(scene.superpixels, scene.cues(), ByBrightness().trees(), {});
}

TEST(MergeTree, OfOneSuperpixelIsThatOne) {
  const MergeTree tree = grown(RegionScene(grid<RegionId>({{0, 0}, {0, 0}})));
  EXPECT_EQ(tree.superpixels, 1);
  ASSERT_EQ(tree.nodes.size(), 1U);
  EXPECT_EQ(tree.nodes[0].part_a, -1);
  EXPECT_EQ(tree.nodes[0].whole, -1);
  EXPECT_EQ(tree.nodes[0].area, 4);
}

TEST(MergeTree, FusesTheMostSimilarFirst) {
  RegionScene scene(grid<RegionId>({{0, 1, 2, 3}, {0, 1, 2, 3}}));
  scene.paint({50, 200, 203, 40});  // only 1 and 2 are similar; merged, they differ from both others
  EXPECT_EQ(parts_of(grown(scene)), (Parts{{1, 2}, {0, 4}, {3, 5}}));
  scene.paint({50, 60, 203, 200});
  EXPECT_EQ(parts_of(grown(scene)), (Parts{{2, 3}, {0, 1}, {4, 5}}));
}

TEST(MergeTree, EquallyLikelyContactsFollowInRasterOrder) {
  const RegionScene scene(grid<RegionId>({{0, 1, 2}, {0, 4, 4}, {3, 3, 3}}));
  EXPECT_EQ(parts_of(grown(scene)), (Parts{{0, 1}, {2, 5}, {4, 6}, {3, 7}}));
}

TEST(MergeTree, JudgesAFusedRegionAsAWhole) {
  // At first 2 is equally similar to 1 and 3, but not to the union of 0 and 1.
  RegionScene scene(grid<RegionId>({{0, 1, 2, 3}}));
  scene.paint({50, 54, 103, 152});
  const MergeTree tree = grown(scene);
  EXPECT_EQ(parts_of(tree), (Parts{{0, 1}, {2, 3}, {4, 5}}));
  EXPECT_EQ(tree.nodes[4].origin.same_thing, 3);
  EXPECT_EQ(tree.nodes[5].origin.same_thing, 1);
  EXPECT_EQ(tree.nodes[6].origin.same_thing, -1);
}

TEST(MergeTree, RecordsTheOriginOfItsNodes) {
  RegionScene scene(grid<RegionId>({{0, 0, 0, 1, 2, 2}}));
  scene.paint({50, 54, 203});
  const MergeTree tree = grown(scene);
  EXPECT_EQ(tree.nodes[1].origin.same_thing, 20);
  EXPECT_EQ(tree.nodes[1].origin.larger_part, 1);
  EXPECT_EQ(tree.nodes[3].origin.same_thing, 3);
  EXPECT_EQ(tree.nodes[3].origin.least_same_thing, 3);
  EXPECT_EQ(tree.nodes[3].origin.larger_part, 0.75F);
  EXPECT_EQ(tree.nodes[4].origin.least_same_thing, -2);
  EXPECT_FLOAT_EQ(tree.nodes[4].origin.larger_part, 4.0F / 6);
  // … and their parent.
  EXPECT_EQ(tree.nodes[1].features[kObjectFeatures - 2], 0.25F);
  EXPECT_EQ(tree.nodes[1].features[kObjectFeatures - 1], 3);
  EXPECT_EQ(tree.nodes[4].features[kObjectFeatures - 2], kUnknown);
}

TEST(MergeTree, HasEveryNodeAfterItsPartsUpToTheWholeImage) {
  RegionScene scene(grids::random_image<RegionId>({13, 11}, 0, 19, 5));
  scene.gray = grids::random_image<Gray>({13, 11}, 0, 255, 6);
  ASSERT_EQ(scene.superpixels.count, 20);
  const MergeTree tree = grown(scene);
  EXPECT_EQ(tree.superpixels, 20);
  ASSERT_EQ(tree.nodes.size(), 39U);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const MergeNode& node = tree.nodes[i];
    EXPECT_EQ(node.whole < 0, i == 38);
    if (i < 20) continue;
    std::int64_t area = 0;
    for (const std::int32_t part : {node.part_a, node.part_b}) {
      ASSERT_GE(part, 0);
      ASSERT_LT(slot(part), i);
      EXPECT_EQ(slot(tree.nodes[slot(part)].whole), i);
      area += tree.nodes[slot(part)].area;
    }
    EXPECT_EQ(node.area, area);
  }
  EXPECT_EQ(tree.nodes.back().area, 13 * 11);
}

TEST(MergeTree, ReportsTheJudgedPairs) {
  RegionScene scene(grid<RegionId>({{0, 1, 2}, {0, 1, 2}}));
  scene.paint({50, 54, 203});
  Parts judged_pairs;
  std::vector<float> scores;
  const ByBrightness by;
  static_cast<void>(grow_merge_tree(scene.superpixels, scene.cues(), by.trees(), {},
                                    [&](std::int32_t a, std::int32_t b, const MergeFeatures& features) {
                                      judged_pairs.push_back(std::minmax({a, b}));
                                      scores.push_back(by.trees()(features));
                                    }));
  EXPECT_EQ(judged_pairs, (Parts{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(scores, (std::vector<float>{3, -2, -2}));
}

}  // namespace
}  // namespace cairn
