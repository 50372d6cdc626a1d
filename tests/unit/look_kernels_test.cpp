// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/grouping/facets.hpp>
#include <cairn/grouping/look_kernels.hpp>
#include <cairn/scene/background.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/grids.hpp"

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
struct Scattered {
  std::array<std::vector<std::int32_t>, 4> sides;
  std::array<std::vector<float>, 3> channels;

  explicit Scattered(std::size_t count) {
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
  const Scattered facets(kCount);
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

TEST(LookKernels, WeighPixelsRoughlyWithinTheirRoughness) {
  std::mt19937 random(8);
  for (const int count : {0, 1, 31, 32, 33, 100}) {
    std::array<std::vector<double>, 5> lists;
    for (auto& list : lists) {
      while (list.size() < static_cast<std::size_t>(count))
        list.push_back(static_cast<double>(random() % 25500) / 100);
      list.resize(list.size() + kernels::kCellSlack);
    }
    const kernels::ColourCells cells{lists[0].data(), lists[1].data(), lists[2].data(),
                                     lists[3].data(), lists[4].data(), count};
    std::vector<double> work(static_cast<std::size_t>(count));
    for (const std::array<double, 3> colour : {std::array{0.0, 0.0, 255.0}, {100.0, 120.0, 140.5}}) {
      const kernels::NearPixels exact =
          kernels::look_kernels(Target::scalar)->pixels_like(cells, colour.data(), 288, work.data());
      for (const Target target : supported_targets()) {
        const kernels::NearPixels rough =
            kernels::look_kernels(target)->pixels_roughly_like(cells, colour.data(), 288);
        EXPECT_NEAR(rough.ground, exact.ground, kernels::kRoughness * exact.ground)
            << name(target) << ' ' << count;
        EXPECT_NEAR(rough.figure, exact.figure, kernels::kRoughness * exact.figure)
            << name(target) << ' ' << count;
      }
    }
  }
}

TEST(LookKernels, FindTheBackgroundThatLiesBehindOnAllTargets) {
  const Background background{{{0.013F, 0.21F, -30}, {-0.05F, 0, 9}, {0.001F, 0.3F, -60}}, true};
  for (const Target target : supported_targets()) {
    for (const int width : {1, 7, 64, 131}) {
      for (const int y : {0, 77, 300}) {
        std::vector<float> behind(static_cast<std::size_t>(width));
        kernels::look_kernels(target)->find_behind(background.planes.data(), 3, y, width, behind.data());
        for (int x = 0; x < width; ++x) {
          EXPECT_EQ(behind[static_cast<std::size_t>(x)],
                    background.disparity_px(static_cast<float>(x), static_cast<float>(y)))
              << name(target) << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(LookKernels, MarkWhatLiesBesideABorderOnAllTargets) {
  for (const Target target : supported_targets()) {
    for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 3}, Size{3, 2}, Size{67, 9}, Size{130, 5}}) {
      const auto labels = grids::random_image<RegionId>(size, 0, 3, 4);
      const Image<RegionId> plain(size, RegionId{5}, {});
      for (const Image<RegionId>* image : {&labels, &plain}) {
        for (int y = 0; y < size.height; ++y) {
          std::vector<std::uint8_t> marks(static_cast<std::size_t>(size.width));
          kernels::look_kernels(target)->mark_borders(image->row(std::max(y - 1, 0)), image->row(y),
                                                      image->row(std::min(y + 1, size.height - 1)),
                                                      size.width, marks.data());
          for (int x = 0; x < size.width; ++x) {
            EXPECT_EQ(marks[static_cast<std::size_t>(x)] != 0, beside_border(*image, x, y))
                << name(target) << ' ' << text(size) << ' ' << x << ' ' << y;
          }
        }
      }
    }
  }
}

TEST(LookKernels, JudgeWhatIsTakenOfAPixelOnAllTargets) {
  using kernels::Taken;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Reject> reject{Reject::none, Reject::none, Reject::none, Reject::none,
                                   Reject::flat, Reject::none, Reject::none};
  const std::vector<float> disparity_px{8, 8, 8, 8, kNaN, 5, 5.5F};
  const std::vector<float> evidence_px{kNaN, 8, kNaN, 8, kNaN, 5, 8};
  const std::vector<float> behind_px(7, 5);
  const std::vector<std::uint8_t> at_border{1, 1, 0, 0, 0, 0, 0};
  for (const Target target : supported_targets()) {
    std::vector<Taken> taken(7);
    std::vector<std::uint8_t> before(7);
    kernels::look_kernels(target)->judge(
        {reject.data(), disparity_px.data(), evidence_px.data(), behind_px.data(), at_border.data()}, 7, 0.5F,
        2, taken.data(), before.data());
    EXPECT_EQ(taken,
              (std::vector<Taken>{Taken::border, Taken::border_evidence, Taken::inner, Taken::inner_evidence,
                                  Taken::nothing, Taken::nothing, Taken::nothing}))
        << name(target);
    EXPECT_EQ(before, (std::vector<std::uint8_t>{0, 1, 0, 1, 0, 0, 1})) << name(target);
  }
}

}  // namespace
}  // namespace cairn
