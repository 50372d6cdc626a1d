// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/cairn.hpp>
#include <cmath>
#include <limits>

#include "support/first_difference.hpp"
#include "support/synthetic_scene.hpp"

namespace cairn {
namespace {

constexpr Size kSize{40, 40};
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr ConfidenceModel kModel = confidence_model(MatchMethod::semi_global);

/// A fronto-parallel surface, matched equally well everywhere.
struct Scene {
  Matches matches;
  DisparityMap disparity;
  [[nodiscard]] Image<float> confidence(const ConfidenceModel& model = kModel) const {
    return estimate_confidence(matches, disparity, model, {});
  }
};

Scene surface(float cost = 20, float runner_up = 60, float mean_cost = 100) {
  Scene scene;
  scene.matches.cost = Image<float>(kSize, cost, {});
  scene.matches.runner_up = Image<float>(kSize, runner_up, {});
  scene.matches.mean_cost = Image<float>(kSize, mean_cost, {});
  scene.disparity = {Image<float>(kSize, 8.0F, {}), Image<Reject>(kSize, Reject::none, {})};
  return scene;
}

TEST(Confidence, IsTheLogisticFunctionOfItsSigns) {
  const ConfidenceModel model{.bias = 0.5F, .margin = 1.0F, .cost = -2.0F};
  EXPECT_NEAR(surface(20, 60, 100).confidence(model)(20, 20), 1 / (1 + std::exp(-(0.5 + 0.4 - 0.4))), 1e-6);
}

TEST(Confidence, IsZeroWithoutADisparity) {
  Scene scene = surface();
  scene.disparity.disparity_px(3, 5) = kNaN;
  scene.disparity.reject(3, 5) = Reject::speckle;
  scene.matches.cost(4, 5) = scene.matches.runner_up(4, 5) = kNoCost;  // nor any match
  scene.disparity.disparity_px(4, 5) = kNaN;
  scene.disparity.reject(4, 5) = Reject::border;
  const Image<float> confidence = scene.confidence();
  EXPECT_EQ(confidence(3, 5), 0);
  EXPECT_EQ(confidence(4, 5), 0);
  EXPECT_GT(confidence(20, 20), 0.9F);
}

TEST(Confidence, GrowsWithTheLeadOverTheRunnerUpAndFallsWithTheCost) {
  EXPECT_GT(surface(20, 80).confidence()(20, 20), surface(20, 30).confidence()(20, 20));
  EXPECT_GT(surface(20, 60).confidence()(20, 20), surface(60, 100).confidence()(20, 20));
  EXPECT_EQ(first_difference(surface(20, kNoCost).confidence(), surface(20, 1000).confidence()), "");
}

TEST(Confidence, DoesNotDependOnTheUnitOfTheCosts) {
  EXPECT_NEAR(surface(20, 60, 100).confidence()(20, 20), surface(0.2F, 0.6F, 1).confidence()(20, 20), 1e-6);
}

TEST(Confidence, FallsNextToHolesWithinTheWindow) {
  Scene scene = surface();
  scene.disparity.disparity_px(20, 20) = kNaN;
  scene.disparity.reject(20, 20) = Reject::left_right;
  const Image<float> confidence = scene.confidence();
  const float whole = surface().confidence()(0, 0);
  EXPECT_LT(confidence(21, 20), whole);
  EXPECT_LT(confidence(26, 26), whole);
  EXPECT_EQ(confidence(27, 20), whole);
  EXPECT_EQ(confidence(20, 27), whole);
}

TEST(Confidence, FallsNextToDisparityStepsButNotOnSlopes) {
  Scene step = surface();
  Scene slope = surface();
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      step.disparity.disparity_px(x, y) = x < 20 ? 8.0F : 9.5F;
      slope.disparity.disparity_px(x, y) = 8.0F + 0.9F * static_cast<float>(x) + 0.9F * static_cast<float>(y);
    }
  }
  EXPECT_LT(step.confidence()(20, 20), surface().confidence()(20, 20));
  EXPECT_EQ(first_difference(surface().confidence(), slope.confidence()), "");
}

TEST(Confidence, CountsSharesSoThatTheImageBorderHasNoEffect) {
  const Image<float> confidence = surface().confidence();
  EXPECT_EQ(confidence(0, 0), confidence(20, 20));
  EXPECT_EQ(confidence(39, 17), confidence(20, 20));
}

TEST(Confidence, IsFiniteIfAllCostsAreZero) {
  const float c = surface(0, 0, 0).confidence()(20, 20);
  EXPECT_GE(c, 0);
  EXPECT_LE(c, 1);
}

TEST(Confidence, IsEmptyWithoutRunnerUp) {
  Scene scene = surface();
  scene.matches.runner_up = {};
  EXPECT_TRUE(scene.confidence().empty());
}

/// Dots 6 px apart in the two images, and a part of the right image with other content.
struct Dots {
  Image<Gray> left = synthetic::random_dots({160, 120}, 1);
  Image<Gray> right = synthetic::random_dots({160, 120}, 2);
  Dots() {
    for (int y = 0; y < 80; ++y) std::copy_n(left.row(y) + 6, 154, right.row(y));
  }
  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left, right); }
};

Config sixteen_disparities(Config config = {}) {
  config.match.num_disparities = 16;
  return config;
}

TEST(Confidence, SeparatesCorrectFromWrongMatchesWithBothPresets) {
  const Dots dots;
  for (const Config& preset : {Config(), Config::paper()}) {
    const Config config = sixteen_disparities(preset);
    const StereoResult scene = estimate_disparity(dots.pair(), std::nullopt, config, {});
    ASSERT_EQ(scene.confidence.size(), dots.left.size());
    double right = 0;
    double wrong = 0;
    for (int y = 10; y < 70; ++y) {
      for (int x = 30; x < 140; ++x) right += scene.confidence(x, y) / (60.0 * 110);
    }
    for (int y = 90; y < 120; ++y) {
      for (int x = 30; x < 140; ++x) wrong += scene.confidence(x, y) / (30.0 * 110);
    }
    EXPECT_GT(right, 0.95);
    EXPECT_LT(wrong, 0.5);
  }
}

TEST(Confidence, IsZeroExactlyAtHolesOfTheFramesDisparity) {
  const Dots dots;
  const Frame frame = segment(dots.pair(), std::nullopt, sixteen_disparities(), {});
  ASSERT_EQ(frame.confidence.size(), dots.left.size());
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      EXPECT_EQ(frame.confidence(x, y) == 0, frame.disparity.reject(x, y) != Reject::none) << x << ", " << y;
      EXPECT_LE(frame.confidence(x, y), 1);
    }
  }
}

TEST(Confidence, IsComputedWhicheverChecksAreOff) {
  const Dots dots;
  Config config = sixteen_disparities();
  config.left_right.max_diff = -1;
  config.subpixel.method = SubpixelMethod::none;
  EXPECT_EQ(segment(dots.pair(), std::nullopt, config, {}).confidence.size(), dots.left.size());
}

TEST(Confidence, IsUnknownForExternalDisparities) {
  const Dots dots;
  const Image<float> given({160, 120}, 6.0F, {});
  const Frame frame = segment({{dots.left}, {}, external_disparity(given, {})}, {std::nullopt, {}, {}});
  EXPECT_TRUE(frame.confidence.empty());
}

}  // namespace
}  // namespace cairn
