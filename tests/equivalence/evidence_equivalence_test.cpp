// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/evidence.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <random>

#include "reference/group.hpp"
#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::numbers;
using grids::random_image;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Exec threads(int count) {
  Exec exec = Exec::with_threads(count);
  exec.pool = Pool::make();
  return exec;
}

std::vector<Size> sizes() {
  return {{1, 1}, {1, 37}, {41, 1}, {2, 2}, {3, 3}, {5, 19}, {16, 33}, {67, 53}};
}

/// Blocks of random brightness, of which some are textured: edges, plain surfaces and texture.
Image<Gray> random_picture(Size size, std::uint32_t seed) {
  const Image<int> blocks = random_image<int>({size.width / 9 + 1, size.height / 7 + 1}, 20, 200, seed);
  const Image<int> noise = random_image<int>(size, -20, 20, seed + 1);
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int block = blocks(x / 9, y / 7);
      image(x, y) = static_cast<Gray>(block + (block % 3 == 0 ? noise(x, y) : noise(x, y) / 10));
    }
  }
  return image;
}

Image<Rgb> random_colours(Size size, std::uint32_t seed) {
  const Image<Gray> r = random_picture(size, seed);
  const Image<Gray> g = random_picture(size, seed + 7);
  const Image<Gray> b = random_picture(size, seed + 13);
  Image<Rgb> rgb(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) rgb(x, y) = {r(x, y), g(x, y), b(x, y)};
  }
  return rgb;
}

/// Blocks of like disparity with outliers and holes. A negative `tenths` of holes: none.
DisparityMap random_map(Size size, std::uint32_t seed, int tenths_of_holes = 2) {
  const Image<int> blocks = random_image<int>({size.width / 8 + 1, size.height / 6 + 1}, 0, 6, seed);
  const Image<int> noise = random_image<int>(size, 0, 99, seed + 1);
  DisparityMap map{Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int n = noise(x, y);
      const bool hole = n < 10 * tenths_of_holes;
      const float d = static_cast<float>(5 * blocks(x / 8, y / 6)) + 0.003F * static_cast<float>(n % 13);
      map.disparity_px(x, y) = hole ? kNaN : n == 99 ? 40.0F : d;
      map.reject(x, y) = hole ? Reject::no_data : Reject::none;
    }
  }
  return map;
}

std::vector<std::uint32_t> bits(const Image<float>& image) {
  std::vector<std::uint32_t> all;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      all.push_back(std::isnan(image(x, y)) ? 0xFFFFFFFFU : std::bit_cast<std::uint32_t>(image(x, y)));
    }
  }
  return all;
}

void expect_equal(const std::vector<Border>& a, const std::vector<Border>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].a, b[i].a) << i;
    EXPECT_EQ(a[i].b, b[i].b) << i;
    EXPECT_EQ(a[i].length, b[i].length) << i;
    EXPECT_EQ(a[i].edge_sum, b[i].edge_sum) << i;
    EXPECT_EQ(a[i].x2_sum, b[i].x2_sum) << i;
    EXPECT_EQ(a[i].y2_sum, b[i].y2_sum) << i;
  }
}

/// `labels` anew as facets are numbered: 0, 1, … in raster order of their first pixels.
Facets as_facets(const Image<RegionId>& labels, std::uint32_t seed) {
  std::map<RegionId, RegionId> number_of;
  Facets facets{Image<RegionId>(labels.size()), 0, {}};
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      facets.labels(x, y) = number_of.try_emplace(labels(x, y), RegionId{facets.count}).first->second;
      facets.count = static_cast<int>(number_of.size());
    }
  }
  const Image<std::uint16_t> edges = random_image<std::uint16_t>(labels.size(), 0, 120, seed);
  facets.borders = borders_of(facets.labels, edges);
  return facets;
}

/// Facets that are anything: connected or not.
Facets random_facets(Size size, int count, std::uint32_t seed) {
  return as_facets(random_image<RegionId>(size, 0, count - 1, seed), seed + 1);
}

/// Facets of blocks, each block its own or one of `count` kinds that hang together in each half of the image.
Facets random_blocks(Size size, std::optional<int> count, std::uint32_t seed) {
  const Size blocks{size.width / 7 + 1, size.height / 4 + 1};
  const auto kinds = random_image<RegionId>(blocks, 0, count.value_or(1) - 1, seed);
  Image<RegionId> labels(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int own = y / 4 * blocks.width + x / 7;
      const int kind = number(kinds(x / 7, y / 4)) + count.value_or(0) * (2 * y / size.height);
      labels(x, y) = RegionId{count ? kind : own};
    }
  }
  return as_facets(labels, seed + 1);
}

/// The same facets numbered from the last to the first.
Facets backwards(const Facets& facets, std::uint32_t seed) {
  Facets result{Image<RegionId>(facets.labels.size()), facets.count, {}};
  for (int y = 0; y < facets.labels.height(); ++y) {
    for (int x = 0; x < facets.labels.width(); ++x) {
      result.labels(x, y) = RegionId{facets.count - 1 - number(facets.labels(x, y))};
    }
  }
  const Image<std::uint16_t> edges = random_image<std::uint16_t>(facets.labels.size(), 0, 120, seed);
  result.borders = borders_of(result.labels, edges);
  return result;
}

/// Facets in colours like and unlike each other, each with some noise.
Image<Rgb> painted(const Facets& facets, std::uint32_t seed) {
  const Image<int> base = random_image<int>({3, facets.count}, 0, 4, seed);
  const Image<int> noise = random_image<int>(facets.labels.size(), 0, 5, seed + 1);
  Image<Rgb> rgb(facets.labels.size());
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      const int facet = number(facets.labels(x, y));
      const auto channel = [&](int c) {
        const int shade = base(c == 0 ? 0 : 1, facet);
        return static_cast<std::uint8_t>(60 + 4 * shade * shade + noise(x, y));
      };
      rgb(x, y) = {channel(0), channel(1), channel(2)};
    }
  }
  return rgb;
}

Image<Gray> greens(const Image<Rgb>& rgb) {
  Image<Gray> grey(rgb.size());
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) grey(x, y) = rgb(x, y).g;
  }
  return grey;
}

TEST(NoiseSigma, IsThatOfItsDefinition) {
  for (const Size size : sizes()) {
    for (const int highest : {0, 1, 5, 255}) {
      const Image<Gray> image = random_image<Gray>(size, 0, highest, 3);
      EXPECT_EQ(noise_sigma(image), reference::noise_sigma(image)) << text(size) << ' ' << highest;
    }
    const Image<Gray> image = random_picture(size, 5);
    EXPECT_EQ(noise_sigma(image), reference::noise_sigma(image)) << text(size);
    EXPECT_EQ(noise_sigma(image, threads(3)), reference::noise_sigma(image)) << text(size);
  }
}

TEST(FindEvidence, IsThatOfItsDefinitionOnAnyNumberOfThreads) {
  int found = 0;
  for (const Size size : sizes()) {
    for (const std::uint32_t seed : {1U, 2U}) {
      const Image<Gray> image = random_picture(size, seed);
      const DisparityMap map = random_map(size, seed);
      EvidenceConfig config;
      if (seed == 2) config = {0.3F, 0.5F, 40.0F};
      const auto expected = bits(reference::find_evidence(image, map, config));
      for (const std::uint32_t b : expected) found += b != 0xFFFFFFFFU ? 1 : 0;
      for (const int count : {1, 2, 3}) {
        EXPECT_EQ(bits(find_evidence(image, map, noise_sigma(image), config, threads(count))), expected)
            << text(size);
      }
    }
  }
  EXPECT_GT(found, 500);  // else there would be nothing to compare
}

TEST(EdgeStrength, IsThatOfItsDefinitionWithAndWithoutColour) {
  for (const Size size : sizes()) {
    const Image<Gray> grey = random_picture(size, 1);
    const Image<Rgb> rgb = random_colours(size, 2);
    for (const float sigma : {0.0F, 0.7F, 2.0F}) {
      const auto plain = numbers(reference::edge_strength(grey, {}, sigma));
      const auto coloured = numbers(reference::edge_strength(grey, rgb, sigma));
      for (const int count : {1, 3}) {
        EXPECT_EQ(numbers(edge_strength(grey, {}, sigma, threads(count))), plain)
            << text(size) << ' ' << sigma;
        EXPECT_EQ(numbers(edge_strength(grey, rgb, sigma, threads(count))), coloured)
            << text(size) << ' ' << sigma;
      }
    }
  }
}

TEST(BordersOf, IsThatOfItsDefinition) {
  for (const Size size : sizes()) {
    for (const int highest : {0, 1, 9, 200}) {
      const auto labels = random_image<RegionId>(size, 0, highest, 1);
      const auto edges = random_image<std::uint16_t>(size, 0, 1500, 2);
      expect_equal(borders_of(labels, edges), reference::borders_of(labels, edges));
    }
  }
}

TEST(Flooded, IsThatOfItsDefinition) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    const int count = 2 + static_cast<int>(random() % 40);
    const auto edges_apart = static_cast<int>(1 + random() % 8);  // few heights make ties
    const Facets facets{random_image<RegionId>({9, 7}, 0, count - 1, seed), count, {}};
    const auto edges = random_image<std::uint16_t>({9, 7}, 0, edges_apart, seed);
    const std::vector<Border> borders = borders_of(facets.labels, edges);
    std::vector<std::int32_t> labels(static_cast<std::size_t>(count));
    for (std::int32_t& label : labels) label = std::max(static_cast<std::int32_t>(random() % 9) - 6, -1);
    EXPECT_EQ(flooded(labels, borders, 99), reference::flooded(labels, borders, 99)) << seed;
  }
}

struct Network {
  std::vector<std::int64_t> cost_0;
  std::vector<std::int64_t> cost_1;
  std::vector<Tie> ties;
};

/// Costs from 0 to `highest`: low ones make cuts of equal cost. Ties are also found twice, at one node, or
/// not at all.
Network random_network(int nodes, int ties, int highest, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<std::int32_t>(random() % static_cast<unsigned>(n)); };
  Network network;
  for (int i = 0; i < nodes; ++i) {
    network.cost_0.push_back(below(highest + 1));
    network.cost_1.push_back(below(highest + 1));
  }
  for (int i = 0; i < ties; ++i) network.ties.push_back({below(nodes), below(nodes), below(highest + 1)});
  return network;
}

TEST(MinimumCut, IsThatOfItsDefinition) {
  int ones = 0;
  int labelled = 0;
  for (const int nodes : {1, 2, 5, 20, 60}) {
    for (const int ties_per_node : {0, 1, 2, 6}) {
      for (const int highest : {0, 1, 3, 1000}) {
        for (std::uint32_t seed = 1; seed <= 5; ++seed) {
          const Network net = random_network(nodes, nodes * ties_per_node, highest, seed);
          const auto expected = reference::minimum_cut(net.cost_0, net.cost_1, net.ties);
          for (const std::int32_t label : expected) ones += label;
          labelled += nodes;
          EXPECT_EQ(MinimumCuts(net.cost_0.size(), net.ties).cut(net.cost_0, net.cost_1), expected)
              << nodes << ' ' << ties_per_node << ' ' << highest << ' ' << seed;
        }
      }
    }
  }
  EXPECT_GT(ones, labelled / 10);
  EXPECT_LT(ones, labelled * 9 / 10);
}

TEST(MinimumCut, IsThatOfItsDefinitionAlongLongPaths) {
  for (std::uint32_t seed = 1; seed <= 10;
       ++seed) {  // all that gives is at one end, all that takes at the other
    Network net = random_network(80, 0, 9, seed);
    for (std::size_t i = 0; i < 80; ++i) (i < 40 ? net.cost_1 : net.cost_0)[i] = 0;
    std::mt19937 random(seed);
    for (std::int32_t i = 0; i + 1 < 80; ++i) {
      net.ties.push_back({i + 1, i, 20 + static_cast<std::int64_t>(random() % 60)});
      if (i + 5 < 80) net.ties.push_back({i, i + 5, static_cast<std::int64_t>(random() % 9)});
    }
    EXPECT_EQ(MinimumCuts(net.cost_0.size(), net.ties).cut(net.cost_0, net.cost_1),
              reference::minimum_cut(net.cost_0, net.cost_1, net.ties))
        << seed;
  }
}

TEST(MinimumCuts, OfCostsThatChangeAreThoseOfTheNewCosts) {
  for (const int highest : {1, 3, 1000}) {
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      const int nodes = 2 + static_cast<int>(seed);
      const std::vector<Tie> ties = random_network(nodes, nodes * 3, highest, seed).ties;
      MinimumCuts cuts(static_cast<std::size_t>(nodes), ties);
      std::mt19937 random(seed);
      Network net = random_network(nodes, 0, highest, seed);
      // At first one label is the cheaper one for most, and later often the other one.
      if (seed % 3 == 1) net.cost_0.assign(net.cost_0.size(), 0);
      if (seed % 3 == 2) net.cost_1.assign(net.cost_1.size(), 0);
      for (int round = 0; round < 5; ++round) {
        EXPECT_EQ(cuts.cut(net.cost_0, net.cost_1), reference::minimum_cut(net.cost_0, net.cost_1, ties))
            << highest << ' ' << seed << ' ' << round;
        for (std::int64_t& cost : round % 2 == 0 ? net.cost_0 : net.cost_1) {
          if (random() % 3 == 0) cost = static_cast<std::int64_t>(random() % 2000) * highest / 1000;
        }
      }
    }
  }
}

TEST(SeparateFigure, IsThatOfItsDefinition) {
  int figures = 0;
  int by_colour = 0;
  int by_skirting = 0;
  int by_border = 0;
  int by_part = 0;
  std::vector<Size> all_sizes = sizes();
  all_sizes.push_back({84, 40});
  for (const Size size : all_sizes) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      for (const int tenths_of_holes : {3, 8, 9, 10}) {
        const int count = 1 + static_cast<int>(seed) * 3;
        Facets facets = seed > 6        ? random_blocks(size, std::nullopt, seed)
                        : seed % 2 == 0 ? random_blocks(size, count, seed)
                                        : random_facets(size, count, seed);
        if (seed == 9) facets = backwards(facets, seed);
        const DisparityMap map = random_map(size, seed, tenths_of_holes);
        const Background background{{{0.01F, 0.2F, 3}, {-0.05F, 0, 9}}, seed != 3};
        FigureConfig config;
        if (seed > 4) config.skirting = 30;
        if (seed % 2 == 0) config.longest_bridge = 5;
        if (seed % 3 == 0) config.agreement = 40;
        if (seed > 7) config.agreement = 100;
        if (seed % 4 == 0) config.smoothness = 0;
        if (seed % 5 == 0) config.colour_weight = 3;
        if (seed == 7) config.continuation_weight = 3;
        config.border_weight = 0.2F * static_cast<float>(seed % 6);
        config.largest_part = seed == 3 ? 100.0F : 0.7F * static_cast<float>(seed % 4);
        const Image<Rgb> coloured = painted(facets, seed);
        const Image<Gray> grey = greens(coloured);
        const View<const Rgb> rgb = seed > 3 ? coloured.view() : View<const Rgb>{};
        const auto figure = [&](const FigureConfig& with) {
          return separate_figure(facets, grey, rgb, map.disparity_px, background, noise_sigma(grey), with,
                                 {});
        };
        const auto expected =
            reference::separate_figure(facets, grey, rgb, map.disparity_px, background, config);
        for (const std::int32_t f : expected) figures += f;
        EXPECT_EQ(figure(config), expected) << text(size) << ' ' << seed << ' ' << tenths_of_holes;
        FigureConfig plain = config;
        plain.colour_weight = plain.continuation_weight = 0;
        by_colour += figure(plain) != expected ? 1 : 0;
        plain = config;
        plain.skirting = 0;
        by_skirting += figure(plain) != expected ? 1 : 0;
        plain = config;
        plain.border_weight = 1;
        by_border += figure(plain) != expected ? 1 : 0;
        plain = config;
        plain.largest_part = 0;
        by_part += figure(plain) != expected ? 1 : 0;
      }
    }
  }
  EXPECT_GT(figures, 50);
  EXPECT_GT(by_colour, 5);
  EXPECT_GT(by_skirting, 3);
  EXPECT_GT(by_border, 5);
  EXPECT_GT(by_part, 5);
}

void expect_same_bits(const Segmentation& segmentation, const Segmentation& expected) {
  EXPECT_EQ(numbers(segmentation.labels), numbers(expected.labels));
  ASSERT_EQ(segmentation.regions.size(), expected.regions.size());
  for (std::size_t i = 0; i < expected.regions.size(); ++i) {
    const Region& p = segmentation.regions[i];
    const Region& q = expected.regions[i];
    EXPECT_EQ(p.pixel_count, q.pixel_count) << i;
    EXPECT_EQ(p.valid_count, q.valid_count) << i;
    EXPECT_EQ(p.box, q.box) << i;
    EXPECT_EQ(p.is_background, q.is_background) << i;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.mean), std::bit_cast<std::uint64_t>(q.mean)) << i;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(p.variance), std::bit_cast<std::uint64_t>(q.variance)) << i;
  }
}

TEST(GroupFacets, IsThatOfItsDefinition) {
  std::size_t groups = 0;
  int united = 0;
  std::vector<Size> all_sizes = sizes();
  all_sizes.push_back({160, 90});
  for (const Size size : all_sizes) {
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
      const Facets facets = seed % 3 == 0   ? random_facets(size, 40, seed)
                            : seed % 3 == 1 ? random_blocks(size, std::nullopt, seed)
                                            : backwards(random_blocks(size, 12, seed), seed);
      const DisparityMap map = random_map(size, seed, static_cast<int>(seed % 4) * 2);
      const Image<Gray> picture = random_picture(size, seed);
      const Image<float> evidence =
          find_evidence(picture, map, noise_sigma(picture), {0.3F, 0.5F, 40.0F}, {});
      std::mt19937 random(seed);
      std::vector<std::int32_t> figure(static_cast<std::size_t>(facets.count));
      for (std::int32_t& f : figure) f = random() % 5 == 0 ? 0 : 1;
      const Background background{{{0.01F, 0.02F, 1}, {-0.02F, 0, 2}}, true};
      std::optional<StereoRig> rig;
      if (seed % 2 == 0)
        rig = StereoRig{.focal_px = 300, .cx_px = 80, .cy_px = 45, .baseline_m = 0.1F, .doffs_px = 3};
      GroupConfig config;
      config.step = 10.0F * static_cast<float>(seed % 4);
      config.deviation = 15.0F * static_cast<float>(seed % 5);
      if (seed > 6) config.min_area = 0.05F;
      if (seed > 9) config.occluded_gap = 80;
      const Segmentation expected =
          reference::group_facets(facets, figure, map, evidence, background, rig, {}, config);
      groups += expected.regions.size() - 1;
      GroupConfig apart = config;
      apart.occluded_gap = 0;
      for (const int count : {1, 2}) {
        const Exec exec = threads(count);
        expect_same_bits(group_facets(facets, figure, map, evidence, background, rig, {}, config, exec),
                         expected);
        united +=
            group_facets(facets, figure, map, evidence, background, rig, {}, apart, exec).regions.size() !=
                    expected.regions.size()
                ? 1
                : 0;
      }
    }
  }
  EXPECT_GT(groups, 300U);
  EXPECT_GT(united, 5);
}

TEST(SegmentFacets, GivesTheSameOnAnyNumberOfThreads) {
  for (const Size size : sizes()) {
    const Image<Gray> grey = random_picture(size, 4);
    const Image<Rgb> rgb = random_colours(size, 4);
    for (const bool colour : {false, true}) {
      const View<const Rgb> colours = colour ? rgb.view() : View<const Rgb>{};
      const Facets expected = segment_facets(grey, colours, noise_sigma(grey), {}, {});
      for (const int count : {2, 3}) {
        const Facets facets = segment_facets(grey, colours, noise_sigma(grey), {}, threads(count));
        EXPECT_EQ(facets.count, expected.count);
        EXPECT_EQ(numbers(facets.labels), numbers(expected.labels)) << text(size);
        expect_equal(facets.borders, expected.borders);
      }
    }
  }
}

/// Every pixel in exactly one region, and each region's statistics those of its pixels.
void expect_partition(const Segmentation& segmentation, const DisparityMap& map) {
  const auto count = static_cast<std::int32_t>(segmentation.regions.size());
  std::map<std::int32_t, std::pair<int, double>> seen;  // valid pixels, sum
  std::vector<int> pixels(segmentation.regions.size());
  for (int y = 0; y < segmentation.labels.height(); ++y) {
    for (int x = 0; x < segmentation.labels.width(); ++x) {
      const std::int32_t id = number(segmentation.labels(x, y));
      ASSERT_GE(id, 0);
      ASSERT_LT(id, count);
      ++pixels[static_cast<std::size_t>(id)];
      if (map.reject(x, y) != Reject::none) continue;
      ++seen[id].first;
      seen[id].second += map.disparity_px(x, y);
    }
  }
  for (std::int32_t id = 0; id < count; ++id) {
    const Region& region = segmentation.regions[static_cast<std::size_t>(id)];
    const auto [valid, sum] = seen[id];
    EXPECT_EQ(region.pixel_count, pixels[static_cast<std::size_t>(id)]);
    EXPECT_EQ(region.valid_count, valid);
    EXPECT_NEAR(region.mean, valid > 0 ? sum / valid : 0.0, 1e-6);
    EXPECT_GE(region.variance, 0);
    EXPECT_EQ(region.is_background, id == 0);
    EXPECT_FALSE(region.is_floor);
  }
}

Config by_evidence() {
  Config config;
  config.fusion.method = FusionMethod::evidence;
  config.speckle.size = -1;  // facets are grouped before islands go, so the frame's own map has to keep them
  return config;
}

/// Runs the way from a picture and a map to objects on one and on three threads and looks at what it gives.
void run_and_check(View<const Gray> grey, View<const Rgb> rgb, const DisparityMap& map,
                   const std::optional<StereoRig>& rig, const Config& config) {
  const auto run = [&](int count) {
    const Exec exec = threads(count);
    return segment(grey, rgb, {map.disparity_px.clone(), map.reject.clone()}, rig, config, exec);
  };
  const Frame frame = run(1);
  expect_partition(frame.groups, frame.disparity);
  EXPECT_EQ(frame.superpixels.labels.size(), grey.size());
  const Frame again = run(3);
  EXPECT_EQ(numbers(again.superpixels.labels), numbers(frame.superpixels.labels));
  EXPECT_EQ(numbers(again.groups.labels), numbers(frame.groups.labels));
  EXPECT_EQ(numbers(again.objects.labels), numbers(frame.objects.labels));
}

constexpr StereoRig kRig{60, 30, 25, 0.1F, 0};

TEST(WayByEvidence, PartitionsAnyPictureWithAnyDisparities) {
  for (const Size size : sizes()) {
    for (const int tenths_of_holes : {0, 3, 10}) {
      const Image<Gray> grey = random_picture(size, 8);
      const Image<Rgb> rgb = random_colours(size, 8);
      const DisparityMap map = random_map(size, 9, tenths_of_holes);
      run_and_check(grey, {}, map, std::nullopt, by_evidence());
      run_and_check(grey, rgb, map, kRig, by_evidence());
    }
  }
}

TEST(WayByEvidence, ManagesNoiseForAPictureAndForDisparities) {
  const Size size{67, 53};
  const Image<Gray> grey = random_image<Gray>(size, 0, 255, 1);
  const Image<int> noise = random_image<int>(size, -200, 2000, 2);
  DisparityMap map = random_map(size, 3, 5);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (map.reject(x, y) == Reject::none) map.disparity_px(x, y) = static_cast<float>(noise(x, y));
    }
  }
  run_and_check(grey, {}, map, kRig, by_evidence());
}

TEST(WayByEvidence, ManagesPlainPicturesWithoutAnyEvidence) {
  for (const Size size : sizes()) {
    const Image<Gray> grey(size, Gray{128}, {});
    run_and_check(grey, {}, random_map(size, 4, 2), kRig, by_evidence());
  }
}

TEST(WayByEvidence, ManagesAMissingGround) {
  const Size size{67, 53};
  Config config = by_evidence();
  config.ground.source = GroundSource::off;
  const Image<Gray> grey = random_picture(size, 1);
  run_and_check(grey, {}, random_map(size, 1), kRig, config);
  run_and_check(grey, {}, random_map(size, 1), std::nullopt, config);
}

TEST(WayByEvidence, ManagesOptionsAtTheEndsOfTheirRanges) {
  const Size size{41, 29};
  const Image<Gray> grey = random_picture(size, 2);
  const Image<Rgb> rgb = random_colours(size, 2);
  const DisparityMap map = random_map(size, 2);
  for (const bool most : {false, true}) {
    Config config = by_evidence();
    const auto end = [most](float least, float greatest) { return most ? greatest : least; };
    config.evidence = {end(0, 100), end(0, 255), end(0, 100)};
    run_and_check(grey, rgb, map, kRig, config);
    config.evidence = {0, 0, 100};
    config.background = {most ? 8 : 0, end(0, 100), 0, end(0, 100), 100};
    run_and_check(grey, rgb, map, kRig, config);
    config.facets = {end(0, 5), end(0, 255), end(0, 100)};
    run_and_check(grey, rgb, map, kRig, config);
    config.facets = {};
    config.figure = {0,           end(0, 100), end(0, 100), end(0, 1),  end(0, 100),
                     end(0, 100), end(0, 10),  end(0, 10),  end(0, 100)};
    config.group = {end(0, 1000), end(0, 100), end(0, 1000), end(0, 100),
                    end(0, 100),  end(0, 100), end(0, 100)};
    run_and_check(grey, rgb, map, kRig, config);
  }
}

TEST(WayByEvidence, GoesAllTheWayFromSmallPairs) {
  Config config = by_evidence();
  config.match.window_size = 3;
  config.texture.window_size = 3;
  config.match.num_disparities = 2;
  for (const Size size : {Size{3, 3}, Size{3, 20}, Size{24, 3}, Size{31, 23}}) {
    const Image<Gray> left = random_picture(size, 1);
    const Image<Gray> right = random_picture(size, 2);
    const Frame frame = segment(StereoPair::from(left, right), std::nullopt, config, {});
    expect_partition(frame.groups, frame.disparity);
  }
}

}  // namespace
}  // namespace cairn
