// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/image/noise.hpp>
#include <cairn/regions/textured.hpp>
#include <limits>

#include "support/grids.hpp"
#include "support/noise.hpp"

namespace cairn {
namespace {

using support::Noise;
using support::picture;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{160, 120};

/// The disparity of each pixel; NaN = hole.
template <class Disparity>
DisparityMap map_of(Size size, Disparity disparity) {
  DisparityMap map{Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float d = disparity(x, y);
      map.disparity_px(x, y) = d;
      map.reject(x, y) = std::isnan(d) ? Reject::no_data : Reject::none;
    }
  }
  return map;
}

DisparityMap everywhere(float d) {
  return map_of(kSize, [d](int, int) { return d; });
}

bool inside(Rect rect, int x, int y, int margin = 0) {
  return x >= rect.x - margin && x < rect.x + rect.width + margin && y >= rect.y - margin &&
         y < rect.y + rect.height + margin;
}

/// Random dots within `rect`, uniform elsewhere.
Image<Gray> textured_patch(Rect rect, double noise_sigma, std::uint32_t seed) {
  Noise dots(seed + 100);
  return picture(kSize, noise_sigma, seed,
                 [&](int x, int y) { return inside(rect, x, y) ? 30 + 200 * dots.uniform() : 120.0; });
}

Image<float> evidence_of(const Image<Gray>& image, const DisparityMap& map,
                         const TexturedConfig& config = {}) {
  return select_textured({image, {}, noise_sigma(image)}, map, config, {});
}

int evidence_count(const Image<float>& evidence) {
  int count = 0;
  for (int y = 0; y < evidence.height(); ++y) {
    for (int x = 0; x < evidence.width(); ++x) count += std::isnan(evidence(x, y)) ? 0 : 1;
  }
  return count;
}

TEST(NoiseSigma, RecoversPlantedNoiseOnAPlainSurface) {
  for (const double sigma : {1.0, 2.0, 5.0, 10.0}) {
    const Image<Gray> image = picture(kSize, sigma, 7, [](int, int) { return 128.0; });
    EXPECT_NEAR(noise_sigma(image), sigma, 0.12 * sigma) << sigma;
  }
}

TEST(NoiseSigma, IsNotMovedByStepsAndShading) {
  const auto brightness = [](int x, int y) { return 40 + 0.6 * x + 0.2 * y + (x / 40 + y / 40) % 2 * 60.0; };
  for (const double sigma : {2.0, 5.0}) {
    const Image<Gray> image = picture(kSize, sigma, 8, brightness);
    EXPECT_NEAR(noise_sigma(image), sigma, 0.15 * sigma) << sigma;
  }
}

TEST(NoiseSigma, IsZeroWithoutNoise) {
  const Image<Gray> plain = picture(kSize, 0, 0, [](int, int) { return 77.0; });
  const Image<Gray> ramp = picture(kSize, 0, 0, [](int x, int y) { return x + y * 0.0; });
  EXPECT_EQ(noise_sigma(plain), 0);
  EXPECT_LT(noise_sigma(ramp), 0.2);
}

TEST(NoiseSigma, IsZeroForTooSmallImages) {
  for (const Size size : {Size{1, 1}, Size{2, 9}, Size{9, 2}, Size{1, 30}}) {
    const Image<Gray> image = grids::random_image<Gray>(size, 0, 255, 1);
    EXPECT_EQ(noise_sigma(image), 0) << text(size);
  }
}

TEST(Evidence, IsFoundOnTextureOnly) {
  const Rect patch{30, 20, 50, 60};
  const Image<float> evidence = evidence_of(textured_patch(patch, 2, 1), everywhere(10));
  int textured = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (std::isnan(evidence(x, y))) continue;
      EXPECT_EQ(evidence(x, y), 10);
      EXPECT_TRUE(inside(patch, x, y, 2)) << x << ' ' << y;
      textured += inside(patch, x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(textured, patch.width * patch.height * 6 / 10);
}

TEST(Evidence, IgnoresDisparitySmearedOverAPlainSurface) {
  const Rect patch{60, 40, 30, 30};
  const DisparityMap smeared =
      map_of(kSize, [&](int x, int y) { return inside(patch, x, y, 8) ? 24.0F : 6.0F; });
  const Image<float> evidence = evidence_of(textured_patch(patch, 1, 2), smeared);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (!inside(patch, x, y, 2)) {
        EXPECT_TRUE(std::isnan(evidence(x, y))) << x << ' ' << y;
      }
    }
  }
  EXPECT_GT(evidence_count(evidence), patch.width * patch.height / 2);
}

TEST(Evidence, IsHardlyEverFoundInNoiseAlone) {
  for (const double sigma : {0.5, 2.0, 8.0}) {
    const Image<Gray> image = picture(kSize, sigma, 3, [](int, int) { return 128.0; });
    EXPECT_LT(evidence_count(evidence_of(image, everywhere(10))), kSize.area() / 500) << sigma;
  }
}

TEST(Evidence, IsNotOnAHorizontalEdgeButOnAVerticalOne) {
  const Image<Gray> horizontal = picture(kSize, 0, 0, [](int, int y) { return y < 60 ? 60.0 : 170.0; });
  const Image<Gray> vertical = picture(kSize, 0, 0, [](int x, int) { return x < 80 ? 60.0 : 170.0; });
  const Image<Gray> diagonal = picture(kSize, 0, 0, [](int x, int y) { return x < y ? 60.0 : 170.0; });
  EXPECT_EQ(evidence_count(evidence_of(horizontal, everywhere(10))), 0);
  EXPECT_GE(evidence_count(evidence_of(vertical, everywhere(10))), 2 * kSize.height);
  EXPECT_GE(evidence_count(evidence_of(diagonal, everywhere(10))), 2 * kSize.height);
}

TEST(Evidence, IsNotOnAnEdgeThatTheRowsOnlyGraze) {
  const auto edge = [](double slope) {
    return picture(kSize, 0, 0, [slope](int x, int y) { return 110 + 40 * std::tanh(y - 40 - slope * x); });
  };
  const Image<Gray> grazing = edge(0.25);  // |gx| is a quarter of |gy|
  const Image<Gray> steep = edge(1.0);
  EXPECT_LT(evidence_count(evidence_of(grazing, everywhere(10))), 5);
  EXPECT_GT(evidence_count(evidence_of(steep, everywhere(10))), 100);
}

TEST(Evidence, NeedsNeighboursThatAgree) {
  const Image<Gray> dots = textured_patch({0, 0, 60, 60}, 1, 4);
  const DisparityMap with_outlier =
      map_of(kSize, [](int x, int y) { return x == 30 && y == 30 ? 25.0F : 10.0F; });
  const DisparityMap without = everywhere(10);
  const Image<float> evidence = evidence_of(dots, with_outlier);
  const Image<float> undisturbed = evidence_of(dots, without);
  EXPECT_TRUE(std::isnan(evidence(30, 30)));
  EXPECT_GE(evidence_count(evidence), evidence_count(undisturbed) - 5);

  Noise noise(9);
  const DisparityMap scattered =
      map_of(kSize, [&](int, int) { return static_cast<float>(60 * noise.uniform()); });
  EXPECT_LT(evidence_count(evidence_of(dots, scattered)), evidence_count(undisturbed) / 50);
}

TEST(Evidence, HasTheMapsValuesAndNoneInItsHoles) {
  const Rect patch{20, 20, 60, 60};
  const DisparityMap map =
      map_of(kSize, [](int x, int y) { return x % 7 == 0 ? kNaN : 5 + 0.01F * static_cast<float>(x + y); });
  const Image<float> evidence = evidence_of(textured_patch(patch, 1, 5), map);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (x % 7 == 0) {
        EXPECT_TRUE(std::isnan(evidence(x, y)));
      }
      if (!std::isnan(evidence(x, y))) {
        EXPECT_EQ(evidence(x, y), map.disparity_px(x, y));
      }
    }
  }
  EXPECT_GT(evidence_count(evidence), 1000);
}

TEST(Evidence, ShrinksAsTheThresholdsRise) {
  const Image<Gray> image = textured_patch({20, 20, 80, 80}, 3, 6);
  int before = std::numeric_limits<int>::max();
  for (const float least : {0.0F, 5.0F, 20.0F, 255.0F}) {
    TexturedConfig config;
    config.gradient_min = least;
    const int count = evidence_count(evidence_of(image, everywhere(10), config));
    EXPECT_LT(count, before);
    before = count;
  }
  EXPECT_EQ(before, 0);
}

}  // namespace
}  // namespace cairn
