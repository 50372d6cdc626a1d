// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The row kernels behind evidence, edges and walls on every instruction set, and facets, against their slow
// twins.
#include "reference/facets.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/plane_kernels.hpp>
#include <cmath>
#include <limits>

#include "reference/evidence.hpp"
#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::numbers;
using grids::random_image;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<Size> sizes() {
  return {{1, 1}, {1, 23}, {29, 1}, {2, 2}, {3, 3}, {5, 19}, {33, 17}, {67, 41}, {90, 64}};
}

Exec on(Target target, int threads) {
  Exec exec = Exec::with_threads(threads, target);
  exec.pool = Pool::make();
  return exec;
}

/// Blocks of different brightness, more or less noisy.
Image<Gray> blocks(Size size, int noise, std::uint32_t seed) {
  const Image<int> level = random_image<int>({size.width / 9 + 1, size.height / 7 + 1}, 40, 210, seed);
  const Image<int> disturbance = random_image<int>(size, -noise, noise, seed + 1);
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      image(x, y) = static_cast<Gray>(level(x / 9, y / 7) + disturbance(x, y));
  }
  return image;
}

Image<Rgb> coloured(Size size, int noise, std::uint32_t seed) {
  const Image<Gray> r = blocks(size, noise, seed);
  const Image<Gray> g = blocks(size, noise, seed + 10);
  const Image<Gray> b = blocks(size, noise, seed + 20);
  Image<Rgb> rgb(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) rgb(x, y) = {r(x, y), g(x, y), b(x, y)};
  }
  return rgb;
}

DisparityMap disparities(Size size, std::uint32_t seed) {
  const Image<int> value = random_image<int>(size, 0, 9, seed);
  DisparityMap map{Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool hole = value(x, y) == 0;
      map.disparity_px(x, y) = hole ? kNaN : 10.0F + 0.05F * static_cast<float>(value(x, y));
      map.reject(x, y) = hole ? Reject::left_right : Reject::none;
    }
  }
  return map;
}

std::vector<std::uint32_t> bits(const Image<float>& image) {
  std::vector<std::uint32_t> all;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x)
      all.push_back(std::isnan(image(x, y)) ? 0 : std::bit_cast<std::uint32_t>(image(x, y)));
  }
  return all;
}

void expect_equal(const Facets& facets, const Facets& expected) {
  EXPECT_EQ(facets.count, expected.count);
  EXPECT_EQ(numbers(facets.labels), numbers(expected.labels));
  ASSERT_EQ(facets.borders.size(), expected.borders.size());
  for (std::size_t i = 0; i < facets.borders.size(); ++i) {
    EXPECT_EQ(facets.borders[i].a, expected.borders[i].a) << i;
    EXPECT_EQ(facets.borders[i].b, expected.borders[i].b) << i;
    EXPECT_EQ(facets.borders[i].length, expected.borders[i].length) << i;
    EXPECT_EQ(facets.borders[i].edge_sum, expected.borders[i].edge_sum) << i;
    EXPECT_EQ(facets.borders[i].x2_sum, expected.borders[i].x2_sum) << i;
    EXPECT_EQ(facets.borders[i].y2_sum, expected.borders[i].y2_sum) << i;
  }
}

TEST(EdgeStrength, IsThatOfItsDefinitionOnEveryTarget) {
  for (const Size size : sizes()) {
    const Image<Gray> grey = blocks(size, 30, 1);
    const Image<Rgb> rgb = coloured(size, 30, 2);
    for (const float sigma : {0.0F, 0.7F, 5.0F}) {
      const auto plain = numbers(reference::edge_strength(grey, {}, sigma));
      const auto colour = numbers(reference::edge_strength(grey, rgb, sigma));
      for (const Target target : supported_targets()) {
        EXPECT_EQ(numbers(edge_strength(grey, {}, sigma, on(target, 1))), plain) << name(target);
        EXPECT_EQ(numbers(edge_strength(grey, rgb, sigma, on(target, 2))), colour) << name(target);
      }
    }
  }
}

TEST(FindEvidence, IsThatOfItsDefinitionOnEveryTarget) {
  for (const Size size : sizes()) {
    const Image<Gray> grey = blocks(size, 25, 3);
    const DisparityMap map = disparities(size, 4);
    const EvidenceConfig config{0.5F, 1.0F, 3.0F};
    const auto expected = bits(reference::find_evidence(grey, map, config));
    for (const Target target : supported_targets())
      EXPECT_EQ(bits(find_evidence(grey, map, noise_sigma(grey), config, on(target, 2))), expected)
          << name(target);
  }
}

TEST(SegmentFacets, IsThatOfItsDefinition) {
  int facets = 0;
  for (const Size size : sizes()) {
    for (const int noise : {0, 4, 40}) {
      const Image<Gray> grey = blocks(size, noise, 5);
      const Image<Rgb> rgb = coloured(size, noise, 6);
      const FacetsConfig config{0.7F, noise == 4 ? 12.0F : 2.0F, 1.0F};
      const Facets plain = segment_facets(grey, {}, noise_sigma(grey), config, {});
      expect_equal(plain, reference::segment_facets(grey, {}, config));
      expect_equal(segment_facets(grey, rgb, noise_sigma(grey), config, on(Target::best, 2)),
                   reference::segment_facets(grey, rgb, config));
      facets += plain.count;
    }
  }
  EXPECT_GT(facets, 100);  // else there would be nothing to compare
}

TEST(PointCounts, AreThoseOfTheirDefinitionsOnEveryTarget) {
  const int count = 77;
  const Image<float> p = [&] {
    const Image<int> value = random_image<int>({count, 4}, 0, 400, 7);
    Image<float> scaled(value.size());
    for (int i = 0; i < 4; ++i) {
      for (int x = 0; x < count; ++x) scaled(x, i) = static_cast<float>(value(x, i)) * 0.1F;
    }
    return scaled;
  }();
  const GroundPlane plane{0.3F, 0.2F, 5.0F};
  const auto at = [&](int i) { return plane.a * p(i, 0) + plane.b * p(i, 1) + plane.c; };
  for (const int some : {0, 1, 7, 16, count}) {
    const kernels::PointArrays points{p.row(0), p.row(1), p.row(2), p.row(3), some};
    int on_plane = 0;
    int beyond = 0;
    for (int i = 0; i < some; ++i) {
      on_plane += std::abs(p(i, 2) - at(i)) < 6.0F ? 1 : 0;
      beyond += p(i, 2) - std::max(p(i, 3), at(i)) < -6.0F ? 1 : 0;
    }
    for (const Target target : supported_targets()) {
      EXPECT_EQ(kernels::plane_kernels(target)->count_on(points, plane, 6.0F), on_plane) << name(target);
      EXPECT_EQ(kernels::plane_kernels(target)->count_beyond(points, plane, 6.0F), beyond) << name(target);
    }
  }
}

TEST(RowKernels, AreThereForTheSameTargetsAsThoseOfTheMatcher) {
  for (const Target target : compiled_targets()) EXPECT_NE(kernels::plane_kernels(target), nullptr);
}

}  // namespace
}  // namespace cairn
