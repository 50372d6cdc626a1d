// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/target.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cairn/stereo/semi_global_kernels.hpp>
#include <vector>

#include "reference/semi_global.hpp"
#include "support/first_difference.hpp"
#include "support/random_pair.hpp"

namespace {

using namespace cairn;

MatchConfig search(int first, int count, MatchMaps maps = MatchMaps::full) {
  return {.method = MatchMethod::semi_global, .min_disparity = first, .num_disparities = count, .maps = maps};
}

void expect_equal_to_reference(Size size, const MatchConfig& config, const SemiGlobalConfig& penalties = {},
                               const std::vector<int>& thread_counts = {1}) {
  const RandomPair images(size, static_cast<unsigned>(size.width * 31 + config.num_disparities));
  const Matches expected = reference::match_semi_global(images.pair(), config, penalties);
  for (const Target target : supported_targets()) {
    for (const int threads : thread_counts) {
      const Matches got =
          match_semi_global(images.pair(), config, penalties, Exec::with_threads(threads, target));
      EXPECT_EQ(first_difference(expected, got), "")
          << text(size) << " disparities " << config.min_disparity << "+" << config.num_disparities
          << " penalties " << penalties.penalty_small << ", " << penalties.penalty_large << ", "
          << penalties.penalty_edge << " on " << name(target) << ", " << threads << " threads";
    }
  }
}

TEST(SemiGlobalEquivalence, HoldsForEveryWidth) {
  for (int width = 1; width <= 70; ++width) expect_equal_to_reference({width, 5}, search(0, 9));
}

TEST(SemiGlobalEquivalence, HoldsForEveryHeight) {
  for (int height = 1; height <= 20; ++height) expect_equal_to_reference({23, height}, search(0, 7));
}

TEST(SemiGlobalEquivalence, HoldsForEveryCountOfCandidates) {
  for (int count = 1; count <= 68; ++count) expect_equal_to_reference({75, 4}, search(0, count));
  for (const int count : {96, 127, 128, 129, 191, 257}) expect_equal_to_reference({260, 3}, search(0, count));
  expect_equal_to_reference({40, 2}, search(-500, 1024));
}

TEST(SemiGlobalEquivalence, HoldsForNegativeAndDistantDisparities) {
  for (const int first : {-1024, -60, -40, -33, -17, -9, -1, 1, 5, 20, 39, 1000}) {
    expect_equal_to_reference({40, 5}, search(first, 18));
    expect_equal_to_reference({70, 3}, search(first, 66));
  }
}

TEST(SemiGlobalEquivalence, HoldsForEverySplitIntoThreads) {
  for (const Size size : {Size{33, 41}, Size{97, 50}, Size{200, 3}, Size{2, 120}}) {
    expect_equal_to_reference(size, search(-2, 11), {}, {1, 2, 3});
  }
}

TEST(SemiGlobalEquivalence, HoldsIfTheImagesAreSplitIntoChunksOfRows) {
  // Wide and deep enough for blocks of only a few rows.
  expect_equal_to_reference({400, 7}, search(0, 200), {}, {1, 3});
}

TEST(SemiGlobalEquivalence, HoldsForEverySplitIntoBands) {
  const Size size{37, 23};
  const RandomPair images(size, 5);
  for (const int count : {9, 70}) {
    const Matches expected = reference::match_semi_global(images.pair(), search(-2, count), {});
    for (const Target target : supported_targets()) {
      for (const int threads : {1, 3}) {
        const Exec exec = Exec::with_threads(threads, target);
        for (int rows = 1; rows <= size.height + 1; ++rows) {
          EXPECT_EQ(first_difference(
                        expected, kernels::match_in_bands(images.pair(), search(-2, count), {}, rows, exec)),
                    "")
              << rows << " rows, " << count << " candidates on " << name(target) << ", " << threads
              << " threads";
        }
      }
    }
  }
}

TEST(SemiGlobalEquivalence, HoldsForEveryPenalty) {
  for (const float small : {0.0F, 0.01F, 0.42F, 1.0F, 2.3F}) {
    for (const float large : {0.0F, 0.6F, 1.7F, 2.3F}) {
      for (const float edge : {0.0F, 0.15F, 10.0F}) {
        expect_equal_to_reference({45, 7}, search(0, 20), {small, large, edge});
      }
    }
  }
}

TEST(SemiGlobalEquivalence, HoldsForTheWinnerOnly) {
  expect_equal_to_reference({41, 8}, search(0, 19, MatchMaps::winner));
  expect_equal_to_reference({70, 8}, search(0, 64, MatchMaps::winner));
  expect_equal_to_reference({41, 8}, search(-3, 19, MatchMaps::minimum));
}

}  // namespace
