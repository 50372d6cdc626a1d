// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/stereo/speckle.hpp>

#include <cmath>
#include <limits>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using Rows = std::vector<std::vector<std::int64_t>>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Rows verdict(const Image<float>& disparity, const SpeckleConfig& config) {
  Image<Reject> reject(disparity.size());
  for (int y = 0; y < reject.height(); ++y) {
    for (int x = 0; x < reject.width(); ++x) {
      reject(x, y) = std::isnan(disparity(x, y)) ? Reject::left_right : Reject::none;
    }
  }
  const auto map = reject_speckles({disparity.clone(), std::move(reject)}, config, {});
  for (int y = 0; y < disparity.height(); ++y) {
    for (int x = 0; x < disparity.width(); ++x) {
      EXPECT_EQ(std::isnan(map.disparity_px(x, y)), map.reject(x, y) != Reject::none);
    }
  }
  return numbers(map.reject);
}

TEST(Speckle, RejectsIslandsOfUpToTheGivenSize) {
  const auto map = grid<float>({{5, 5, 5, 5}, {5, 9, 9, 5}, {5, 5, 5, 5}});
  EXPECT_EQ(verdict(map, {2, 1.0F}), (Rows{{0, 0, 0, 0}, {0, 64, 64, 0}, {0, 0, 0, 0}}));
  EXPECT_EQ(verdict(map, {1, 1.0F}), (Rows{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}));
}

TEST(Speckle, DiagonalNeighboursAreNotConnected) {
  const auto map = grid<float>({{9, 1}, {1, 9}});
  EXPECT_EQ(verdict(map, {1, 1.0F}), (Rows{{64, 64}, {64, 64}}));
}

TEST(Speckle, ASlopeWithSmallStepsIsOneIsland) {
  const auto map = grid<float>({{1, 2, 3, 4, 5, 6}});
  EXPECT_EQ(verdict(map, {5, 1.0F}), (Rows{{0, 0, 0, 0, 0, 0}}));
  EXPECT_EQ(verdict(map, {5, 0.9F}), (Rows{{64, 64, 64, 64, 64, 64}}));
}

TEST(Speckle, HolesDivideIslandsAndKeepTheirReason) {
  const auto map = grid<float, float>({{7, 7, kNaN, 7}});
  EXPECT_EQ(verdict(map, {1, 1.0F}), (Rows{{0, 0, 2, 64}}));
}

TEST(Speckle, WindingIslandsAreCountedWhole) {
  // U, S and similar shapes join runs that started separately.
  const auto map = grid<float, float>({{4, kNaN, 4, kNaN, 4},  //
                                       {4, kNaN, 4, kNaN, 4},  //
                                       {4, kNaN, 4, 4, 4},     //
                                       {4, 4, 4, kNaN, kNaN}});
  EXPECT_EQ(verdict(map, {12, 1.0F})[0], (std::vector<std::int64_t>{0, 2, 0, 2, 0}));
  EXPECT_EQ(verdict(map, {13, 1.0F})[0], (std::vector<std::int64_t>{64, 2, 64, 2, 64}));
}

TEST(Speckle, MinusOneAndZeroRejectNothing) {
  const auto map = grid<float>({{1, 9, 1}});
  EXPECT_EQ(verdict(map, {-1, 1.0F}), (Rows{{0, 0, 0}}));
  EXPECT_EQ(verdict(map, {0, 1.0F}), (Rows{{0, 0, 0}}));
}

}  // namespace
}  // namespace cairn
