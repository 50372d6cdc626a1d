// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/scene/background.hpp>
#include <cmath>
#include <limits>

#include "support/noise.hpp"

namespace cairn {
namespace {

using support::Noise;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{320, 240};
constexpr StereoRig kRig{300, 160, 120, 0.2F, 0};
constexpr double kPitch = 0.35;  // rad; the camera looks down

/// The disparity of the plane n·X = distance in the camera's frame: d = B/distance · n·(x − cx, y − cy, f).
GroundPlane plane_at(const Vec3& normal, float distance_m) {
  const float k = kRig.baseline_m / distance_m;
  return {k * normal.x, k * normal.y,
          k * (normal.z * kRig.focal_px - normal.x * kRig.cx_px - normal.y * kRig.cy_px) - kRig.doffs_px};
}

const GroundPlane kFloor =
    plane_at({0, static_cast<float>(std::cos(kPitch)), static_cast<float>(std::sin(kPitch))}, 1.0F);

/// An upright wall, `turn` radians from facing the camera.
GroundPlane wall_at(double turn, float distance_m) {
  return plane_at({static_cast<float>(std::sin(turn)), static_cast<float>(-std::cos(turn) * std::sin(kPitch)),
                   static_cast<float>(std::cos(turn) * std::cos(kPitch))},
                  distance_m);
}

/// Textured disparities of the planes: a sample of the pixels, with a little noise; `more` changes a pixel's
/// disparity.
template <class More>
Image<float> evidence_of(const Background& truth, double share, float noise_px, More more) {
  Noise noise(11);
  Image<float> evidence(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const float d = more(x, y, truth.disparity_px(static_cast<float>(x), static_cast<float>(y)));
      const auto wrong = static_cast<float>(noise.gaussian(noise_px));
      evidence(x, y) = noise.uniform() < share ? d + wrong : kNaN;
    }
  }
  return evidence;
}
Image<float> evidence_of(const Background& truth) {
  return evidence_of(truth, 0.3, 0.1F, [](int, int, float d) { return d; });
}

float largest_difference(const Background& a, const Background& b) {
  float largest = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const auto u = static_cast<float>(x);
      const auto v = static_cast<float>(y);
      largest = std::max(largest, std::abs(a.disparity_px(u, v) - b.disparity_px(u, v)));
    }
  }
  return largest;
}

Ground ground_of(const GroundPlane& plane) {
  Ground ground;
  ground.plane = plane;
  ground.support = 1;
  return ground;
}

Background background_of(const Image<float>& evidence, const Ground& ground,
                         const std::optional<StereoRig>& rig, const BackgroundConfig& config = {}) {
  return fit_background(evidence, ground, rig, config, {});
}

const Background kRoom{{kFloor, wall_at(-0.6, 3.2F), wall_at(0.7, 3.5F)}};

TEST(Background, IsTheNearestOfItsPlanesAndNeverBehindInfinity) {
  const Background background{{{0, 0, 3}, {1, 0, 0}, {0, 0, -5}}};
  EXPECT_EQ(background.disparity_px(1, 0), 3);
  EXPECT_EQ(background.disparity_px(7, 0), 7);
  EXPECT_EQ((Background{{{0, 0, -5}}}.disparity_px(0, 0)), 0);
  EXPECT_EQ(Background{}.disparity_px(10, 10), 0);
}

TEST(Background, OfARoomIsItsFloorAndItsTwoWalls) {
  const Background found = background_of(evidence_of(kRoom), ground_of(kFloor), kRig);
  EXPECT_EQ(found.planes.size(), 3U);
  EXPECT_LT(largest_difference(found, kRoom), 0.1F);
}

TEST(Background, FindsTheWallsWithoutACalibrationToo) {
  const Background found = background_of(evidence_of(kRoom), ground_of(kFloor), std::nullopt);
  EXPECT_EQ(found.planes.size(), 3U);
  EXPECT_LT(largest_difference(found, kRoom), 0.15F);
}

TEST(Background, HasWallsUprightOnTheFloor) {
  const Background found = background_of(evidence_of(kRoom), ground_of(kFloor), kRig);
  const auto normal = [](const GroundPlane& p) {
    const float f = kRig.focal_px;
    return Vec3{p.a * f, p.b * f, p.a * kRig.cx_px + p.b * kRig.cy_px + p.c + kRig.doffs_px};
  };
  const auto dot = [](Vec3 u, Vec3 v) { return u.x * v.x + u.y * v.y + u.z * v.z; };
  const Vec3 up = normal(kFloor);
  ASSERT_GE(found.planes.size(), 2U);
  for (std::size_t i = 1; i < found.planes.size(); ++i) {
    const Vec3 n = normal(found.planes[i]);
    EXPECT_LT(std::abs(dot(n, up)) / std::sqrt(dot(n, n) * dot(up, up)), 1e-3F) << i;
  }
}

TEST(Background, DoesNotMistakeABoxForAWall) {
  const auto box = [](int x, int y, float d) {
    return x >= 110 && x < 200 && y >= 50 && y < 170 ? 32.0F : d;
  };
  const Image<float> evidence = evidence_of(kRoom, 0.3, 0.1F, box);
  const Background found = background_of(evidence, ground_of(kFloor), kRig);
  EXPECT_EQ(found.planes.size(), 3U);
  EXPECT_LT(largest_difference(found, kRoom), 0.1F);
}

TEST(Background, IsOnlyTheFloorIfThereIsJustABoxOnIt) {
  const Background floor{{kFloor}};
  const auto box = [](int x, int y, float d) { return x >= 60 && x < 120 && y >= 60 && y < 160 ? 30.0F : d; };
  const Image<float> evidence = evidence_of(floor, 0.3, 0.1F, box);
  EXPECT_EQ(background_of(evidence, ground_of(kFloor), kRig).planes.size(), 1U);
}

TEST(Background, HasTheWallsEvenIfABoxInFrontHasMoreSupport) {
  const auto box = [](int x, int y, float d) { return x >= 40 && x < 280 && y >= 30 && y < 200 ? 32.0F : d; };
  const Image<float> evidence = evidence_of(kRoom, 0.3, 0.1F, box);
  const Background found = background_of(evidence, ground_of(kFloor), kRig);
  EXPECT_EQ(found.planes.size(), 3U);
  EXPECT_LT(largest_difference(found, kRoom), 0.15F);
}

TEST(Background, MayHaveAWallWithADoorwayWhereMaxBehindAllowsIt) {
  const Background room{{kFloor, wall_at(0, 3)}};
  const auto doorway = [](int x, int y, float d) { return x >= 100 && x < 160 && y < 90 ? d - 6 : d; };
  const Image<float> evidence = evidence_of(room, 0.3, 0.1F, doorway);  // 18 % are on the wall itself
  BackgroundConfig config;
  config.max_walls = 1;
  config.max_behind = 9;
  EXPECT_GT(largest_difference(background_of(evidence, ground_of(kFloor), kRig, config), room), 1);
  config.max_behind = 36;
  EXPECT_LT(largest_difference(background_of(evidence, ground_of(kFloor), kRig, config), room), 0.1F);
}

TEST(Background, IsNotMisledByReflectionsBelowTheFloor) {
  Noise noise(5);
  const auto mirrored = [&](int, int y, float d) {
    return y >= 150 && noise.uniform() < 0.5 ? d - 4 - static_cast<float>(6 * noise.uniform()) : d;
  };
  const Image<float> evidence = evidence_of(kRoom, 0.3, 0.1F, mirrored);
  const Background found = background_of(evidence, ground_of(kFloor), kRig);
  EXPECT_EQ(found.planes.size(), 3U);
  EXPECT_LT(largest_difference(found, kRoom), 0.1F);
}

/// A room with floor, front wall, and on the left a perpendicular wall with few pixels.
struct SideWall {
  Background room{{kFloor, wall_at(0.3, 3.2F), wall_at(0.3 - 1.5707963, 1.6F)}};
  Image<float> evidence;
  explicit SideWall(double share) {
    Noise noise(3);
    evidence = evidence_of(room, 0.3, 0.1F, [&](int x, int y, float d) {
      const bool on_side = room.planes[2].disparity_px(static_cast<float>(x), static_cast<float>(y)) >= d;
      return on_side && noise.uniform() >= share ? kNaN : d;
    });
  }
  [[nodiscard]] double share_of_evidence() const {
    int all = 0;
    int on = 0;
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const auto u = static_cast<float>(x);
        const auto v = static_cast<float>(y);
        if (std::isnan(evidence(x, y))) continue;
        ++all;
        on += room.planes[2].disparity_px(u, v) >= room.disparity_px(u, v) ? 1 : 0;
      }
    }
    return static_cast<double>(on) / all;
  }
};

TEST(Background, HasASideWallOfLittleSupportIfPerpendicularToTheFirst) {
  const SideWall side(0.03);
  BackgroundConfig config;
  config.min_share = 3;
  config.min_share_square = 0.4F;
  ASSERT_GT(side.share_of_evidence(), 0.006);
  ASSERT_LT(side.share_of_evidence(), 0.02);
  const Background found = background_of(side.evidence, ground_of(kFloor), kRig, config);
  EXPECT_EQ(found.planes.size(), 3U);
  EXPECT_LT(largest_difference(found, side.room), 0.2F);
  config.min_share_square = 100;
  EXPECT_EQ(background_of(side.evidence, ground_of(kFloor), kRig, config).planes.size(), 2U);
}

TEST(Background, HasNoWallOfLittleSupportUnlessPerpendicularToTheFirst) {
  SideWall side(0.03);
  const Background skew{{kFloor, side.room.planes[1], wall_at(0.3 - 1.0, 1.9F)}};
  side.room = skew;
  Noise noise(3);
  side.evidence = evidence_of(skew, 0.3, 0.1F, [&](int x, int y, float d) {
    const bool on_side = skew.planes[2].disparity_px(static_cast<float>(x), static_cast<float>(y)) >= d;
    return on_side && noise.uniform() >= 0.03 ? kNaN : d;
  });
  BackgroundConfig config;
  config.min_share = 3;
  config.min_share_square = 0.4F;
  EXPECT_EQ(background_of(side.evidence, ground_of(kFloor), kRig, config).planes.size(), 2U);
}

TEST(Background, HasAStrongWallDespiteFalseSupportBehindIt) {
  const Background room{{kFloor, wall_at(0, 3)}};
  Noise noise(9);
  const auto mismatched = [&](int, int y, float d) {
    return y < 120 && noise.uniform() < 0.06 ? static_cast<float>(noise.uniform()) * (d - 2) : d;
  };
  const Image<float> evidence = evidence_of(room, 0.3, 0.1F, mismatched);
  const Background found = background_of(evidence, ground_of(kFloor), kRig);
  EXPECT_EQ(found.planes.size(), 2U);
  EXPECT_LT(largest_difference(found, room), 0.1F);
}

TEST(Background, HasAWallThoughNoFloorIsSeen) {
  const Background wall{{{0.01F, 0, 8}}};
  const Background found = background_of(evidence_of(wall), {}, kRig);
  ASSERT_GE(found.planes.size(), 1U);
  EXPECT_LT(largest_difference(found, wall), 0.1F);
}

TEST(Background, HasAtMostTheRequestedNumberOfWalls) {
  for (int walls = 0; walls <= 3; ++walls) {
    BackgroundConfig config;
    config.max_walls = walls;
    const Background found = background_of(evidence_of(kRoom), ground_of(kFloor), kRig, config);
    EXPECT_EQ(found.planes.size(), 1U + static_cast<std::size_t>(std::min(walls, 2))) << walls;
  }
}

TEST(Background, IsTheFloorOrNothingWithoutSupport) {
  const Image<float> none(kSize, kNaN, {});
  EXPECT_TRUE(background_of(none, {}, kRig).planes.empty());
  EXPECT_EQ(background_of(none, ground_of(kFloor), kRig).planes.size(), 1U);
}

}  // namespace
}  // namespace cairn
