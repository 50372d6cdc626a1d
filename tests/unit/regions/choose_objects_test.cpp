// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/regions/choose_objects.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Ids = std::vector<std::int32_t>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Passes the first feature through at −2, −1, 0 … 5 (odds of about 0.12, 0.27, 0.5, 0.73, 0.88, 0.95 …).
class FirstFeature {
 public:
  FirstFeature() {
    for (int i = -1; i <= 5; ++i) {
      const auto root = static_cast<std::int16_t>(nodes_.size());
      roots_.push_back(root);
      nodes_.push_back({0, static_cast<std::int16_t>(root + 1), static_cast<float>(i)});
      nodes_.push_back({-1, 0, 0});
      nodes_.push_back({-1, 0, 1});
    }
  }
  [[nodiscard]] FittedTrees trees() const { return {-2, roots_, nodes_}; }

 private:
  std::vector<FittedTrees::Node> nodes_;
  std::vector<std::int16_t> roots_;
};

/// Superpixels 0, 1, 2 of 10, 20 and 30 px; 3 = 0 + 1, 4 = all. `odds`: of each of the five.
MergeTree tree_of(const std::vector<float>& odds) {
  MergeTree tree;
  tree.superpixels = 3;
  tree.nodes.resize(5);
  const Ids areas{10, 20, 30, 30, 60};
  const Ids wholes{3, 3, 4, 4, -1};
  for (std::size_t i = 0; i < 5; ++i) {
    tree.nodes[i].area = areas[i];
    tree.nodes[i].whole = wholes[i];
    tree.nodes[i].features[0] = odds[i];
  }
  tree.nodes[3].part_a = 0;
  tree.nodes[3].part_b = 1;
  tree.nodes[4].part_a = 3;
  tree.nodes[4].part_b = 2;
  return tree;
}

ChosenObjects chosen(const std::vector<float>& odds, const ChoiceLimits& limits) {
  return choose_objects(tree_of(odds), FirstFeature().trees(), limits);
}

TEST(ChooseObjects, ChoosesAWholeIfItGainsMoreThanItsParts) {
  const ChosenObjects objects = chosen({1, -2, -2, 4, -2}, {0.3F, 0});
  EXPECT_EQ(objects.object_of, (Ids{1, 1, 0}));
  ASSERT_EQ(objects.scores.size(), 2U);
  EXPECT_EQ(objects.scores[0], 0);
  EXPECT_NEAR(objects.scores[1], 0.982, 0.001);
}

TEST(ChooseObjects, ChoosesPartsIfTheyGainMoreNumberedFromTheLastNodeDown) {
  const ChosenObjects objects = chosen({2, 3, 1, 2, 2}, {0.3F, 0});
  EXPECT_EQ(objects.object_of, (Ids{3, 2, 1}));
  EXPECT_GT(objects.scores[2], objects.scores[3]);
  EXPECT_GT(objects.scores[3], objects.scores[1]);
}

TEST(ChooseObjects, ChoosesAWholeThatTiesWithItsParts) {
  EXPECT_EQ(chosen({2, -2, -2, 2, 2}, {0.3F, 0}).object_of, (Ids{1, 1, 1}));
}

TEST(ChooseObjects, ChoosesNothingBelowTheThreshold) {
  const ChosenObjects objects = chosen({5, 5, 5, 5, 5}, {1, 0});
  EXPECT_EQ(objects.object_of, (Ids{0, 0, 0}));
  EXPECT_EQ(objects.scores, std::vector<float>{0});
  EXPECT_EQ(chosen({0, 0, 0, 0, 0}, {0.5F, 0}).scores.size(), 1U) << "just as likely is not more likely";
}

TEST(ChooseObjects, ChoosesNothingBelowTheMinimumArea) {
  EXPECT_EQ(chosen({4, 4, 4, -2, -2}, {0.3F, 20}).object_of, (Ids{0, 2, 1}));
  EXPECT_EQ(chosen({4, 4, 4, 3, -2}, {0.3F, 30}).object_of, (Ids{1, 1, 2}));
  EXPECT_EQ(chosen({4, 4, 4, 4, 4}, {0.3F, 61}).object_of, (Ids{0, 0, 0}));
}

TEST(ChooseObjects, ScoresAreLikelihoodsInStepsOfOneIn4096) {
  for (const float odds : {-1.0F, 0.0F, 1.0F, 4.0F}) {
    const ChosenObjects objects = chosen({odds, -2, -2, -2, -2}, {0.2F, 0});
    ASSERT_EQ(objects.scores.size(), 2U);
    EXPECT_NEAR(objects.scores[1], 1 / (1 + std::exp(-odds)), 1.0 / 4096);
    EXPECT_EQ(objects.scores[1] * 4096, std::floor(objects.scores[1] * 4096));
  }
}

TEST(GroupsOf, AreTheObjectsWithTheirDisparitiesOnBackground) {
  Superpixels superpixels{grid<RegionId>({{0, 0, 1}, {2, 2, 1}}), 3, {}};
  const DisparityMap disparity{grid<float, float>({{4, kNaN, 8}, {2, 2, 10}}),
                               Image<Reject>(Size{3, 2}, Reject::none, {})};
  const Segmentation groups = object_regions(superpixels, {{0, 2, 1}, {0, 0.9F, 0.8F}}, disparity, {});
  EXPECT_EQ(numbers(groups.labels), (std::vector<std::vector<std::int64_t>>{{0, 0, 2}, {1, 1, 2}}));
  ASSERT_EQ(groups.regions.size(), 3U);
  EXPECT_TRUE(groups.regions[0].is_background);
  EXPECT_FALSE(groups.regions[1].is_background);
  EXPECT_FALSE(groups.regions[2].is_background);
  EXPECT_EQ(groups.regions[0].pixel_count, 2);
  EXPECT_EQ(groups.regions[0].valid_count, 1);
  EXPECT_EQ(groups.regions[0].mean, 4);
  EXPECT_EQ(groups.regions[2].mean, 9);
  EXPECT_EQ(groups.regions[2].variance, 1);
  EXPECT_EQ(groups.regions[1].box, (Rect{0, 1, 2, 1}));
}

TEST(GroupsOf, RegionZeroExistsEvenIfAllPixelsAreObjects) {
  Superpixels superpixels{grid<RegionId>({{0, 1}}), 2, {}};
  const DisparityMap disparity{Image<float>(Size{2, 1}, kNaN, {}),
                               Image<Reject>(Size{2, 1}, Reject::no_data, {})};
  const Segmentation groups = object_regions(superpixels, {{1, 1}, {0, 0.9F}}, disparity, {});
  ASSERT_EQ(groups.regions.size(), 2U);
  EXPECT_TRUE(groups.regions[0].is_background);
  EXPECT_EQ(groups.regions[0].pixel_count, 0);
  EXPECT_EQ(groups.regions[1].valid_count, 0);
}

}  // namespace
}  // namespace cairn
