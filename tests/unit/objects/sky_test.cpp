// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/random.hpp>
#include <cairn/objects/sky.hpp>
#include <cairn/stereo/confidence.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{80, 60};
constexpr StereoRig kRig{.focal_px = 100, .cx_px = 40, .cy_px = 30, .baseline_m = 0.2F, .doffs_px = 0};
constexpr GroundPlane kFloor{0, 0.2F, -6};  // the horizon is row 30

/// A bright sky above the horizon, a dark meadow below; superpixels are squares of 10 px.
struct Meadow {
  Image<Gray> left{kSize, Gray{20}, {}};
  DisparityMap disparity{Image<float>(kSize, kNan, {}), Image<Reject>(kSize, Reject::left_right, {})};
  Image<float> confidence{kSize, 0.0F, {}};
  Ground ground{kFloor, 1, 0, Refusal::none};
  Image<RegionId> superpixels{kSize, RegionId{0}, {}};
  Image<ObjectId> objects{kSize, ObjectId::none, {}};
  StereoRig rig = kRig;

  Meadow() {
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        superpixels(x, y) = RegionId{y / 10 * 8 + x / 10};
        if (y < 30) left(x, y) = 250;
        if (y > 30) see(x, y, kFloor.disparity_px(0, static_cast<float>(y)), 0.9F);
      }
    }
  }
  void see(int x, int y, float d, float sure) {
    disparity.disparity_px(x, y) = d;
    disparity.reject(x, y) = Reject::none;
    confidence(x, y) = sure;
  }
  [[nodiscard]] DisparityMap rejected() const {
    return reject_sky({disparity.disparity_px.clone(), disparity.reject.clone()},
                      {left, confidence, ground, superpixels, objects}, rig, {});
  }
  [[nodiscard]] int sky_pixels() const {
    const DisparityMap map = rejected();
    int count = 0;
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const bool is_sky = has(map.reject(x, y), Reject::sky);
        count += is_sky ? 1 : 0;
        EXPECT_EQ(std::isnan(map.disparity_px(x, y)), map.reject(x, y) != Reject::none);
        if (!is_sky) {
          EXPECT_EQ(map.reject(x, y), disparity.reject(x, y));
        }
      }
    }
    return count;
  }
};

constexpr int kAboveTheHorizon = 80 * 30;

TEST(Sky, IsTheBrightPartAboveTheHorizon) {
  EXPECT_EQ(Meadow().sky_pixels(), kAboveTheHorizon);
}

TEST(Sky, IsNothingWithoutAGround) {
  Meadow meadow;
  meadow.ground.plane.reset();
  EXPECT_EQ(meadow.sky_pixels(), 0);
}

TEST(Sky, AnUntrustedDisparityThereIsRejected) {
  Meadow meadow;
  meadow.see(5, 5, 9, 0.4F);
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon);
  EXPECT_EQ(meadow.rejected().reject(5, 5), Reject::sky);
  EXPECT_EQ(meadow.rejected().reject(6, 5), Reject::sky | Reject::left_right) << "a hole keeps its reasons";
}

TEST(Sky, WhatDiffersFromItStays) {
  Meadow meadow;
  meadow.see(5, 5, 9, 0.9F);
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon) << "a roof's disparity in a plain sky";
  meadow.left(5, 5) = 40;
  meadow.left(8, 8) = 40;
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon - 2) << "a leaf, and a cable without a disparity";
}

TEST(Sky, WithoutConfidencesAllDisparitiesAreTrusted) {
  Meadow meadow;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) meadow.see(x, y, 9, 0.4F);
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon);
  meadow.confidence = {};
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon - 100);
}

TEST(Sky, NearIsTwoPixelsAboveTheDisparityOfInfinity) {
  Meadow meadow;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) meadow.see(x, y, 1.5F, 0.9F);
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon);
  meadow.rig.doffs_px = 1;
  meadow.ground.plane->c -= 1;  // the same horizon
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon - 100);
}

TEST(Sky, ProbabilitiesAreThoseThatWereFitted) {
  EXPECT_FLOAT_EQ(sky_probability({0.9F, 0.5F, 1, 0, true}), 4029.0F / 4096);
  EXPECT_FLOAT_EQ(sky_probability({0.9F, 0.5F, 0, 0, true}), 544.0F / 4096);
}

TEST(Sky, NothingIsConfidentInAHole) {
  Image<Reject> reject(Size{2, 1}, Reject::none, {});
  reject(1, 0) = Reject::sky;
  const Image<float> confidence = without_holes(Image<float>(Size{2, 1}, 0.8F, {}), reject);
  EXPECT_EQ(confidence(0, 0), 0.8F);
  EXPECT_EQ(confidence(1, 0), 0.0F);
  EXPECT_TRUE(without_holes({}, reject).empty());
}

TEST(Sky, ASuperpixelFullOfTrustedNearDisparitiesIsNone) {
  Meadow meadow;
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) meadow.see(x, y, 9, 0.9F);
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon - 100);
  EXPECT_EQ(sky_probability({.brightness = 1,
                             .image_brightness = 0.1F,
                             .above_horizon = 1,
                             .near = 0.95F,
                             .touches_the_top = true}),
            0)
      << "a white lorry at dusk";
}

TEST(Sky, PixelsOfObjectsStay) {
  Meadow meadow;
  meadow.objects(44, 7) = ObjectId{1};
  EXPECT_EQ(meadow.sky_pixels(), kAboveTheHorizon - 1);
}

TEST(Sky, ADarkUpperHalfIsAWall) {
  Meadow meadow;
  for (int y = 0; y < 30; ++y) std::fill_n(meadow.left.row(y), kSize.width, Gray{20});
  EXPECT_EQ(meadow.sky_pixels(), 0);
}

TEST(Sky, TheOffsetOfTheCalibrationMovesTheHorizon) {
  Meadow meadow;
  meadow.rig.doffs_px = 2;  // infinity has a disparity of -2: the horizon is row 20
  EXPECT_EQ(meadow.sky_pixels(), 80 * 20);
}

/// The mean grey level of a superpixel that is sky, from the definition: each superpixel by itself.
std::optional<int> grey_of_sky(const Meadow& seen, RegionId piece) {
  double pixels = 0, brightness = 0, above = 0, near = 0, of_all = 0;
  SkyFeatures of;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      of_all += seen.left(x, y);
      if (seen.superpixels(x, y) != piece) continue;
      ++pixels;
      brightness += seen.left(x, y);
      above += y <= 30;
      near += seen.disparity.disparity_px(x, y) > 2 && seen.confidence(x, y) >= 0.7F;
      of.touches_the_top |= y == 0;
    }
  }
  of.brightness = static_cast<float>(brightness / pixels / 255);
  of.image_brightness = static_cast<float>(of_all / static_cast<double>(kSize.area()) / 255);
  of.above_horizon = static_cast<float>(above / pixels);
  of.near = static_cast<float>(near / pixels);
  if (sky_probability(of) <= 0.6F) return std::nullopt;
  return static_cast<int>(std::floor(brightness / pixels));
}

TEST(Sky, IsAsDefinedForRandomImages) {
  Random random;
  const auto in = [&](int low, int high) {
    return low + static_cast<int>(random.below(slot(high - low + 1)));
  };
  int sky = 0, kept = 0;
  for (int round = 0; round < 20; ++round) {
    Meadow seen;
    const int rows = in(4, 20), columns = in(10, 40);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        seen.superpixels(x, y) = RegionId{y / rows * 8 + x / columns};
        seen.left(x, y) = static_cast<Gray>(y < 30 ? in(200, 255) : in(0, 60));
        if (in(0, 3) == 0) seen.see(x, y, static_cast<float>(in(0, 6)), 0.1F * static_cast<float>(in(0, 10)));
      }
    }
    const DisparityMap map = seen.rejected();
    std::map<RegionId, std::optional<int>> grey;
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const RegionId piece = seen.superpixels(x, y);
        if (!grey.contains(piece)) grey[piece] = grey_of_sky(seen, piece);
        const bool is_other = grey[piece] && std::abs(seen.left(x, y) - *grey[piece]) > 24;
        ASSERT_EQ(has(map.reject(x, y), Reject::sky), grey[piece] && !is_other)
            << round << ": " << x << ", " << y;
        sky += grey[piece] ? 1 : 0;
        kept += is_other ? 1 : 0;
      }
    }
  }
  EXPECT_GT(sky, 1000);
  EXPECT_GT(kept, 10);
}

}  // namespace
}  // namespace cairn
