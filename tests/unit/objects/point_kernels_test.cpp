// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/ids.hpp>
#include <cairn/core/target.hpp>
#include <cairn/objects/point_kernels.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace cairn {
namespace {

constexpr int kCount = 203;  // ends within a vector of any target
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<const kernels::PointKernels*> all_kernels() {
  std::vector<const kernels::PointKernels*> all;
  for (const Target target : supported_targets()) all.push_back(kernels::point_kernels(target));
  return all;
}

struct Lists {
  std::vector<float> x = std::vector<float>(kCount);
  std::vector<float> y = x;
  std::vector<float> z = x;
  kernels::PointLists lists() { return {x.data(), y.data(), z.data()}; }
};

std::vector<float> drawn(std::uint32_t seed, float most) {
  std::mt19937 random(seed);
  std::vector<float> values(kCount);
  for (float& value : values) value = (static_cast<float>(random() % 20001) * 0.0001F - 1) * most;
  return values;
}

/// Equality of bits, which distinguishes −0 from 0; all NaN are equal.
void expect_same(float got, float expected, int i) {
  if (std::isnan(expected)) {
    EXPECT_TRUE(std::isnan(got)) << i;
  } else {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(got), std::bit_cast<std::uint32_t>(expected)) << i;
  }
}

TEST(PointKernels, PlaceAPixelAsTheRigDoes) {
  constexpr StereoRig kRig{.focal_px = 100, .cx_px = 40, .cy_px = 20, .baseline_m = 0.1F, .doffs_px = 1};
  constexpr float kMaxDistance = 8;  // m
  std::vector<float> disparity_px = drawn(1, 9);
  disparity_px[3] = kNan;
  disparity_px[4] = -1;
  disparity_px[5] = std::nextafter(-1.0F, 0.0F);
  for (const kernels::PointKernels* const run : all_kernels()) {
    Lists out;
    const int near =
        run->points_in_camera(kRig, {7, 5}, kCount, disparity_px.data(), kMaxDistance, out.lists());
    int expected_near = 0;
    for (int i = 0; i < kCount; ++i) {
      const Vec3 expected = kRig.point_in_camera_m(static_cast<float>(7 + i), 5, disparity_px[slot(i)])
                                .value_or(Vec3{kNan, kNan, kNan});
      expect_same(out.x[slot(i)], expected.x, i);
      expect_same(out.y[slot(i)], expected.y, i);
      expect_same(out.z[slot(i)], expected.z, i);
      expected_near += std::abs(expected.x) <= kMaxDistance && std::abs(expected.y) <= kMaxDistance &&
                               std::abs(expected.z) <= kMaxDistance
                           ? 1
                           : 0;
    }
    EXPECT_EQ(near, expected_near);
  }
}

TEST(PointKernels, TransformPointsAsTheFloorFrameDoes) {
  const FloorFrame floor{{0.1F, 0.2F, 0.97F}, {-0.99F, 0.1F, 0.08F}, {0.08F, -0.97F, 0.2F}, 1.25F};
  Lists points{drawn(2, 5), drawn(3, 5), drawn(4, 5)};
  points.x[9] = points.y[9] = points.z[9] = -0.0F;
  for (const kernels::PointKernels* const run : all_kernels()) {
    Lists out;
    run->points_in_floor(floor, points.lists(), kCount, out.lists());
    for (int i = 0; i < kCount; ++i) {
      const Vec3 expected = floor.to_floor({points.x[slot(i)], points.y[slot(i)], points.z[slot(i)]});
      expect_same(out.x[slot(i)], expected.x, i);
      expect_same(out.y[slot(i)], expected.y, i);
      expect_same(out.z[slot(i)], expected.z, i);
    }
  }
}

TEST(PointKernels, FindTheSidesWithoutTheTails) {
  const std::vector<float> xs = drawn(7, 3);
  const std::vector<float> ys = drawn(8, 2);
  for (const kernels::PointKernels* const run : all_kernels()) {
    for (const int count : {6, 40, kCount}) {
      for (std::size_t tail = 0; tail < kernels::TurnedRectangles::kMaxTail; ++tail) {
        kernels::TurnedRectangles rectangles;
        for (std::size_t k = 0; k < kernels::TurnedRectangles::kCount; ++k) {
          rectangles.cosine[k] = std::cos(0.1F * static_cast<float>(k));
          rectangles.sine[k] = std::sin(0.1F * static_cast<float>(k));
        }
        const std::size_t high_tail = kernels::TurnedRectangles::kMaxTail - 1 - tail;
        run->find_sides(xs.data(), ys.data(), count, tail, high_tail, rectangles);
        for (std::size_t k = 0; k < kernels::TurnedRectangles::kCount; ++k) {
          std::array<std::vector<float>, 2> turned;
          for (auto& axis : turned) axis.resize(slot(count));
          run->turn(xs.data(), ys.data(), count, rectangles.cosine[k], rectangles.sine[k], turned[0].data(),
                    turned[1].data());
          for (std::size_t axis = 0; axis < 2; ++axis) {
            std::sort(turned.at(axis).begin(), turned.at(axis).end());
            EXPECT_EQ(rectangles.low.at(axis)[k], turned.at(axis)[tail]) << k;
            EXPECT_EQ(rectangles.high.at(axis)[k], turned.at(axis)[slot(count) - 1 - high_tail]) << k;
          }
        }
      }
    }
  }
}

TEST(PointKernels, SumTheDistancesFromEachRectangleInOrder) {
  const std::vector<float> xs = drawn(5, 3);
  const std::vector<float> ys = drawn(6, 2);
  kernels::TurnedRectangles rectangles;
  for (std::size_t k = 0; k < kernels::TurnedRectangles::kCount; ++k) {
    rectangles.cosine[k] = std::cos(0.1F * static_cast<float>(k));
    rectangles.sine[k] = std::sin(0.1F * static_cast<float>(k));
    rectangles.low = {rectangles.cosine, rectangles.sine};
    rectangles.high = {rectangles.sine, rectangles.cosine};
  }
  for (const kernels::PointKernels* const run : all_kernels()) {
    kernels::TurnedRectangles::Each<double> sums;
    run->sum_distances(xs.data(), ys.data(), kCount, rectangles, sums);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      std::vector<float> us(kCount);
      std::vector<float> vs(kCount);
      run->turn(xs.data(), ys.data(), kCount, rectangles.cosine[k], rectangles.sine[k], us.data(), vs.data());
      double expected = 0;
      for (std::size_t i = 0; i < us.size(); ++i) {
        const float u = rectangles.cosine[k] * xs[i] + rectangles.sine[k] * ys[i];
        const float v = rectangles.cosine[k] * ys[i] - rectangles.sine[k] * xs[i];
        ASSERT_EQ(us[i], u);
        ASSERT_EQ(vs[i], v);
        expected +=
            double{std::min({std::abs(u - rectangles.low[0][k]), std::abs(rectangles.high[0][k] - u),
                             std::abs(v - rectangles.low[1][k]), std::abs(rectangles.high[1][k] - v)})};
      }
      EXPECT_EQ(sums[k], expected) << k;
    }
  }
}

}  // namespace
}  // namespace cairn
