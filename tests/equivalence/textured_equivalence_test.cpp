// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/textured.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

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

/// Blocks of random brightness, some textured: edges, uniform areas and texture.
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

/// Blocks of similar disparity with outliers and holes. Negative `tenths`: no holes.
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

TEST(NoiseSigma, EqualsItsDefinition) {
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

TEST(FindEvidence, EqualsItsDefinitionOnAnyNumberOfThreads) {
  int found = 0;
  for (const Size size : sizes()) {
    for (const std::uint32_t seed : {1U, 2U}) {
      const Image<Gray> image = random_picture(size, seed);
      const DisparityMap map = random_map(size, seed);
      TexturedConfig config;
      if (seed == 2) config = {0.3F, 0.5F, 40.0F};
      const auto expected = bits(reference::select_textured(image, map, config));
      for (const std::uint32_t b : expected) found += b != 0xFFFFFFFFU ? 1 : 0;
      for (const int count : {1, 2, 3}) {
        EXPECT_EQ(bits(select_textured({image, {}, noise_sigma(image)}, map, config, threads(count))),
                  expected)
            << text(size);
      }
    }
  }
  EXPECT_GT(found, 500);  // otherwise nothing would be compared
}

TEST(EdgeStrength, EqualsItsDefinitionWithAndWithoutColour) {
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

Config by_region_tree() {
  Config config;
  config.pipeline.method = Method::region_tree;
  return config;
}

/// Runs the stages from image and disparity map to objects on one and on three threads, and checks the
/// result.
void run_and_check(View<const Gray> grey, View<const Rgb> rgb, const DisparityMap& map,
                   const std::optional<StereoRig>& rig, const Config& config) {
  const auto run = [&](int count) {
    const Exec exec = threads(count);
    return segment({{grey, rgb}, {}, {map.disparity_px.clone(), map.reject.clone()}}, {rig, config, exec});
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

TEST(WayByHierarchy, PartitionsAnyImageWithAnyDisparities) {
  for (const Size size : sizes()) {
    for (const int tenths_of_holes : {0, 3, 10}) {
      const Image<Gray> grey = random_picture(size, 8);
      const Image<Rgb> rgb = random_colours(size, 8);
      const DisparityMap map = random_map(size, 9, tenths_of_holes);
      run_and_check(grey, {}, map, std::nullopt, by_region_tree());
      run_and_check(grey, rgb, map, kRig, by_region_tree());
    }
  }
}

TEST(WayByHierarchy, AcceptsNoiseAsImageAndDisparities) {
  const Size size{67, 53};
  const Image<Gray> grey = random_image<Gray>(size, 0, 255, 1);
  const Image<int> noise = random_image<int>(size, -200, 2000, 2);
  DisparityMap map = random_map(size, 3, 5);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (map.reject(x, y) == Reject::none) map.disparity_px(x, y) = static_cast<float>(noise(x, y));
    }
  }
  run_and_check(grey, {}, map, kRig, by_region_tree());
}

TEST(WayByHierarchy, AcceptsPlainImagesWithoutTexturedDisparities) {
  for (const Size size : sizes()) {
    const Image<Gray> grey(size, Gray{128}, {});
    run_and_check(grey, {}, random_map(size, 4, 2), kRig, by_region_tree());
  }
}

TEST(WayByHierarchy, AcceptsAMissingGround) {
  const Size size{67, 53};
  Config config = by_region_tree();
  config.ground.source = GroundSource::off;
  const Image<Gray> grey = random_picture(size, 1);
  run_and_check(grey, {}, random_map(size, 1), kRig, config);
  run_and_check(grey, {}, random_map(size, 1), std::nullopt, config);
}

TEST(WayByHierarchy, AcceptsOptionsAtTheEndsOfTheirRanges) {
  const Size size{41, 29};
  const Image<Gray> grey = random_picture(size, 2);
  const Image<Rgb> rgb = random_colours(size, 2);
  const DisparityMap map = random_map(size, 2);
  for (const bool most : {false, true}) {
    Config config = by_region_tree();
    const auto end = [most](float least, float greatest) { return most ? greatest : least; };
    config.textured = {end(0, 100), end(0, 255), end(0, 100)};
    run_and_check(grey, rgb, map, kRig, config);
    config.textured = {0, 0, 100};
    config.background = {most ? 8 : 0, end(0, 100), 0, end(0, 100), 100};
    run_and_check(grey, rgb, map, kRig, config);
    config.superpixels.count = most ? 100000 : 1;
    run_and_check(grey, rgb, map, kRig, config);
    config.objects = {.min_area = end(0, 100), .min_confidence = end(0, 1)};
    run_and_check(grey, rgb, map, kRig, config);
  }
}

TEST(WayByHierarchy, SegmentsSmallPairs) {
  Config config = by_region_tree();
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
