// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/objects/ranks.hpp>
#include <limits>
#include <random>
#include <vector>

namespace cairn {
namespace {

void expect_sorted_order(const std::vector<float>& values) {
  std::vector<float> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t last = values.size() - 1;
  for (const auto& [low, high] : {std::pair{std::size_t{0}, last},
                                  {last / 2, (last + 1) / 2},
                                  {last / 50, last - last / 50},
                                  {last, last}}) {
    for (const Target target : supported_targets()) {
      std::vector<float> given = values;
      const auto [lower, higher] = values_at_ranks(given, low, high, Exec::with_threads(1, target));
      EXPECT_EQ(lower, sorted[low]) << "rank " << low << " of " << values.size();
      EXPECT_EQ(higher, sorted[high]) << "rank " << high << " of " << values.size();
    }
  }
}

std::vector<float> drawn(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random() % 100000) * 0.01F - 300;
  return values;
}

TEST(Ranks, AreThoseOfTheSortedValues) {
  for (const std::size_t count : {1U, 2U, 3U, 256U, 257U, 258U, 1000U, 20001U}) {
    expect_sorted_order(drawn(count, static_cast<std::uint32_t>(count)));
  }
}

TEST(Ranks, AreCorrectIfMostValuesAreEqual) {
  std::vector<float> values(1000, 7.0F);
  expect_sorted_order(values);
  values[3] = -2;
  values[700] = 1e6F;
  expect_sorted_order(values);
}

TEST(Ranks, AreCorrectWithExtremeValues) {
  std::vector<float> values = drawn(1000, 1);
  values[10] = std::numeric_limits<float>::max();
  values[20] = std::numeric_limits<float>::lowest();
  expect_sorted_order(values);
  values[30] = std::numeric_limits<float>::infinity();
  expect_sorted_order(values);
}

}  // namespace
}  // namespace cairn
