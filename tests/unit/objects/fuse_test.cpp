// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/objects/fuse.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Rows = std::vector<std::vector<std::int64_t>>;
using Ids = std::vector<RegionId>;

Segmentation segmentation(std::initializer_list<std::initializer_list<int>> labels,
                          const std::vector<double>& means) {
  Segmentation result{grid<RegionId>(labels), {}};
  for (const double mean : means) result.regions.emplace_back().mean = mean;
  return result;
}

constexpr RegionId operator""_id(unsigned long long id) {
  return RegionId{static_cast<std::int32_t>(id)};
}

TEST(Fuse, GivesEachIntensityRegionToItsGreatestOverlap) {
  const Segmentation by_intensity = segmentation({{0, 0, 0, 1, 1, 1}}, {0, 0});
  const Segmentation by_disparity = segmentation({{0, 0, 1, 1, 1, 1}}, {4, 9});
  const Fusion fusion = fuse(by_intensity, by_disparity, {});
  EXPECT_EQ(numbers(fusion.labels), (Rows{{0, 0, 0, 1, 1, 1}}));
  EXPECT_EQ(fusion.disparity_region, (Ids{0_id, 1_id}));
}

TEST(Fuse, JoinsAllIntensityRegionsOfOneDisparityRegion) {
  const Segmentation by_intensity = segmentation({{0, 1, 2, 3}, {0, 1, 2, 3}}, {0, 0, 0, 0});
  const Segmentation by_disparity = segmentation({{0, 1, 1, 0}, {0, 1, 1, 0}}, {4, 9});
  const Fusion fusion = fuse(by_intensity, by_disparity, {});
  EXPECT_EQ(numbers(fusion.labels), (Rows{{0, 1, 1, 0}, {0, 1, 1, 0}}));
  EXPECT_EQ(fusion.parts, (std::vector<Ids>{{0_id, 3_id}, {1_id, 2_id}}));
}

TEST(Fuse, GivesAnEvenOverlapToTheNearerRegion) {
  const Segmentation by_intensity = segmentation({{0, 0}}, {0});
  EXPECT_EQ(fuse(by_intensity, segmentation({{0, 1}}, {4, 9}), {}).disparity_region, (Ids{1_id}));
  EXPECT_EQ(fuse(by_intensity, segmentation({{0, 1}}, {9, 4}), {}).disparity_region, (Ids{0_id}));
  EXPECT_EQ(fuse(by_intensity, segmentation({{0, 1}}, {5, 5}), {}).disparity_region, (Ids{0_id}));
}

TEST(Fuse, IgnoresDisparityRegionsWithoutPartners) {
  const Segmentation by_intensity = segmentation({{0, 0, 0, 1}}, {0, 0});
  const Segmentation by_disparity = segmentation({{0, 0, 1, 2}}, {4, 9, 7});
  const Fusion fusion = fuse(by_intensity, by_disparity, {});
  EXPECT_EQ(fusion.disparity_region, (Ids{0_id, 2_id}));
  EXPECT_EQ(numbers(fusion.labels), (Rows{{0, 0, 0, 1}}));
}

TEST(Fuse, MarksTheFusedRegionThatIsTheFloor) {
  const Segmentation by_intensity = segmentation({{0, 0, 0, 1}}, {0, 0});
  Segmentation by_disparity = segmentation({{0, 0, 1, 2}}, {4, 9, 7});
  by_disparity.regions[2].is_floor = true;
  EXPECT_EQ(fuse(by_intensity, by_disparity, {}).is_floor, (std::vector<bool>{false, true}));
}

TEST(Fuse, SumsAnOverlapInPieces) {
  const Segmentation by_intensity = segmentation({{0, 0, 0, 0, 0}}, {0});
  const Segmentation by_disparity = segmentation({{0, 1, 0, 1, 0}}, {4, 9});
  EXPECT_EQ(fuse(by_intensity, by_disparity, {}).disparity_region, (Ids{0_id}));
}

}  // namespace
}  // namespace cairn
