// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The checks that judge a pixel by its own costs. For each: its slow twin, the options with which the fast
// function must equal it, and examples.
#include <gtest/gtest.h>

#include <cairn/core/target.hpp>
#include <cairn/stereo/flatness.hpp>
#include <cairn/stereo/uniqueness.hpp>

#include "reference/checks.hpp"
#include "support/grids.hpp"
#include "support/random_input.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using reference::verdicts;

/// Expects that the check equals its twin with each of these options, for all sizes, targets and thread counts.
template <class Config>
void expect_equal(Image<Reject> (*fast)(const Matches&, const Config&, const Exec&),
                  Image<Reject> (*slow)(const Matches&, const Config&), const std::vector<Config>& configs) {
  for (const int threads : {1, 2, 3}) {
    Exec exec = random_input::threads(threads);
    for (const Size size : random_input::sizes()) {
      const Matches matches = random_input::random_matches(size, 0, 12);
      for (std::size_t i = 0; i < configs.size(); ++i) {
        SCOPED_TRACE(text(size) + " options " + std::to_string(i) + " threads " + std::to_string(threads));
        const auto expected = numbers(slow(matches, configs[i]));
        for (const Target target : supported_targets()) {
          exec.target = target;
          EXPECT_EQ(numbers(fast(matches, configs[i], exec)), expected) << name(target);
        }
      }
    }
  }
}

// ---- uniqueness ----

Image<Reject> ambiguous_slowly(const Matches& matches, const UniquenessConfig& config) {
  return verdicts(matches.best.size(), [&](int x, int y) {
    if (config.ratio < 0 || matches.best(x, y) == kNoMatch || matches.runner_up(x, y) == kNoCost)
      return Reject::none;
    const bool ambiguous = matches.runner_up(x, y) * (100.0F - config.ratio) < matches.cost(x, y) * 100.0F;
    return ambiguous ? Reject::not_unique : Reject::none;
  });
}

TEST(Uniqueness, EqualsItsTwin) {
  expect_equal<UniquenessConfig>(reject_ambiguous, ambiguous_slowly, {{-1}, {0}, {10}, {33.3F}, {100}});
}

Matches costs(float cost, float runner_up) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0}});
  matches.cost = grid<float, float>({{cost}});
  matches.runner_up = grid<float, float>({{runner_up}});
  return matches;
}

bool is_ambiguous(float cost, float runner_up, float ratio) {
  return reject_ambiguous(costs(cost, runner_up), {ratio}, {})(0, 0) == Reject::not_unique;
}

TEST(Uniqueness, RejectsAWinnerWhoseRunnerUpIsNearlyAsCheap) {
  EXPECT_TRUE(is_ambiguous(90.5F, 100, 10));
  EXPECT_FALSE(is_ambiguous(89.5F, 100, 10));
}
TEST(Uniqueness, KeepsAWinnerThatBeatsItsRunnerUpByExactlyTheRatio) {
  EXPECT_FALSE(is_ambiguous(90, 100, 10));
}
TEST(Uniqueness, RatioZeroKeepsTies) {
  EXPECT_FALSE(is_ambiguous(7, 7, 0));
}
TEST(Uniqueness, ASingleCandidateIsUniqueWhateverTheRatio) {
  EXPECT_FALSE(is_ambiguous(5, kNoCost, 10));
  EXPECT_FALSE(is_ambiguous(5, kNoCost, 100));
}
TEST(Uniqueness, LeavesPixelsWithoutMatchAlone) {
  EXPECT_FALSE(is_ambiguous(kNoCost, kNoCost, 10));
}

TEST(Uniqueness, MinusOneSwitchesItOffAndNeedsNoEvidence) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 1}});
  EXPECT_EQ(numbers(reject_ambiguous(matches, {-1.0F}, {})),
            (std::vector<std::vector<std::int64_t>>{{0, 0}}));
}

// ---- flatness ----

Image<Reject> flat_slowly(const Matches& matches, const FlatnessConfig& config) {
  return verdicts(matches.best.size(), [&](int x, int y) {
    if (config.threshold < 0 || matches.best(x, y) == kNoMatch) return Reject::none;
    const float mean = matches.mean_cost(x, y);
    if (mean == 0) return Reject::flat;
    return (mean - matches.cost(x, y)) / mean < config.threshold ? Reject::flat : Reject::none;
  });
}

TEST(Flatness, EqualsItsTwin) {
  expect_equal<FlatnessConfig>(reject_flat, flat_slowly, {{-1}, {0}, {0.1F}, {0.5F}, {1}});
}

bool is_flat(float cost, float mean, float threshold) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0}});
  matches.cost = grid<float, float>({{cost}});
  matches.mean_cost = grid<float, float>({{mean}});
  return reject_flat(matches, {threshold}, {})(0, 0) == Reject::flat;
}

TEST(Flatness, RejectsABestCostThatBarelyDipsBelowTheMean) {
  EXPECT_TRUE(is_flat(95, 100, 0.1F));
  EXPECT_FALSE(is_flat(50, 100, 0.1F));
}
TEST(Flatness, ADipOfExactlyTheThresholdIsDeepEnough) {
  EXPECT_FALSE(is_flat(50, 100, 0.5F));
}
TEST(Flatness, AllCandidatesPerfectIsFlat) {
  EXPECT_TRUE(is_flat(0, 0, 0.1F));
}
TEST(Flatness, LeavesPixelsWithoutMatchAlone) {
  EXPECT_FALSE(is_flat(kNoCost, kNoCost, 0.1F));
}

TEST(Flatness, MinusOneSwitchesItOffAndNeedsNoEvidence) {
  Matches matches;
  matches.best = grid<std::int16_t>({{0, 1}});
  EXPECT_EQ(numbers(reject_flat(matches, {-1.0F}, {})), (std::vector<std::vector<std::int64_t>>{{0, 0}}));
}

}  // namespace
}  // namespace cairn
