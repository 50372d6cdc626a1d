// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/objects/ground_curvature.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cmath>
#include <cstring>
#include <limits>

namespace cairn {
namespace {

constexpr Size kSize{320, 120};
constexpr StereoRig kRig{.focal_px = 300, .cx_px = 160, .cy_px = 20, .baseline_m = 0.5F, .doffs_px = 2};
constexpr float kHeight = 1.5F;  // m, of the camera, which looks ahead

/// Baseline over height, in px per row, from infinity at row 20.
constexpr GroundPlane kPlane{0, kRig.baseline_m / kHeight,
                             -kRig.cy_px* kRig.baseline_m / kHeight - kRig.doffs_px};

const Ground kGround{.plane = kPlane};

/// The ground as seen if its height, in m, is `height(ahead, to the right)`; by search along the ray.
template <class Height>
Image<float> seen_ground(Height height) {
  Image<float> disparity_px(kSize, std::numeric_limits<float>::quiet_NaN(), {});
  for (int y = 30; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const float down = (static_cast<float>(y) - kRig.cy_px) / kRig.focal_px;
      const float aside = (static_cast<float>(x) - kRig.cx_px) / kRig.focal_px;
      float z = 0.5F;
      while (z < 100 && kHeight - z * down > height(z, z * aside)) z *= 1.002F;
      disparity_px(x, y) = kRig.focal_px * kRig.baseline_m / z - kRig.doffs_px;
    }
  }
  return disparity_px;
}

const Image<ObstacleLabel>& all_floor() {
  static const Image<ObstacleLabel> space(kSize, ObstacleLabel::floor, {});
  return space;
}

bool have_the_same_bits(const Image<float>& a, const Image<float>& b) {
  for (int y = 0; y < kSize.height; ++y) {
    if (std::memcmp(a.row(y), b.row(y), sizeof(float) * std::size_t{kSize.width}) != 0) return false;
  }
  return true;
}

double share_on_plane(const Image<float>& disparity_px) {
  double on = 0, all = 0;
  for (int y = 30; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      ++all;
      const float plane_px = kPlane.disparity_px(static_cast<float>(x), static_cast<float>(y));
      on += std::abs(disparity_px(x, y) - plane_px) <= 0.5F ? 1 : 0;
    }
  }
  return on / all;
}

TEST(GroundCurvature, OfAFlatGroundChangesNoBit) {
  const Image<float> flat = seen_ground([](float, float) { return 0.0F; });
  EXPECT_GT(share_on_plane(flat), 0.99);
  EXPECT_TRUE(have_the_same_bits(without_curvature(flat.clone(), all_floor(), kGround, kRig), flat));
}

TEST(GroundCurvature, TakesASlopeAheadAndABankAway) {
  const Image<float> curved =
      seen_ground([](float ahead, float right) { return 0.001F * ahead * ahead - 0.0015F * ahead * right; });
  EXPECT_LT(share_on_plane(curved), 0.4);
  EXPECT_GT(share_on_plane(without_curvature(curved.clone(), all_floor(), kGround, kRig)), 0.95);
  const Image<float> downhill = seen_ground([](float ahead, float) { return -0.001F * ahead * ahead; });
  EXPECT_LT(share_on_plane(downhill), 0.2);
  EXPECT_GT(share_on_plane(without_curvature(downhill.clone(), all_floor(), kGround, kRig)), 0.75);
}

TEST(GroundCurvature, IsThatOfMostOfTheFloorAndLeavesOtherLabelsAlone) {
  Image<float> curved = seen_ground([](float ahead, float) { return 0.001F * ahead * ahead; });
  Image<ObstacleLabel> space = all_floor().clone();
  for (int y = 60; y < 110; ++y) {
    for (int x = 100; x < 180; ++x) {
      curved(x, y) += 3;                                   // of a fifth of the floor, wrong …
      if (x < 140) space(x, y) = ObstacleLabel::obstacle;  // … and half of that no floor
    }
  }
  const Image<float> flat = without_curvature(curved.clone(), space, kGround, kRig);
  EXPECT_EQ(flat(120, 80), curved(120, 80));
  EXPECT_NEAR(flat(250, 80), kPlane.disparity_px(250, 80), 0.4);
  EXPECT_NEAR(flat(160, 80), kPlane.disparity_px(160, 80) + 3, 0.4);
}

TEST(GroundCurvature, OfTooLittleFloorIsNone) {
  const Image<float> curved = seen_ground([](float ahead, float) { return 0.001F * ahead * ahead; });
  Image<ObstacleLabel> space(kSize, ObstacleLabel::unknown, {});
  EXPECT_TRUE(have_the_same_bits(without_curvature(curved.clone(), space, kGround, kRig), curved));
  EXPECT_TRUE(have_the_same_bits(without_curvature(curved.clone(), all_floor(), {}, kRig), curved));
  EXPECT_TRUE(without_curvature({}, {}, kGround, kRig).empty());
}

TEST(GroundCurvature, IsFreeInTheGridOfAFrame) {
  Frame frame;
  frame.disparity = {seen_ground([](float ahead, float) { return 0.002F * ahead * ahead; }),
                     Image<Reject>(kSize, Reject::none, {})};
  frame.ground.plane = kPlane;
  frame.space = all_floor().clone();
  frame.objects.labels = Image<ObjectId>(kSize, ObjectId::none, {});
  frame.refined.disparity_px = frame.disparity.disparity_px.clone();
  frame.refined.confidence = Image<float>(kSize, 0.0F, {});
  const FloorFrame floor = floor_frame(kPlane, kRig).value();
  const ObstaclesConfig config{.range = 20, .cell_size = 0.25F};
  const auto free_cells = [](const ObstacleGrid& grid) {
    return std::ranges::count(grid.cells, std::int8_t{ObstacleGrid::kFree});
  };
  const Image<float> seen_px = obstacle_disparities(frame);
  const auto by_plane = free_cells(map_obstacles(frame.space, seen_px, floor, kRig, config));
  EXPECT_GT(free_cells(map_obstacles(frame, floor, kRig, config)), 3 * by_plane / 2);
}

}  // namespace
}  // namespace cairn
