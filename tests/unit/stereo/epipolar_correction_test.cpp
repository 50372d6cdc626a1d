// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/cairn.hpp>
#include <cmath>
#include <optional>

#include "support/first_difference.hpp"
#include "support/noise.hpp"
#include "support/synthetic_scene.hpp"

namespace {

using namespace cairn;

constexpr Size kSize{240, 160};
constexpr float kDisparity = 12;

/// A pattern of waves in all directions, defined at subpixel positions.
class Waves {
 public:
  explicit Waves(std::uint32_t seed) {
    support::Noise noise(seed);
    for (Wave& w : waves_) {
      const double frequency = 0.3 + 0.6 * noise.uniform();
      const double direction = 6.283 * noise.uniform();
      w = {frequency * std::cos(direction), frequency * std::sin(direction), 6.283 * noise.uniform()};
    }
  }
  double operator()(double x, double y) const {
    double sum = 128;
    for (const Wave& w : waves_) sum += 12 * std::sin(w.x * x + w.y * y + w.phase);
    return sum;
  }

 private:
  struct Wave {
    double x = 0;
    double y = 0;
    double phase = 0;
  };
  std::array<Wave, 24> waves_{};
};

struct Pair {
  Image<Gray> left;
  Image<Gray> right;
  [[nodiscard]] StereoPair get() const { return StereoPair::from(left, right); }
};

/// A wall whose right image is lower by `rows` + `rows_per_px`·(columns from the centre), darker, and noisy
/// like the left one.
Pair wall(double rows, double rows_per_px = 0, Size size = kSize, double noise = 2) {
  const Waves waves(5);
  const double middle = 0.5 * (size.width - 1);
  return {support::picture(size, noise, 1, [&](int x, int y) { return waves(x, y); }),
          support::picture(size, noise, 2, [&](int x, int y) {
            return 0.9 * waves(x + double{kDisparity}, y - rows - rows_per_px * (x - middle)) - 5;
          })};
}

EpipolarOffset found(const Pair& pair, float max_rows = 4, const Exec& exec = {}) {
  return find_epipolar_offset(pair.get(), {.num_disparities = 32}, {.max_rows = max_rows}, exec);
}

TEST(EpipolarOffset, IsFoundToATenthOfARow) {
  for (const double rows : {-3.6, -2.0, -0.75, -0.5, 0.4, 0.5, 1.0, 1.25, 2.0, 3.8}) {
    const EpipolarOffset offset = found(wall(rows));
    EXPECT_EQ(offset.outcome, EpipolarOutcome::corrected) << rows;
    EXPECT_NEAR(offset.rows, rows, 0.1) << rows;
    EXPECT_EQ(offset.rows_per_px, 0) << rows;
    EXPECT_GE(offset.agreeing, 40) << rows;
  }
}

TEST(EpipolarOffset, KnowsARollFromAnOffset) {
  for (const double roll : {-0.01, 0.004, 0.012}) {
    const EpipolarOffset offset = found(wall(0.7, roll));
    EXPECT_EQ(offset.outcome, EpipolarOutcome::corrected) << roll;
    EXPECT_NEAR(offset.rows, 0.7, 0.1) << roll;
    EXPECT_NEAR(offset.rows_per_px, roll, 0.001) << roll;
  }
}

TEST(EpipolarOffset, OfAnAlignedPairIsAligned) {
  const EpipolarOffset offset = found(wall(0));
  EXPECT_EQ(offset.outcome, EpipolarOutcome::aligned);
  EXPECT_NEAR(offset.rows, 0, 0.05);
}

TEST(EpipolarOffset, IsNotEstimatedIfSwitchedOff) {
  const EpipolarOffset offset = found(wall(1), -1);
  EXPECT_EQ(offset.outcome, EpipolarOutcome::off);
  EXPECT_EQ(offset.points, 0);
}

TEST(EpipolarOffset, NeedsTexture) {
  const Image<Gray> plain(kSize, Gray{90}, Pool{});
  EXPECT_EQ(find_epipolar_offset(StereoPair::from(plain, plain), {}, {.max_rows = 4}, {}).outcome,
            EpipolarOutcome::few_points);
  // Vertical stripes carry no information on rows.
  const auto stripes =
      support::picture(kSize, 2, 1, [](int x, int) { return x / 4 % 2 == 0 ? 60.0 : 180.0; });
  const auto same = support::picture(kSize, 2, 2, [](int x, int) { return x / 4 % 2 == 0 ? 60.0 : 180.0; });
  EXPECT_NE(find_epipolar_offset(StereoPair::from(stripes, same), {}, {.max_rows = 4}, {}).outcome,
            EpipolarOutcome::corrected);
}

TEST(EpipolarOffset, OfAPatternThatRepeatsDownwardsIsNotGuessed) {
  // Without noise, a shift by the period of 4 rows fits exactly as well.
  const Waves waves(5);
  const auto at = [&](int shift) {
    return support::picture(kSize, 0, 1, [&](int x, int y) { return waves(x + shift, y % 4); });
  };
  const Pair pair{at(0), at(8)};
  EXPECT_NE(find_epipolar_offset(pair.get(), {}, {.max_rows = 8}, {}).outcome, EpipolarOutcome::corrected);
}

TEST(EpipolarOffset, OfImagesOfDifferentScenesIsRefused) {
  const Image<Gray> left = synthetic::random_dots(kSize, 1);
  for (std::uint32_t seed = 2; seed < 12; ++seed) {
    const Image<Gray> right = synthetic::random_dots(kSize, seed);
    const auto offset = find_epipolar_offset(StereoPair::from(left, right), {}, {.max_rows = 8}, {});
    EXPECT_TRUE(offset.outcome == EpipolarOutcome::few_points ||
                offset.outcome == EpipolarOutcome::no_agreement)
        << seed;
    EXPECT_EQ(offset.rows, 0) << seed;
  }
}

TEST(EpipolarOffset, BeyondTheSearchIsRefused) {
  EXPECT_NE(found(wall(7), 2).outcome, EpipolarOutcome::corrected);
}

TEST(EpipolarOffset, ToleratesAContradictingQuarterOfTheImage) {
  Pair pair = wall(1);
  const Pair other = wall(-2);
  for (int y = 0; y < kSize.height / 4; ++y) {
    std::copy_n(other.right.row(y), kSize.width, pair.right.row(y));
  }
  EXPECT_NEAR(found(pair).rows, 1, 0.1);
}

TEST(EpipolarOffset, IsTheSameOnEveryNumberOfThreads) {
  const Pair pair = wall(1.3, 0.004);
  const EpipolarOffset alone = found(pair);
  for (const int threads : {2, 3, 5}) {
    const EpipolarOffset offset = found(pair, 4, Exec::with_threads(threads));
    EXPECT_EQ(offset.rows, alone.rows);
    EXPECT_EQ(offset.rows_per_px, alone.rows_per_px);
    EXPECT_EQ(offset.points, alone.points);
    EXPECT_EQ(offset.agreeing, alone.agreeing);
  }
}

TEST(EpipolarOffset, IsEstimatedForImagesOfEverySize) {
  for (int width = 1; width <= 40; ++width) {
    for (int height = 1; height <= 40; ++height) {
      const Image<Gray> dots = synthetic::random_dots({width, height}, 3);
      for (const int first : {-1024, -8, 0, 1000}) {
        const auto offset =
            find_epipolar_offset(StereoPair::from(dots, dots),
                                 {.min_disparity = first, .num_disparities = 24}, {.max_rows = 8}, {});
        EXPECT_NE(offset.outcome, EpipolarOutcome::corrected) << width << "x" << height << " from " << first;
      }
    }
  }
}

TEST(ShiftRows, ByNothingChangesNothing) {
  const Image<Gray> dots = synthetic::random_dots({37, 23}, 4);
  EXPECT_EQ(first_difference(dots, shift_rows(dots, {}, {})), "");
}

TEST(ShiftRows, ByWholeRowsCopiesThemAndRepeatsTheBorder) {
  const Image<Gray> dots = synthetic::random_dots({37, 23}, 4);
  const Image<Gray> moved = shift_rows(dots, {.rows = 2}, {});
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 37; ++x) EXPECT_EQ(moved(x, y), dots(x, std::min(y + 2, 22)));
  }
}

TEST(ShiftRows, KeepsPlainGreyAtEveryStep) {
  for (int step = 0; step < 64; ++step) {
    const Image<Gray> white({5, 9}, Gray{255}, Pool{});
    EXPECT_EQ(first_difference(white, shift_rows(white, {.rows = static_cast<float>(step) / 64.0F}, {})), "");
  }
}

TEST(ShiftRows, MeetsARampHalfway) {
  Image<Gray> ramp({4, 30});
  for (int y = 0; y < 30; ++y) std::fill_n(ramp.row(y), 4, static_cast<Gray>(8 * y));
  const Image<Gray> moved = shift_rows(ramp, {.rows = 0.5F}, {});
  for (int y = 2; y < 27; ++y) EXPECT_EQ(moved(1, y), 8 * y + 4);
}

/// The density, and the share of the disparities that are correct within a pixel.
struct Quality {
  double density = 0;
  double right = 0;
};

Quality quality(const Pair& pair, float max_rows) {
  Config config = Config::paper();
  config.match.num_disparities = 32;
  config.epipolar_correction.max_rows = max_rows;
  const StereoResult scene = estimate_disparity(pair.get(), std::nullopt, config, {});
  double valid = 0;
  double right = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const float d = scene.disparity.disparity_px(x, y);
      valid += std::isnan(d) ? 0 : 1;
      right += std::abs(d - kDisparity) < 1 ? 1 : 0;
    }
  }
  return {valid / static_cast<double>(kSize.area()), right / valid};
}

TEST(EpipolarCorrection, RestoresTheDisparitiesLostToVibration) {
  const Quality still = quality(wall(0), -1);
  for (const double rows : {0.5, 1.0, 2.0}) {
    const Quality corrected = quality(wall(rows), 4);
    EXPECT_GT(corrected.density, still.density - 0.05) << rows;
    EXPECT_GT(corrected.right, still.right - 0.01) << rows;
  }
  EXPECT_LT(quality(wall(2), -1).density, still.density - 0.2);  // the loss without correction
}

TEST(EpipolarCorrection, LeavesAnAlignedPairBitForBit) {
  const Pair pair = wall(0);
  EXPECT_TRUE(correct_epipolar(pair.get(), {}, {.max_rows = 4}, {}).right.empty());
  Config config;
  config.epipolar_correction.max_rows = 4;
  const StereoResult on = estimate_disparity(pair.get(), std::nullopt, config, {});
  config.epipolar_correction.max_rows = -1;
  const StereoResult off = estimate_disparity(pair.get(), std::nullopt, config, {});
  EXPECT_EQ(first_difference(off.disparity.disparity_px, on.disparity.disparity_px), "");
  EXPECT_EQ(on.epipolar.outcome, EpipolarOutcome::aligned);
  EXPECT_EQ(off.epipolar.outcome, EpipolarOutcome::off);
}

}  // namespace
