// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/target.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace cairn {
namespace {

constexpr int kWidth = 203;  // ends within a vector of any target

std::vector<const kernels::LabelKernels*> all_kernels() {
  std::vector<const kernels::LabelKernels*> all;
  for (const Target target : supported_targets()) all.push_back(kernels::label_kernels(target));
  return all;
}

std::vector<float> floats_with_holes() {
  std::mt19937 random(3);
  std::vector<float> row(kWidth);
  for (float& value : row) {
    const auto drawn = static_cast<float>(random() % 5000) * 0.01F - 20;
    value = random() % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : drawn;
  }
  return row;
}

std::vector<float> known_of(const std::vector<float>& row, int first, int last) {
  std::vector<float> known;
  for (int x = first; x < last; ++x) {
    if (row[slot(x)] == row[slot(x)]) known.push_back(row[slot(x)]);
  }
  return known;
}

TEST(LabelKernels, SumColoursUpToEachPixel) {
  std::mt19937 random(1);
  std::vector<Rgb> row(kWidth);
  const auto drawn = [&] { return static_cast<std::uint8_t>(random() % 256); };
  for (Rgb& colour : row) colour = {drawn(), drawn(), drawn()};
  for (const kernels::LabelKernels* const run : all_kernels()) {
    std::vector<std::uint64_t> up_to(kWidth + 1, 7);
    run->sum_colours(row.data(), kWidth, up_to.data());
    std::uint64_t expected = 0;
    for (std::size_t x = 0; x < row.size(); ++x) {
      ASSERT_EQ(up_to[x], expected) << x;
      expected += row[x].r + (std::uint64_t{row[x].g} << 21U) + (std::uint64_t{row[x].b} << 42U);
    }
    EXPECT_EQ(up_to.back(), expected);
  }
}

TEST(LabelKernels, KeepThePrefixSumsOfAnyPartOfARow) {
  const std::vector<float> row = floats_with_holes();
  std::vector<float> other(row.size());
  std::iota(other.begin(), other.end(), 0.0F);
  for (const kernels::LabelKernels* const run : all_kernels()) {
    for (const int first : {0, 1, 5, 100, 190}) {
      for (int last = first; last <= kWidth; ++last) {
        std::vector<float> kept(slot(last - first) + kernels::kListSlack);
        kept.resize(slot(run->keep_known(row.data(), row.data(), first, last, kept.data())));
        ASSERT_EQ(kept, known_of(row, first, last)) << first << " to " << last;
        kept.resize(slot(last - first) + kernels::kListSlack);
        kept.resize(slot(run->keep_known(other.data(), row.data(), first, last, kept.data())));
        ASSERT_EQ(kept.size(), known_of(row, first, last).size());
        for (const float at : kept) ASSERT_FALSE(std::isnan(row[static_cast<std::size_t>(at)]));
      }
    }
  }
}

TEST(LabelKernels, FindTheRangeAndTheBucketsOfAnyNumberOfValues) {
  const std::vector<float> all = known_of(floats_with_holes(), 0, kWidth);
  for (const kernels::LabelKernels* const run : all_kernels()) {
    for (std::size_t count = 1; count <= all.size(); ++count) {
      const std::vector<float> values(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
      const auto [least, most] = run->find_range(values.data(), count);
      ASSERT_EQ(least, *std::min_element(values.begin(), values.end()));
      ASSERT_EQ(most, *std::max_element(values.begin(), values.end()));

      const kernels::Buckets buckets{least, 0.3F, 9};
      std::vector<std::int32_t> numbers(count);
      run->number_buckets(values.data(), count, buckets, numbers.data());
      std::vector<float> of_third;
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(numbers[i], buckets.bucket(values[i]));
        if (numbers[i] == 3) of_third.push_back(values[i]);
      }
      std::vector<float> kept(count + kernels::kListSlack);
      kept.resize(run->keep_bucket(values.data(), count, buckets, 3, kept.data()));
      ASSERT_EQ(kept, of_third);
    }
  }
}

}  // namespace
}  // namespace cairn
