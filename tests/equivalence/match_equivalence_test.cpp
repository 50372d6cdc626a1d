// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/target.hpp>
#include <cairn/image/prefilter.hpp>
#include <cairn/stereo/match.hpp>
#include <cairn/stereo/subpixel.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "reference/match.hpp"
#include "support/first_difference.hpp"
#include "support/random_pair.hpp"

namespace {

using namespace cairn;

std::string description(Size size, const MatchConfig& c, Target target, int threads) {
  return text(size) + " " + std::string(kCosts[static_cast<std::size_t>(c.cost)].name) + " window " +
         std::to_string(c.window_size) + " disparities " + std::to_string(c.min_disparity) + "+" +
         std::to_string(c.num_disparities) + " band " + std::to_string(c.row_band) + " prefilter " +
         std::to_string(static_cast<int>(c.prefilter)) + " on " + std::string(name(target)) + ", " +
         std::to_string(threads) + " threads";
}

void expect_equal_to_reference(const StereoPair& pair, const MatchConfig& config,
                               const std::vector<int>& thread_counts = {1}) {
  const Matches expected = reference::match(pair, config);
  for (const Target target : supported_targets()) {
    for (const int threads : thread_counts) {
      const Matches got = match_windows(pair, config, Exec::with_threads(threads, target));
      EXPECT_EQ(first_difference(expected, got), "") << description(pair.size(), config, target, threads);
    }
  }
}

void expect_equal_to_reference(Size size, const MatchConfig& config,
                               const std::vector<int>& thread_counts = {1}) {
  const RandomPair images(size, static_cast<unsigned>(size.width * 31 + config.window_size));
  expect_equal_to_reference(images.pair(), config, thread_counts);
}

class MatchEquivalence : public testing::TestWithParam<Cost> {
 protected:
  [[nodiscard]] static MatchConfig config(int window, int first, int count) {
    return {.cost = GetParam(), .window_size = window, .min_disparity = first, .num_disparities = count};
  }
};

TEST_P(MatchEquivalence, HoldsForEveryWidth) {
  for (int width = 1; width <= 36; ++width) expect_equal_to_reference({width, 7}, config(5, 0, 9));
}

TEST_P(MatchEquivalence, HoldsForEveryHeight) {
  for (int height = 1; height <= 12; ++height) expect_equal_to_reference({21, height}, config(5, 0, 6));
}

TEST_P(MatchEquivalence, HoldsForEveryWindow) {
  for (int window = 3; window <= 31; window += 2) expect_equal_to_reference({44, 12}, config(window, 0, 7));
}

TEST_P(MatchEquivalence, HoldsForEveryCountOfCandidates) {
  for (int count = 1; count <= 36; ++count) expect_equal_to_reference({40, 5}, config(3, 0, count));
  expect_equal_to_reference({150, 4}, config(3, 0, 129));
}

TEST_P(MatchEquivalence, HoldsForNegativeAndDistantDisparities) {
  for (const int first : {-1024, -40, -17, -9, -1, 1, 5, 20, 39, 1000}) {
    expect_equal_to_reference({40, 5}, config(5, first, 18));
  }
}

TEST_P(MatchEquivalence, HoldsForEverySplitIntoThreads) {
  expect_equal_to_reference({33, 41}, config(3, -2, 10), {1, 2, 3});
  auto banded = config(3, -2, 10);
  banded.row_band = 2;
  expect_equal_to_reference({33, 41}, banded, {1, 2, 3});
}

TEST_P(MatchEquivalence, HoldsForEveryRowBand) {
  for (int band = 1; band <= 3; ++band) {
    auto banded = config(5, -1, 11);
    banded.row_band = band;
    expect_equal_to_reference({29, 9}, banded);
    expect_equal_to_reference({19, 2}, banded);
    for (const MatchMaps maps : {MatchMaps::winner, MatchMaps::minimum}) {
      banded.maps = maps;
      expect_equal_to_reference({29, 9}, banded);
    }
  }
}

TEST_P(MatchEquivalence, HoldsForFewerMaps) {
  for (const MatchMaps maps : {MatchMaps::winner, MatchMaps::minimum}) {
    for (const int window : {3, 9, 17, 23}) {
      auto less = config(window, 0, 19);
      less.maps = maps;
      expect_equal_to_reference({41, 8}, less);
    }
    // More candidates than are processed at a time, to the left and to the right.
    for (const int first : {-110, 0}) {
      auto less = config(5, first, 100);
      less.maps = maps;
      expect_equal_to_reference({170, 4}, less);
    }
  }
}

TEST_P(MatchEquivalence, HoldsForPrefilteredImages) {
  for (const int cap : {1, 31, 63}) {
    for (const int window : {5, 21, 23}) {
      auto filtered = config(window, 0, 17);
      filtered.prefilter = Prefilter::xsobel;
      filtered.prefilter_cap = cap;
      expect_equal_to_reference({38, 7}, filtered);
    }
  }
}

TEST_P(MatchEquivalence, HoldsForRowsOfSeveralBlocksAndSeveralTilesOfCandidates) {
  for (const int width : {63, 64, 65, 96, 130}) expect_equal_to_reference({width, 3}, config(3, 0, 70));
  for (const int count : {32, 33, 64, 65, 96, 97, 129}) {
    auto filtered = config(9, -5, count);
    filtered.prefilter = Prefilter::xsobel;
    expect_equal_to_reference({140, 4}, filtered);
    filtered.row_band = 1;
    expect_equal_to_reference({75, 3}, filtered);
  }
}

TEST_P(MatchEquivalence, HoldsForTheLargestSumsThatAWindowCanHave) {
  // Equal parts of black and white, similar and dissimilar, and all white against all black.
  const Size size{40, 36};
  Image<Gray> halves(size);
  Image<Gray> inverted(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      halves(x, y) = x < size.width / 2 ? 0 : 255;
      inverted(x, y) = static_cast<Gray>(255 - halves(x, y));
    }
  }
  const Image<Gray> white(size, Gray{255}, Pool{});
  const Image<Gray> black(size, Gray{0}, Pool{});
  for (const int window : {13, 15, 17, 19, 21, 31}) {
    expect_equal_to_reference(StereoPair::from(halves, halves), config(window, 0, 2));
    expect_equal_to_reference(StereoPair::from(halves, inverted), config(window, 0, 2));
    expect_equal_to_reference(StereoPair::from(white, black), config(window, 0, 2));
  }
}

TEST_P(MatchEquivalence, HoldsWhereSeveralCandidatesMatchPerfectly) {
  // A periodic pattern, in the right image alternately unchanged and twice as bright: zncc of such windows is
  // 0 up to rounding, on either side.
  constexpr int kPeriod = 16;
  const Size size{170, 17};
  Image<Gray> pattern(size);
  Image<Gray> alternating(size);
  std::mt19937 random(3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      pattern(x, y) = x < kPeriod ? static_cast<Gray>(random() % 128) : pattern(x - kPeriod, y);
      alternating(x, y) = static_cast<Gray>(pattern(x, y) * (1 + x / kPeriod % 2));
    }
  }
  for (const int window : {3, 9, 13}) {
    auto repeating = config(window, -20, 100);
    expect_equal_to_reference(StereoPair::from(pattern, alternating), repeating);
    repeating.maps = MatchMaps::winner;
    expect_equal_to_reference(StereoPair::from(pattern, alternating), repeating);
  }
}

TEST_P(MatchEquivalence, HoldsForTheLargestSumsOfPrefilteredImages) {
  // Maximal slopes everywhere, upward where those of the other image go downward.
  const Size size{44, 30};
  Image<Gray> steps(size);
  Image<Gray> inverted(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      steps(x, y) = x % 4 < 2 ? 0 : 255;
      inverted(x, y) = static_cast<Gray>(255 - steps(x, y));
    }
  }
  // Just below and above sums that fit 13 and 16 bits.
  for (const auto& [window, cap] :
       {std::pair{7, 63}, std::pair{9, 50}, std::pair{9, 51}, std::pair{15, 18}, std::pair{15, 19},
        std::pair{21, 63}, std::pair{23, 61}, std::pair{23, 62}}) {
    auto filtered = config(window, 0, 5);
    filtered.prefilter = Prefilter::xsobel;
    filtered.prefilter_cap = cap;
    expect_equal_to_reference(StereoPair::from(steps, inverted), filtered);
  }
}

std::vector<Cost> all_costs() {
  std::vector<Cost> all;
  for (const auto& [cost_name, cost] : kCosts) all.push_back(cost);
  return all;
}

INSTANTIATE_TEST_SUITE_P(AllCosts, MatchEquivalence, testing::ValuesIn(all_costs()), [](const auto& cost) {
  return std::string(kCosts[static_cast<std::size_t>(cost.param)].name);
});

TEST(PrefilterEquivalence, SobelAndMeanRemovalMeetTheirDefinitions) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 5}, Size{3, 2}, Size{37, 41}}) {
    const RandomPair images(size, 5);
    const View<const Gray> image = images.pair().left();
    for (const Target target : supported_targets()) {
      const Exec exec = Exec::with_threads(target == Target::scalar ? 3 : 1, target);
      EXPECT_EQ(first_difference(reference::filter_xsobel(image, 31), filter_xsobel(image, 31, exec)), "");
      for (const int window : {3, 9, 31}) {
        EXPECT_EQ(first_difference(reference::remove_mean(image, window), remove_mean(image, window, exec)),
                  "");
      }
    }
  }
}

TEST(SubpixelEquivalence, RefinementMeetsItsDefinition) {
  for (const Size size : {Size{1, 1}, Size{5, 3}, Size{70, 9}}) {
    const RandomPair images(size, 7);
    for (const MatchMaps maps : {MatchMaps::winner, MatchMaps::full}) {
      const Matches matches = match_windows(
          images.pair(),
          {.cost = Cost::sad, .window_size = 3, .min_disparity = 2, .num_disparities = 9, .maps = maps}, {});
      for (const auto& [method_name, method] : kSubpixelMethods) {
        const SubpixelConfig config{method};
        for (const Target target : supported_targets()) {
          const Exec exec = Exec::with_threads(1, target);
          EXPECT_EQ(first_difference(reference::refine_subpixel(matches, config),
                                     refine_subpixel(matches, config, exec)),
                    "")
              << text(size) << " " << method_name << " on " << name(target);
        }
      }
    }
  }
}

}  // namespace
