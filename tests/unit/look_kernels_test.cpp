// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/objects/look_kernels.hpp>
#include <cmath>
#include <random>
#include <vector>

namespace cairn {
namespace {

std::vector<double> exponents() {
  std::vector<double> values{0, -1e-300, -1e-9, -0.25, -0.34657359, -0.34657360, -1, -13.5, -226, -699.9};
  std::mt19937 random(5);
  while (values.size() < 1003) values.push_back(-static_cast<double>(random() % 7000000) * 1e-4);
  return values;
}

TEST(LookKernels, ExponentialsAreThoseOfTheLibraryButForTheLastBits) {
  const std::vector<double> given = exponents();
  std::vector<double> values = given;
  kernels::look_kernels(Target::scalar)->exponentials(values.data(), static_cast<int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(values[i] / std::exp(given[i]), 1, 4e-16) << given[i];
  }
  EXPECT_EQ(values[0], 1);
}

TEST(LookKernels, ExponentialsAreTheSameBitsOnAllTargets) {
  std::vector<double> expected = exponents();
  kernels::look_kernels(Target::scalar)->exponentials(expected.data(), static_cast<int>(expected.size()));
  for (const Target target : supported_targets()) {
    std::vector<double> values = exponents();
    kernels::look_kernels(target)->exponentials(values.data(), static_cast<int>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(values[i]), std::bit_cast<std::uint64_t>(expected[i]))
          << name(target);
    }
  }
}

/// Facets at random places in random colours.
struct Facets {
  std::array<std::vector<std::int32_t>, 4> sides;
  std::array<std::vector<float>, 3> channels;

  explicit Facets(std::size_t count) {
    std::mt19937 random(6);
    for (auto& side : sides) side.resize(count + kernels::kLookSlack);
    for (auto& channel : channels) channel.resize(count + kernels::kLookSlack);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t axis = 0; axis < 4; axis += 2) {
        sides[axis][i] = static_cast<std::int32_t>(random() % 100);
        sides[axis + 1][i] = sides[axis][i] + 1 + static_cast<std::int32_t>(random() % 20);
      }
      for (auto& channel : channels) channel[i] = static_cast<float>(random() % 256);
    }
  }
  [[nodiscard]] kernels::LookArrays arrays() const {
    return {sides[0].data(),    sides[1].data(),    sides[2].data(),   sides[3].data(),
            channels[0].data(), channels[1].data(), channels[2].data()};
  }
  [[nodiscard]] bool within(std::size_t i, const kernels::LookWindow& w) const {
    const float dr = channels[0][i] - w.red;
    const float dg = channels[1][i] - w.green;
    const float db = channels[2][i] - w.blue;
    return dr * dr + dg * dg + db * db <= w.most_squares && sides[1][i] >= w.left && sides[0][i] <= w.right &&
           sides[3][i] >= w.top && sides[2][i] <= w.bottom;
  }
};

TEST(LookKernels, FindThoseWithinTheWindowOnAllTargets) {
  constexpr int kCount = 500;
  const Facets facets(kCount);
  const kernels::LookWindow window{20, 70, 10, 60, 128, 100, 90, 10000};
  for (const auto& [first, last] : {std::pair{0, kCount}, {3, 3}, {7, 8}, {100, 229}, {436, kCount}}) {
    std::vector<std::int32_t> expected;
    for (int i = first; i < last; ++i) {
      if (facets.within(static_cast<std::size_t>(i), window)) expected.push_back(i);
    }
    for (const Target target : supported_targets()) {
      std::vector<std::int32_t> found(kCount + kernels::kLookSlack);
      found.resize(static_cast<std::size_t>(
          kernels::look_kernels(target)->within(facets.arrays(), window, first, last, found.data())));
      EXPECT_EQ(found, expected) << name(target) << " from " << first << " to " << last;
    }
  }
}

TEST(LookKernels, WeighPixelsByTheLikenessOfTheirColourTheSameOnAllTargets) {
  std::mt19937 random(7);
  for (const int count : {0, 1, 7, 8, 9, 100}) {
    std::array<std::vector<double>, 5> lists;
    for (auto& list : lists) {
      while (list.size() < static_cast<std::size_t>(count))
        list.push_back(static_cast<double>(random() % 256));
    }
    const kernels::ColourCells cells{lists[0].data(), lists[1].data(), lists[2].data(),
                                     lists[3].data(), lists[4].data(), count};
    const std::array<double, 3> colour{100, 120, 140};
    double ground = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      double squares = 0;
      for (std::size_t c = 0; c < 3; ++c) squares += std::pow(colour[c] - lists[c][i], 2);
      ground += std::exp(-squares / 3 / 288) * lists[3][i];
    }
    std::vector<double> work(static_cast<std::size_t>(count));
    const auto weighed = [&](Target target) {
      return kernels::look_kernels(target)->pixels_like(cells, colour.data(), 288, work.data());
    };
    EXPECT_NEAR(weighed(Target::scalar).ground, ground, 1e-9 * ground) << count;
    for (const Target target : supported_targets()) {
      EXPECT_EQ(weighed(target).ground, weighed(Target::scalar).ground) << name(target) << ' ' << count;
      EXPECT_EQ(weighed(target).figure, weighed(Target::scalar).figure) << name(target) << ' ' << count;
    }
  }
}

}  // namespace
}  // namespace cairn
