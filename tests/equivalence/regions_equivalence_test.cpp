// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/target.hpp>
#include <cairn/regions/gradient_threshold.hpp>
#include <cairn/regions/split_floor.hpp>
#include <random>

#include "reference/regions.hpp"
#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::numbers;
using grids::random_image;

Exec threads(int count) {
  Exec exec = Exec::with_threads(count);
  exec.pool = Pool::make();
  return exec;
}

/// Every instruction set of this machine.
std::vector<Exec> all_targets() {
  std::vector<Exec> all;
  for (const Target target : supported_targets()) {
    all.push_back(threads(1));
    all.back().target = target;
  }
  return all;
}

/// Every width that a vector of 64 bytes can end at, and heights that split into uneven parts.
std::vector<Size> sizes() {
  std::vector<Size> all{{1, 1}, {1, 40}, {40, 1}, {67, 53}};
  for (int width = 2; width <= 67; width += 3) all.push_back({width, 3 + width % 5});
  return all;
}

/// A disparity image in 1/16 px with holes: blocks of similar values and some noise.
Image<std::int16_t> random_disparity16(Size size, std::uint32_t seed) {
  const Image<int> blocks = random_image<int>({size.width / 6 + 1, size.height / 5 + 1}, -4, 12, seed);
  const Image<int> noise = random_image<int>(size, 0, 9, seed + 1);
  Image<std::int16_t> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int value = 20 * blocks(x / 6, y / 5) + (noise(x, y) < 3 ? noise(x, y) : 0);
      image(x, y) =
          noise(x, y) == 9 || blocks(x / 6, y / 5) == 12 ? kHole16 : static_cast<std::int16_t>(value);
    }
  }
  return image;
}

DisparityMap map_of(const Image<std::int16_t>& disparity16) {
  DisparityMap map{Image<float>(disparity16.size()), Image<Reject>(disparity16.size())};
  for (int y = 0; y < disparity16.height(); ++y) {
    for (int x = 0; x < disparity16.width(); ++x) {
      const bool hole = disparity16(x, y) == kHole16;
      map.disparity_px(x, y) = hole ? std::numeric_limits<float>::quiet_NaN() : disparity16(x, y) / 16.0F;
      map.reject(x, y) = hole ? Reject::no_data : Reject::none;
    }
  }
  return map;
}

/// The basins of an image of a few heights.
Basins random_basins(Size size, std::uint32_t seed) {
  const Image<std::uint16_t> heights = random_image<std::uint16_t>(size, 0, 20, seed);
  return watershed(heights, {});
}

Basins basins_of(const Image<std::int16_t>& disparity16) {
  const Image<std::uint16_t> edges = gradient(disparity16, 0, {});
  return watershed(edges, {});
}

void expect_equal(const RegionGraph& a, const RegionGraph& b) {
  EXPECT_EQ(a.first_arc, b.first_arc);
  EXPECT_EQ(a.arcs, b.arcs);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(a.nodes[i].pixel_count, b.nodes[i].pixel_count) << i;
    EXPECT_EQ(a.nodes[i].valid_count, b.nodes[i].valid_count) << i;
    EXPECT_EQ(a.nodes[i].sum, b.nodes[i].sum) << i;
    EXPECT_EQ(a.nodes[i].sum_of_squares, b.nodes[i].sum_of_squares) << i;
    EXPECT_EQ(a.nodes[i].first_pixel, b.nodes[i].first_pixel) << i;
    EXPECT_EQ(a.nodes[i].box, b.nodes[i].box) << i;
    EXPECT_EQ(a.nodes[i].is_floor, b.nodes[i].is_floor) << i;
  }
}

void expect_equal(const Segmentation& a, const Segmentation& b) {
  EXPECT_EQ(numbers(a.labels), numbers(b.labels));
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (std::size_t i = 0; i < a.regions.size(); ++i) {
    EXPECT_EQ(a.regions[i].pixel_count, b.regions[i].pixel_count) << i;
    EXPECT_EQ(a.regions[i].valid_count, b.regions[i].valid_count) << i;
    EXPECT_EQ(a.regions[i].box, b.regions[i].box) << i;
    EXPECT_EQ(a.regions[i].mean, b.regions[i].mean) << i;
    EXPECT_EQ(a.regions[i].variance, b.regions[i].variance) << i;
    EXPECT_EQ(a.regions[i].is_floor, b.regions[i].is_floor) << i;
  }
}

TEST(RegionsEquivalence, GreyGradientIsItsTwin) {
  for (const Size size : sizes()) {
    const Image<Gray> image = random_image<Gray>(size, 0, 255, 7);
    for (const float sigma : {0.0F, 0.1F, 0.7F, 1.3F, 5.0F}) {
      const auto expected = numbers(reference::gradient(image, sigma));
      for (const int n : {1, 3}) {
        EXPECT_EQ(numbers(gradient(image, sigma, threads(n))), expected) << text(size) << " sigma " << sigma;
      }
    }
  }
}

TEST(RegionsEquivalence, GreyGradientIsItsTwinOnPartsOfAnImage) {
  const Image<Gray> whole = random_image<Gray>({80, 40}, 90, 110, 8);
  const View<const Gray> part = whole.view().sub({3, 5, 61, 29});
  EXPECT_EQ(numbers(gradient(part, 0.7F, {})), numbers(reference::gradient(part, 0.7F)));
}

TEST(RegionsEquivalence, QuantisedDisparityIsItsTwin) {
  const Image<int> sixtyfourths = random_image<int>({67, 31}, -64 * 2047, 64 * 2047, 9);
  DisparityMap map{Image<float>(sixtyfourths.size()), Image<Reject>(sixtyfourths.size(), Reject::none, {})};
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 67; ++x) map.disparity_px(x, y) = static_cast<float>(sixtyfourths(x, y)) / 64;
  }
  map.disparity_px(5, 5) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(numbers(quantised(map, threads(3))), numbers(reference::quantised(map)));
}

TEST(RegionsEquivalence, DisparityGradientIsItsTwin) {
  for (const Size size : sizes()) {
    const Image<std::int16_t> blocks = random_disparity16(size, 10);
    const Image<std::int16_t> wild = random_image<std::int16_t>(size, -32752, 32752, 11);
    for (const float sigma : {0.0F, 0.7F, 2.0F}) {
      for (const int n : {1, 3}) {
        EXPECT_EQ(numbers(gradient(blocks, sigma, threads(n))), numbers(reference::gradient(blocks, sigma)));
        EXPECT_EQ(numbers(gradient(wild, sigma, threads(n))), numbers(reference::gradient(wild, sigma)));
      }
    }
  }
}

TEST(RegionsEquivalence, WatershedIsItsTwinWithAndWithoutPlateaus) {
  std::uint32_t seed = 20;
  for (const Size size : sizes()) {
    for (const int highest : {0, 1, 2, 5, 255, 65535}) {
      const Image<std::uint16_t> image =
          random_image<std::uint16_t>(size, highest == 65535 ? 65530 : 0, highest, ++seed);
      const Basins expected = reference::watershed(image);
      for (const int n : {1, 3}) {
        const Basins basins = watershed(image, threads(n));
        ASSERT_EQ(numbers(basins.labels), numbers(expected.labels)) << text(size) << " highest " << highest;
        ASSERT_EQ(basins.count, expected.count);
      }
      for (const Exec& exec : all_targets()) {
        ASSERT_EQ(numbers(watershed(image, exec).labels), numbers(expected.labels))
            << text(size) << " highest " << highest << " on " << name(exec.target);
      }
    }
  }
}

TEST(RegionsEquivalence, WatershedIsItsTwinOnWidePlateaus) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const Image<std::uint16_t> coarse = random_image<std::uint16_t>({9, 7}, 0, 3, seed);
    Image<std::uint16_t> image(Size{63, 42});
    for (int y = 0; y < 42; ++y) {
      for (int x = 0; x < 63; ++x) image(x, y) = coarse(x / 7, y / 6);
    }
    EXPECT_EQ(numbers(watershed(image, {}).labels), numbers(reference::watershed(image).labels))
        << "seed " << seed;
  }
}

TEST(RegionsEquivalence, WatershedFollowsAPathThatTurnsAtTheEndOfABlock) {
  // Rows are processed in blocks of 64. The path climbs in column 1, descends in column 3 to row `turn` and
  // climbs in column 5 past the row where it descended from.
  for (int turn = 60; turn < 70; ++turn) {
    Image<std::uint16_t> image(Size{7, 80}, 60000, {});
    std::uint16_t height = 50000;
    const auto go = [&](Point from, Point to) {
      const int steps = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
      for (int i = 0; i <= steps; ++i) {
        image(from.x + (to.x - from.x) * i / std::max(steps, 1),
              from.y + (to.y - from.y) * i / std::max(steps, 1)) = height -= 10;
      }
    };
    go({1, turn - 6}, {1, turn - 10});
    go({2, turn - 10}, {3, turn - 10});
    go({3, turn - 9}, {3, turn});
    go({4, turn}, {5, turn});
    go({5, turn - 1}, {5, turn - 20});
    const Basins basins = watershed(image, {});
    EXPECT_EQ(numbers(basins.labels), numbers(reference::watershed(image).labels)) << "turn " << turn;
    EXPECT_EQ(basins.labels(1, turn - 6), basins.labels(5, turn - 20)) << "turn " << turn;
  }
}

TEST(RegionsEquivalence, LevellingIsItsTwin) {
  for (const Size size : sizes()) {
    const Image<std::uint16_t> image = random_image<std::uint16_t>(size, 0, 12, 25);
    for (const double threshold : {-1.0, 0.0, 0.1, 1.0, 4.5, 12.0, 13.0, 1e9}) {
      Image<std::uint16_t> levelled(size);
      for (int y = 0; y < size.height; ++y) std::copy_n(image.row(y), size.width, levelled.row(y));
      level_below(threshold, levelled, threads(3));
      EXPECT_EQ(numbers(levelled), numbers(reference::levelled_below(threshold, image)))
          << text(size) << " threshold " << threshold;
    }
  }
}

TEST(RegionsEquivalence, FloorWithHolesIsItsTwin) {
  for (const Size size : sizes()) {
    const Image<std::int16_t> values = random_disparity16(size, 26);
    const Basins basins = basins_of(values);
    for (const int share : {1, 3, 9}) {
      Image<std::uint8_t> floor = random_image<std::uint8_t>(size, 0, share, 27);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) floor(x, y) = values(x, y) == kHole16 ? 0 : floor(x, y);
      }
      EXPECT_EQ(numbers(floor_with_holes(basins, floor, values, threads(3))),
                numbers(reference::floor_with_holes(basins, floor, values)))
          << text(size);
    }
  }
}

TEST(RegionsEquivalence, SplitFloorIsItsTwin) {
  for (const Size size : sizes()) {
    const Basins basins = random_basins(size, 30);
    for (const int share : {1, 3, 9}) {
      Image<std::uint8_t> floor = random_image<std::uint8_t>(size, 0, share, 31);
      const Basins split = split_floor(basins, floor, threads(3));
      const Basins expected = reference::split_floor(basins, floor);
      EXPECT_EQ(numbers(split.labels), numbers(expected.labels)) << text(size);
      EXPECT_EQ(split.count, expected.count);
    }
  }
}

TEST(RegionsEquivalence, GraphIsItsTwin) {
  for (const Size size : sizes()) {
    const Image<std::int16_t> values = random_disparity16(size, 40);
    const Basins basins = basins_of(values);
    const Image<std::uint8_t> floor = random_image<std::uint8_t>(size, 0, 1, 41);
    expect_equal(build_graph(basins.labels, basins.count, values, {}, threads(3)),
                 reference::build_graph(basins.labels, basins.count, values, {}));
    expect_equal(build_graph(basins.labels, basins.count, values, floor, threads(3)),
                 reference::build_graph(basins.labels, basins.count, values, floor));
  }
}

TEST(RegionsEquivalence, GraphOfGreyLevelsEqualsThatOfTheSameFloats) {
  for (const Size size : sizes()) {
    const Image<Gray> image = random_image<Gray>(size, 0, 255, 44);
    Image<std::int16_t> wide(size);
    for (int y = 0; y < size.height; ++y) std::copy_n(image.row(y), size.width, wide.row(y));
    const Basins basins = random_basins(size, 45);
    expect_equal(build_graph(basins.labels, basins.count, image, {}),
                 reference::build_graph(basins.labels, basins.count, wide, {}));
  }
}

TEST(RegionsEquivalence, GraphIsTheSameOnAllTargets) {
  for (const Size size : sizes()) {
    const Image<RegionId> labels = random_image<RegionId>(size, 0, 5, 46);
    const Image<std::int16_t> values = random_disparity16(size, 47);
    const RegionGraph expected = reference::build_graph(labels, 6, values, {});
    for (const Exec& exec : all_targets()) expect_equal(build_graph(labels, 6, values, {}, exec), expected);
  }
}

TEST(RegionsEquivalence, GraphSumsUpVeryLongRuns) {
  const Image<RegionId> labels(Size{150000, 1}, RegionId{0}, {});
  const Image<Gray> grey(labels.size(), Gray{255}, {});
  const Image<std::int16_t> least(labels.size(), std::int16_t{-32767}, {});
  const Image<std::uint8_t> floor(labels.size(), std::uint8_t{1}, {});
  const auto as_grey = build_graph(labels, 1, grey, {}).nodes.front();
  EXPECT_EQ(as_grey.sum, 150000LL * 255);
  EXPECT_EQ(as_grey.sum_of_squares, 150000LL * 255 * 255);
  const auto as_disparity = build_graph(labels, 1, least, floor, {}).nodes.front();
  EXPECT_EQ(as_disparity.sum, 150000LL * -32767);
  EXPECT_EQ(as_disparity.sum_of_squares, 150000LL * 32767 * 32767);
  EXPECT_EQ(as_disparity.valid_count, 150000);
  EXPECT_TRUE(as_disparity.is_floor);
}

TEST(RegionsEquivalence, GraphOfScatteredLabelsIsItsTwin) {
  // Labels that no watershed produces: not connected, not in raster order, some ids without a pixel.
  const Image<RegionId> labels = random_image<RegionId>({33, 21}, 3, 17, 42);
  const Image<std::int16_t> values = random_disparity16({33, 21}, 43);
  const RegionGraph graph = build_graph(labels, 20, values, {}, {});
  expect_equal(graph, reference::build_graph(labels, 20, values, {}));
  const Merges merges = grow_statistical(graph, {100, 1, 30, 20}, {});
  EXPECT_EQ(merges, reference::grow_statistical(graph, {100, 1, 30, 20}));
  expect_equal(apply_merges(labels, graph, merges, 1.0, {}),
               reference::apply_merges(labels, graph, merges, 1.0));
}

/// Regions in a grid, of very different sizes and variances, numbered in another order than raster order:
/// large ones absorb small ones that came before them, so growing takes several passes.
RegionGraph random_graph(Size grid, std::uint32_t seed) {
  const int count = grid.width * grid.height;
  std::mt19937 random(seed);
  const auto below = [&](int end) { return static_cast<int>(random() % static_cast<unsigned>(end)); };
  std::vector<int> places(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = static_cast<int>(i);
    std::swap(places[i], places[static_cast<std::size_t>(below(static_cast<int>(i) + 1))]);
  }
  RegionGraph graph;
  for (int i = 0; i < count; ++i) {
    const std::int64_t pixels = 1 + (std::int64_t{below(16)} << below(8));
    const std::int64_t mean = below(120);
    const std::int64_t spread = below(12);
    const std::int64_t valid = below(12) == 0 ? 0 : pixels;
    graph.nodes.push_back({.pixel_count = pixels,
                           .valid_count = valid,
                           .sum = valid * mean,
                           .sum_of_squares = valid * (mean * mean + spread * spread),
                           .first_pixel = places[static_cast<std::size_t>(i)],
                           .box = {0, 0, 1, 1},
                           .is_floor = below(20) == 0});
    graph.first_arc.push_back(static_cast<std::int32_t>(graph.arcs.size()));
    if (i >= grid.width) graph.arcs.push_back(i - grid.width);
    if (i % grid.width > 0) graph.arcs.push_back(i - 1);
    if (i % grid.width < grid.width - 1) graph.arcs.push_back(i + 1);
    if (i < count - grid.width) graph.arcs.push_back(i + grid.width);
  }
  graph.first_arc.push_back(static_cast<std::int32_t>(graph.arcs.size()));
  return graph;
}

/// Graphs with noisy and smooth values, holes and a floor, with criteria from strict to loose.
template <class Check>
void for_each_graph(Check check) {
  const std::vector<GrowCriteria> criteria{{0, 0, 1, 0},      {10, 1, 4, 0},    {40, 0.5, 16, 30},
                                           {100, 1, 4, 8},    {400, 3, 16, 60}, {1e9, 1e9, 1, 0},
                                           {5, 1, 1, 1 << 30}};
  for (std::uint32_t seed = 50; seed < 62; ++seed) {
    const Size size{23 + static_cast<int>(seed % 7) * 5, 31 - static_cast<int>(seed % 5) * 3};
    const Image<std::int16_t> values =
        seed % 3 == 0 ? random_image<std::int16_t>(size, 0, 255, seed) : random_disparity16(size, seed);
    Image<std::uint8_t> floor = random_image<std::uint8_t>(size, 0, 0, seed);
    for (int y = size.height / 2; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) floor(x, y) = (x + y * y) % 5 != 0;
    }
    Basins basins = basins_of(values);
    if (seed % 2 == 0) basins = split_floor(basins, floor, {});
    const View<const std::uint8_t> given = seed % 2 == 0 ? floor.view() : View<std::uint8_t>{};
    const RegionGraph graph = build_graph(basins.labels, basins.count, values, given, {});
    for (const GrowCriteria& c : criteria) check(graph, c, seed);
  }
  for (std::uint32_t seed = 100; seed < 112; ++seed) {
    const RegionGraph graph = random_graph({4 + static_cast<int>(seed % 11), 9}, seed);
    for (const GrowCriteria& c : criteria) check(graph, c, seed);
    check(graph, {25, 0.3, 2, 40}, seed);
    check(graph, {60, 0.6, 1, 7}, seed);
  }
}

TEST(RegionsEquivalence, MayFuseIsItsTwin) {
  int admitted = 0;
  for_each_graph([&](const RegionGraph& graph, const GrowCriteria& criteria, std::uint32_t) {
    for (std::size_t i = 0; i + 1 < graph.nodes.size(); ++i) {
      const bool expected = reference::may_fuse(graph.nodes[i], graph.nodes[i + 1], criteria);
      EXPECT_EQ(may_fuse(graph.nodes[i], graph.nodes[i + 1], criteria), expected);
      admitted += expected ? 1 : 0;
    }
  });
  EXPECT_GT(admitted, 100);
}

TEST(RegionsEquivalence, StatisticalGrowingIsItsTwin) {
  for_each_graph([](const RegionGraph& graph, const GrowCriteria& criteria, std::uint32_t seed) {
    EXPECT_EQ(grow_statistical(graph, criteria, {}), reference::grow_statistical(graph, criteria))
        << "seed " << seed << " mean_difference_max " << criteria.mean_difference_max;
  });
}

TEST(RegionsEquivalence, NearToFarGrowingIsItsTwin) {
  for_each_graph([](const RegionGraph& graph, const GrowCriteria& criteria, std::uint32_t seed) {
    EXPECT_EQ(grow_near_to_far(graph, criteria, {}), reference::grow_near_to_far(graph, criteria))
        << "seed " << seed << " mean_difference_max " << criteria.mean_difference_max;
  });
}

TEST(RegionsEquivalence, FusingSmallRegionsIsItsTwin) {
  for_each_graph([](const RegionGraph& graph, const GrowCriteria& criteria, std::uint32_t) {
    const Merges so_far =
        grow_near_to_far(graph, {.mean_difference_max = 5, .deviation_max = 1, .sigma_min = 1}, {});
    EXPECT_EQ(fuse_small_regions(graph, so_far, criteria.min_region_area, {}),
              reference::fuse_small_regions(graph, so_far, criteria.min_region_area));
  });
}

TEST(RegionsEquivalence, IntensitySegmentationIsItsTwin) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{47, 34}, Size{31, 45}}) {
    const Image<Gray> image = random_image<Gray>(size, 60, 120, 70);
    for (const float threshold : {0.0F, 9.5F}) {
      const IntensityConfig config{.gradient_threshold = threshold, .min_region_area = 1.0F};
      for (const int n : {1, 3}) {
        expect_equal(segment_intensity(image, config, threads(n)),
                     reference::segment_intensity(image, config));
      }
    }
  }
}

TEST(RegionsEquivalence, DisparitySegmentationIsItsTwin) {
  for (const Size size : {Size{1, 1}, Size{1, 2}, Size{47, 34}, Size{31, 45}}) {
    const DisparityMap map = map_of(random_disparity16(size, 71));
    Image<std::uint8_t> floor = random_image<std::uint8_t>(size, 0, 1, 72);
    for (int y = 0; y < size.height / 2; ++y) std::fill_n(floor.row(y), size.width, std::uint8_t{0});
    for (const float area : {0.0F, 1.0F, 100.0F}) {
      const DisparityConfig config{.gradient_threshold = area == 1.0F ? 0.3F : 0.0F, .min_region_area = area};
      for (const int n : {1, 3}) {
        expect_equal(segment_disparity(map, {}, config, threads(n)),
                     reference::segment_disparity(map, {}, config));
        expect_equal(segment_disparity(map, floor, config, threads(n)),
                     reference::segment_disparity(map, floor, config));
      }
    }
  }
}

TEST(RegionsEquivalence, FusionIsItsTwin) {
  for (const Size size : sizes()) {
    const Image<Gray> image = random_image<Gray>(size, 0, 40, 80);
    const Segmentation by_intensity = segment_intensity(image, {.min_region_area = 0}, {});
    const Segmentation by_disparity =
        segment_disparity(map_of(random_disparity16(size, 81)), {}, {.min_region_area = 0}, {});
    const Fusion expected = reference::fuse(by_intensity, by_disparity);
    const Fusion fusion = fuse(by_intensity, by_disparity, threads(3));
    EXPECT_EQ(numbers(fusion.labels), numbers(expected.labels));
    EXPECT_EQ(fusion.parts, expected.parts);
    EXPECT_EQ(fusion.disparity_region, expected.disparity_region);
    EXPECT_EQ(fusion.is_floor, expected.is_floor);
  }
}

}  // namespace
}  // namespace cairn
