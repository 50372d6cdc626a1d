// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/cairn.hpp>
#include <cairn/evaluation/consistency.hpp>
#include <cmath>
#include <limits>

#include "support/synthetic_scene.hpp"

namespace cairn {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{40, 10};
constexpr int kDisparity = 4;

/// Random dots, all kDisparity px apart.
struct Wall {
  Image<Gray> left = synthetic::random_dots(kSize, 1);
  Image<Gray> right = synthetic::random_dots(kSize, 2);
  Image<float> disparity_px{kSize, static_cast<float>(kDisparity), {}};
  Image<std::int16_t> best_right{kSize, std::int16_t{kDisparity}, {}};

  Wall() {
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = kDisparity; x < kSize.width; ++x) right(x - kDisparity, y) = left(x, y);
      for (int x = 0; x < kDisparity; ++x) disparity_px(x, y) = kHole;
    }
  }
  [[nodiscard]] Consistency judged() const { return consistency(left, right, disparity_px, best_right); }
};

TEST(Consistency, OfTheTruthIsDeterminedByItsHoles) {
  const Wall wall;
  const Consistency found = wall.judged();
  EXPECT_EQ(found.pixels, kSize.area());
  EXPECT_EQ(found.matched, (kSize.width - kDisparity) * kSize.height);
  EXPECT_EQ(found.confirmed, found.matched);
  // The images' grey levels differ slightly in mean and deviation, because of the columns visible in one
  // only.
  EXPECT_LT(found.photometric(), 0.5);
  EXPECT_NEAR(found.density(), 0.9, 1e-12);
  EXPECT_EQ(found.agreement(), 1);
}

TEST(Consistency, AnUnconfirmedDisparityCostsMoreThanAHole) {
  Wall wall;
  const double before = wall.judged().loss();
  wall.disparity_px(20, 5) = 9;
  const Consistency wrong = wall.judged();
  EXPECT_EQ(wrong.confirmed, wrong.matched - 1);
  wall.disparity_px(20, 5) = kHole;
  const Consistency hole = wall.judged();
  EXPECT_EQ(hole.confirmed, hole.matched);
  EXPECT_GT(hole.loss(), before);
  EXPECT_NEAR(wrong.loss() - hole.loss(), (1 - kUnmatchedCost) / static_cast<double>(kSize.area()), 1e-9);
}

TEST(Consistency, AgreementAllowsForTheRoundingOfWinners) {
  Wall wall;
  wall.disparity_px(20, 5) = kDisparity + 1.4F;
  EXPECT_EQ(wall.judged().agreement(), 1);
  wall.disparity_px(20, 5) = kDisparity + 1.6F;
  EXPECT_LT(wall.judged().agreement(), 1);
}

TEST(Consistency, PixelsOutsideTheRightImageOrWithoutWinnerAreUnconfirmed) {
  Wall wall;
  wall.disparity_px(1, 0) = kDisparity;
  wall.best_right(10, 2) = kNoMatch;
  const Consistency found = wall.judged();
  EXPECT_EQ(found.matched - found.confirmed, 2);
}

TEST(Consistency, GainAndOffsetOfGreyLevelsAreIgnored) {
  Wall wall;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      wall.left(x, y) = static_cast<Gray>(wall.left(x, y) / 2);
      wall.right(x, y) = static_cast<Gray>(wall.right(x, y) / 2);
    }
  }
  const double same = wall.judged().photometric();
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) wall.right(x, y) = static_cast<Gray>(wall.right(x, y) + 60);
  }
  EXPECT_NEAR(wall.judged().photometric(), same, 1e-9);
}

TEST(Consistency, AConfirmedWrongDisparityCostsByItsGreyLevels) {
  Wall wall;
  const double right = wall.judged().photometric();
  wall.disparity_px.fill(static_cast<float>(kDisparity) + 1);
  EXPECT_GT(wall.judged().photometric(), 2 * right);
}

TEST(Consistency, IsDefinedForImagesOfOnePixel) {
  const Image<Gray> grey({1, 1}, Gray{7}, {});
  const Image<float> zero({1, 1}, 0.0F, {});
  const Image<std::int16_t> back({1, 1}, std::int16_t{0}, {});
  EXPECT_EQ(consistency(grey, grey, zero, back).loss(), 0);
  EXPECT_TRUE(std::isnan(Consistency{}.loss()));
}

TEST(Consistency, PrefersTheSceneOfAFittingSearchRange) {
  const auto scene = synthetic::box_before_wall();
  const auto loss = [&](int num_disparities) {
    Config config;
    config.match.num_disparities = num_disparities;
    Image<std::int16_t> best_right;
    Exec exec;
    exec.observe = [&](std::string_view stage, const StageResult& result, double) {
      if (stage == "match") best_right = result.as<Matches>()->best_right.clone();
    };
    const auto found = estimate_disparity(scene.pair(), std::nullopt, config, exec);
    return consistency(scene.left, scene.right, found.disparity.disparity_px, best_right).loss();
  };
  EXPECT_LT(loss(16), loss(8));  // the box is at 12 px
}

TEST(Steadiness, CountsJumpsAndFlickerInStaticParts) {
  const Image<Gray> picture = synthetic::random_dots(kSize, 1);
  const Image<float> before(kSize, 4.0F, {});
  Image<float> now(kSize, 4.5F, {});
  EXPECT_EQ(steadiness(picture, picture, before, now).unsteady_share(), 0);
  now(3, 3) = 6;
  now(4, 3) = kHole;
  const Steadiness found = steadiness(picture, picture, before, now);
  EXPECT_EQ(found.seen, kSize.area());
  EXPECT_EQ(found.unsteady, 2);
  EXPECT_TRUE(found.follows());
}

TEST(Steadiness, IgnoresMovingPartsAndCommonHoles) {
  const Image<Gray> before = synthetic::random_dots(kSize, 1);
  Image<Gray> now = before.clone();
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 20; x < kSize.width; ++x) now(x, y) = static_cast<Gray>(255 - now(x, y));
  }
  Image<float> d_before(kSize, 4.0F, {});
  Image<float> d_now(kSize, 4.0F, {});
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 25; x < kSize.width; ++x) d_now(x, y) = 9;
  }
  d_before(2, 2) = kHole;
  d_now(2, 2) = kHole;
  const Steadiness found = steadiness(before, now, d_before, d_now);
  EXPECT_EQ(found.unsteady, 0);
  EXPECT_EQ(found.seen, found.still - 1);
  EXPECT_FALSE(found.follows());
  const Image<Gray> other = synthetic::random_dots(kSize, 9);
  EXPECT_FALSE(steadiness(before, other, d_before, d_now).follows());
}

}  // namespace
}  // namespace cairn
