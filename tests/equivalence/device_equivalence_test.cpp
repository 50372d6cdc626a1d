// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The kernels of devices against the slow twin, on the first Vulkan device; Mesa's software device is enough.
#include <gtest/gtest.h>

#include <array>
#include <cairn/core/random.hpp>
#include <cairn/device/vulkan/vulkan_engine.hpp>
#include <span>
#include <string>
#include <vector>

#include "reference/semi_global.hpp"
#include "support/first_difference.hpp"
#include "support/random_pair.hpp"

namespace {

using namespace cairn;
using device::Engine;
using device::Tuning;

std::vector<device::Listed> all_devices() {
  try {
    return device::vulkan_devices(device::vulkan_library());
  } catch (const device::Unfit&) {
    return {};
  }
}

class DeviceEquivalence : public testing::Test {
 protected:
  void SetUp() override {
    if (all_devices().empty())
      GTEST_SKIP() << "no Vulkan device (package mesa-vulkan-drivers has one in software)";
  }

  static void expect_equal(Engine& engine, const RandomPair& images, const MatchConfig& config,
                           const SemiGlobalConfig& penalties) {
    engine.submit(images.pair(), config, penalties);
    const Matches expected = reference::match_semi_global(images.pair(), config, penalties);
    EXPECT_EQ(first_difference(expected, engine.finish({})), "")
        << engine.full_name() << ": " << text(images.size) << " disparities " << config.min_disparity << "+"
        << config.num_disparities << " penalties " << penalties.penalty_small << ", "
        << penalties.penalty_large << ", " << penalties.penalty_edge;
  }
  static std::unique_ptr<Engine> engine(Tuning tuning = {}) {
    return device::vulkan_engine(device::vulkan_library(), 0, tuning);
  }
  static MatchConfig search(int first, int count, MatchMaps maps = MatchMaps::full) {
    return {
        .method = MatchMethod::semi_global, .min_disparity = first, .num_disparities = count, .maps = maps};
  }
  /// Kernels are compiled for each way to share out candidates, which takes a software device longer than to run them;
  /// so there are few counts.
  static void expect_equal_at_random(Tuning tuning, int pairs, std::span<const int> counts) {
    Random random;
    const auto one_of = [&](const auto& choices) { return choices[random.below(std::size(choices))]; };
    const auto one = engine(tuning);
    for (int k = 0; k < pairs; ++k) {
      const Size size{static_cast<int>(3 + random.below(60)), static_cast<int>(3 + random.below(30))};
      const int first = static_cast<int>(random.below(60)) - 30;
      const SemiGlobalConfig penalties{one_of(std::array{0.0F, 0.3F, 0.6F, 2.3F}),
                                       one_of(std::array{0.0F, 1.1F, 2.2F, 2.3F}),
                                       one_of(std::array{0.0F, 0.15F, 10.0F})};
      expect_equal(*one, RandomPair(size, static_cast<unsigned>(k)), search(first, one_of(counts)),
                   penalties);
    }
  }
};

TEST_F(DeviceEquivalence, HoldsForRandomPairsRangesAndPenaltiesInBothWaysToTalk) {
  constexpr std::array kCounts{7, 30, 41, 64, 100};
  const std::uint32_t subgroup = all_devices().front().subgroup;
  for (const bool shuffles : {true, false}) {
    EXPECT_EQ(engine({.shuffles = shuffles})->variant(30).find("shuffles") != std::string::npos,
              shuffles && subgroup >= 4);
    expect_equal_at_random({.shuffles = shuffles}, 75, kCounts);
  }
}

TEST_F(DeviceEquivalence, HoldsForEverySizeOfGroups) {
  constexpr std::array kCounts{30};
  for (const std::uint32_t group : {32U, 128U, 256U}) {
    for (const bool shuffles : {true, false}) expect_equal_at_random({group, shuffles}, 5, kCounts);
  }
}

TEST_F(DeviceEquivalence, HoldsForTheSmallestImagesAndEveryCountOfCandidates) {
  const auto one = engine();
  for (const Size size : {Size{1, 1}, Size{1, 7}, Size{7, 1}, Size{2, 2}, Size{65, 2}})
    expect_equal(*one, RandomPair(size, 3), search(-1, 5), {});
  for (const int count : {1, 2, 3, 4, 5, 8, 9, 12, 13, 16, 24, 32, 33, 48, 49, 64, 65, 128, 200})
    expect_equal(*one, RandomPair({40, 3}, 4), search(0, count), {});
}

TEST_F(DeviceEquivalence, HoldsForDistantAndNegativeDisparities) {
  const auto one = engine();
  for (const int first : {-1024, -70, -40, -9, 1, 20, 39, 1000})
    expect_equal(*one, RandomPair({40, 5}, 5), search(first, 18), {});
  expect_equal(*one, RandomPair({30, 2}, 6), search(-500, 1024), {});
}

TEST_F(DeviceEquivalence, HoldsForFewerMaps) {
  const auto one = engine();
  for (const MatchMaps maps : {MatchMaps::winner, MatchMaps::minimum})
    expect_equal(*one, RandomPair({41, 8}, 7), search(0, 19, maps), {});
}

TEST_F(DeviceEquivalence, KeepsNothingOfThePairBefore) {
  const auto one = engine();
  for (const unsigned seed : {1U, 2U, 1U}) expect_equal(*one, RandomPair({50, 20}, seed), search(-3, 30), {});
  expect_equal(*one, RandomPair({50, 20}, 1), search(-3, 30), {0.1F, 0.2F, 0.0F});
  expect_equal(*one, RandomPair({20, 50}, 1), search(-3, 30), {});
}

TEST_F(DeviceEquivalence, EveryThreadCountUnpacksTheSame) {
  const RandomPair images({60, 70}, 8);
  const auto one = engine();
  const Matches expected = reference::match_semi_global(images.pair(), search(0, 20), {});
  for (const int threads : {1, 2, 3}) {
    one->submit(images.pair(), search(0, 20), {});
    EXPECT_EQ(first_difference(expected, one->finish(Exec::with_threads(threads))), "") << threads;
  }
}

TEST_F(DeviceEquivalence, HoldsForMorePixelsThanGroupsThatADeviceMayHave) {
  const RandomPair images({2200, 960}, 9);  // of 32 pixels each: 66,000
  const auto one = engine({.group = 32, .shuffles = false});
  one->submit(images.pair(), search(0, 2), {});
  EXPECT_EQ(first_difference(match_semi_global(images.pair(), search(0, 2), {}, {}), one->finish({})), "");
}

TEST_F(DeviceEquivalence, TooManyCandidatesAreLeftToTheProcessor) {
  const auto narrow = engine({.group = 32, .shuffles = false});
  EXPECT_THROW(narrow->submit(RandomPair({9, 9}, 1).pair(), search(0, 1024), {}), device::Unfit);
  expect_equal(*narrow, RandomPair({9, 9}, 1), search(0, 24), {});
}

}  // namespace
