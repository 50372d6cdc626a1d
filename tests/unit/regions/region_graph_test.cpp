// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/region_graph.hpp>
#include <cairn/stereo/gradient.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Rows = std::vector<std::vector<std::int64_t>>;

constexpr int kHole = kHole16;

std::vector<std::int32_t> neighbours(const RegionGraph& graph, std::size_t node) {
  return {graph.arcs.begin() + graph.first_arc[node], graph.arcs.begin() + graph.first_arc[node + 1]};
}

struct Example {
  Image<RegionId> labels = grid<RegionId>({{0, 0, 1, 1}, {0, 2, 2, 1}, {3, 3, 2, 1}});
  Image<std::int16_t> values = grid<std::int16_t>({{10, 20, 5, 5}, {30, kHole, kHole, 5}, {-7, 7, kHole, 9}});
};

TEST(RegionGraph, CountsPixelsAndSumsOverValidOnesOnly) {
  const Example in;
  const RegionGraph graph = build_graph(in.labels, 4, in.values, {}, {});
  EXPECT_EQ(graph.nodes[0].pixel_count, 3);
  EXPECT_EQ(graph.nodes[0].sum, 60);
  EXPECT_EQ(graph.nodes[0].sum_of_squares, 1400);
  EXPECT_DOUBLE_EQ(graph.nodes[0].mean(), 20);
  EXPECT_NEAR(graph.nodes[0].variance(), 200.0 / 3, 1e-9);
  EXPECT_EQ(graph.nodes[2].pixel_count, 3);
  EXPECT_EQ(graph.nodes[2].valid_count, 0);
  EXPECT_EQ(graph.nodes[2].mean(), 0);
  EXPECT_EQ(graph.nodes[2].variance(), 0);
}

TEST(RegionGraph, KnowsEachRegionsBoxAndFirstPixel) {
  const Example in;
  const RegionGraph graph = build_graph(in.labels, 4, in.values, {}, {});
  EXPECT_EQ(graph.nodes[1].box, (Rect{2, 0, 2, 3}));
  EXPECT_EQ(graph.nodes[2].box, (Rect{1, 1, 2, 2}));
  EXPECT_EQ(graph.nodes[2].first_pixel, 5);
  EXPECT_EQ(graph.nodes[3].first_pixel, 8);
}

TEST(RegionGraph, LinksRegionsThatShareAnEdgeOnceAndAscending) {
  const Example in;
  const RegionGraph graph = build_graph(in.labels, 4, in.values, {}, {});
  EXPECT_EQ(neighbours(graph, 0), (std::vector<std::int32_t>{1, 2, 3}));
  EXPECT_EQ(neighbours(graph, 1), (std::vector<std::int32_t>{0, 2}));
  EXPECT_EQ(neighbours(graph, 2), (std::vector<std::int32_t>{0, 1, 3}));
  EXPECT_EQ(neighbours(graph, 3), (std::vector<std::int32_t>{0, 2}));
}

TEST(RegionGraph, DoesNotLinkRegionsThatMeetAtACorner) {
  const Image<RegionId> labels = grid<RegionId>({{0, 1}, {2, 3}});
  const Image<std::int16_t> values = grid<std::int16_t>({{0, 0}, {0, 0}});
  EXPECT_EQ(neighbours(build_graph(labels, 4, values, {}, {}), 0), (std::vector<std::int32_t>{1, 2}));
}

TEST(RegionGraph, ARegionWithAFloorPixelIsFloor) {
  const Example in;
  const Image<std::uint8_t> floor = grid<std::uint8_t>({{0, 0, 0, 0}, {0, 0, 0, 0}, {255, 255, 0, 0}});
  const RegionGraph graph = build_graph(in.labels, 4, in.values, floor, {});
  EXPECT_FALSE(graph.nodes[0].is_floor);
  EXPECT_TRUE(graph.nodes[3].is_floor);
}

TEST(ApplyMerges, NumbersSurvivorsInRasterOrderWhateverTheirOldIds) {
  const Example in;
  const RegionGraph graph = build_graph(in.labels, 4, in.values, {}, {});
  const Segmentation merged = apply_merges(in.labels, graph, {3, 1, 1, 3}, 1.0, {});
  EXPECT_EQ(numbers(merged.labels), (Rows{{0, 0, 1, 1}, {0, 1, 1, 1}, {0, 0, 1, 1}}));
  ASSERT_EQ(merged.regions.size(), 2U);
  EXPECT_EQ(merged.regions[0].pixel_count, 5);
  EXPECT_DOUBLE_EQ(merged.regions[0].mean, 12);
  EXPECT_EQ(merged.regions[0].box, (Rect{0, 0, 2, 3}));
  EXPECT_EQ(merged.regions[1].valid_count, 4);
}

TEST(ApplyMerges, ScalesValuesAndTheirSquares) {
  const Example in;
  const RegionGraph graph = build_graph(in.labels, 4, in.values, {}, {});
  const Segmentation merged = apply_merges(in.labels, graph, {0, 1, 2, 3}, 0.5, {});
  EXPECT_DOUBLE_EQ(merged.regions[3].mean, 0);
  EXPECT_DOUBLE_EQ(merged.regions[0].mean, 10);
  EXPECT_NEAR(merged.regions[0].variance, 50.0 / 3, 1e-9);
}

}  // namespace
}  // namespace cairn
