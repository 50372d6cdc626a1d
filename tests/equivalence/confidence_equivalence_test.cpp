// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/confidence.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/first_difference.hpp"
#include "support/noise.hpp"

namespace cairn {
namespace {

// The twin computes in double and with the library's exp(), so the two differ by float rounding.
constexpr double kRounding = 2e-6;

struct Case {
  Matches matches;
  DisparityMap disparity;
};

/// Costs of all kinds, including equal and missing ones, and disparity steps with holes.
Case random_case(Size size, std::uint32_t seed) {
  support::Noise noise(seed);
  Case c;
  for (Image<float>* map : {&c.matches.cost, &c.matches.runner_up, &c.matches.mean_cost}) {
    *map = Image<float>(size);
  }
  c.disparity = {Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool hole = noise.uniform() < 0.2;
      const bool lone = noise.uniform() < 0.05;
      const bool nothing = noise.uniform() < 0.05;
      const auto cost = nothing ? 0.0F : static_cast<float>(100 * noise.uniform());
      c.matches.cost(x, y) = hole ? kNoCost : cost;
      c.matches.runner_up(x, y) = hole || lone ? kNoCost : cost + static_cast<float>(50 * noise.uniform());
      c.matches.mean_cost(x, y) = nothing ? 0.0F : cost + static_cast<float>(200 * noise.uniform());
      const float step = static_cast<float>((x / 7 + y / 5) % 3) * 0.9F;
      c.disparity.disparity_px(x, y) = hole ? std::numeric_limits<float>::quiet_NaN() : step;
      c.disparity.reject(x, y) = hole ? Reject::border : Reject::none;
    }
  }
  return c;
}

void expect_equal_to_reference(Size size, std::uint32_t seed, const ConfidenceModel& model) {
  const Case c = random_case(size, seed);
  const Image<float> expected = reference::estimate_confidence(c.matches, c.disparity, model);
  const Image<float> got = estimate_confidence(c.matches, c.disparity, model, {});
  ASSERT_EQ(got.size(), size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      ASSERT_NEAR(got(x, y), expected(x, y), kRounding) << text(size) << " at " << x << ", " << y;
    }
  }
}

TEST(ConfidenceEquivalence, HoldsForEverySize) {
  const ConfidenceModel model = confidence_model(MatchMethod::semi_global);
  for (int width = 1; width <= 40; ++width) expect_equal_to_reference({width, 9}, 1, model);
  for (int height = 1; height <= 40; ++height) expect_equal_to_reference({9, height}, 2, model);
}

TEST(ConfidenceEquivalence, HoldsForEverySignOnItsOwnAndForBothMethods) {
  for (const ConfidenceModel& model :
       {ConfidenceModel{}, ConfidenceModel{.bias = -2}, ConfidenceModel{.margin = 3},
        ConfidenceModel{.cost = -3}, ConfidenceModel{.jumps = -7}, ConfidenceModel{.holes = 4},
        ConfidenceModel{.bias = 100}, ConfidenceModel{.bias = -100}, confidence_model(MatchMethod::window),
        confidence_model(MatchMethod::semi_global)}) {
    expect_equal_to_reference({53, 37}, 3, model);
  }
}

TEST(ConfidenceEquivalence, NumberOfThreadsChangesNoBit) {
  const Case c = random_case({61, 311}, 4);
  const ConfidenceModel model = confidence_model(MatchMethod::window);
  const Image<float> alone = estimate_confidence(c.matches, c.disparity, model, {});
  for (const int threads : {2, 3, 7}) {
    EXPECT_EQ(first_difference(
                  alone, estimate_confidence(c.matches, c.disparity, model, Exec::with_threads(threads))),
              "");
  }
}

}  // namespace
}  // namespace cairn
