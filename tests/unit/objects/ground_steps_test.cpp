// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/objects/ground_steps.hpp>
#include <cmath>
#include <functional>
#include <limits>

namespace cairn {
namespace {

constexpr Size kSize{320, 240};
// 1 m above the floor, looking 30° down.
constexpr StereoRig kRig{.focal_px = 280, .cx_px = 160, .cy_px = 120, .baseline_m = 0.2F, .doffs_px = 0};
const float kSin = 0.5F, kCos = std::sqrt(0.75F);
const FloorFrame kFrame{
    .forward = {0, -kSin, kCos}, .left = {-1, 0, 0}, .up = {0, -kCos, -kSin}, .camera_height_m = 1};

/// What the camera sees of a ground whose height, in m, depends on the place.
struct Street {
  Image<float> disparity_px{kSize};
  Image<float> confidence{kSize, 0.9F, {}};
  Image<ObjectId> objects{kSize, ObjectId::none, {}};

  explicit Street(const std::function<float(float x, float y)>& height) {
    for (int v = 0; v < kSize.height; ++v) {
      for (int u = 0; u < kSize.width; ++u) disparity_px(u, v) = look(height, u, v);
    }
  }
  static float look(const std::function<float(float x, float y)>& height, int u, int v) {
    const Vec3 ray{(static_cast<float>(u) - kRig.cx_px) / kRig.focal_px,
                   (static_cast<float>(v) - kRig.cy_px) / kRig.focal_px, 1};
    const auto is_below = [&](float z) {
      const Vec3 at = kFrame.to_floor({z * ray.x, z * ray.y, z});
      return at.z <= height(at.x, at.y);
    };
    float z = 0.6F;
    for (constexpr float kStep = 0.02F; z < 10 && !is_below(z); z += kStep) {
      if (is_below(z + kStep)) {
        float above = z, below = z + kStep;
        for (int k = 0; k < 6; ++k) (is_below((above + below) / 2) ? below : above) = (above + below) / 2;
        return kRig.focal_px * kRig.baseline_m / below;
      }
    }
    return std::numeric_limits<float>::quiet_NaN();
  }
  [[nodiscard]] std::vector<GroundStep> steps(const StereoRig& rig = kRig, float range = 6) const {
    return find_steps(objects, disparity_px, confidence, kFrame, rig, {.range = range});
  }
};

TEST(GroundSteps, AKerbUpIsFoundWhereItIs) {
  const auto steps = Street([](float x, float) { return x > 2 ? 0.12F : 0.0F; }).steps();
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_NEAR(steps[0].height_m, 0.12, 0.01);
  EXPECT_NEAR((steps[0].from_m.x + steps[0].to_m.x) / 2, 2, 0.15);
  EXPECT_NEAR(steps[0].from_m.z, 0, 0.01);
  EXPECT_GT(steps[0].to_m.y - steps[0].from_m.y, 1.5F) << "most of the 2 m in view";
}

TEST(GroundSteps, AKerbDownIsFoundBehindWhatItHides) {
  const auto steps = Street([](float x, float y) { return x + 0.3F * y > 1.8F ? -0.15F : 0.0F; }).steps();
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_NEAR(steps[0].height_m, -0.15, 0.01);
  const Vec3 a = steps[0].from_m, b = steps[0].to_m;
  EXPECT_NEAR((a.x + b.x) / 2 + 0.3 * (a.y + b.y) / 2, 1.8, 0.2);
  EXPECT_NEAR(std::atan2(a.x - b.x, b.y - a.y), std::atan(0.3), 0.15);
}

TEST(GroundSteps, APavementHasTwo) {
  const auto steps = Street([](float x, float) { return x > 1.6F && x < 2.8F ? 0.15F : 0.0F; }).steps();
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_NEAR(steps[0].height_m, 0.15, 0.01);
  EXPECT_NEAR(steps[1].height_m, -0.15, 0.01);
  EXPECT_NEAR(steps[0].from_m.z, 0, 0.01);
  EXPECT_NEAR(steps[1].from_m.z, 0.15, 0.01);
}

TEST(GroundSteps, AKerbBesideTheWayIsOne) {
  for (const float side : {-1.0F, 1.0F}) {
    const auto steps = Street([&](float, float y) { return side * y > 0.7F ? 0.12F : 0.0F; }).steps();
    ASSERT_EQ(steps.size(), 1U) << side;
    EXPECT_NEAR(steps[0].height_m, 0.12, 0.01);
    EXPECT_NEAR(steps[0].from_m.y, 0.7 * side, 0.2);
    EXPECT_NEAR(steps[0].to_m.y, 0.7 * side, 0.2);
  }
}

TEST(GroundSteps, OfStairsTheFirstIsReported) {
  const auto steps = Street([](float x, float) { return x < 1.8F ? 0.0F : x < 2.4F ? 0.15F : 0.3F; }).steps();
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_NEAR(steps[0].height_m, 0.15, 0.01);
}

TEST(GroundSteps, TheRangeAndTheInfinityOfTheRigCount) {
  Street street([](float x, float) { return x > 2 ? 0.12F : 0.0F; });
  street.confidence = {};  // all are trusted
  for (const float range : {0.1F, 1.0F, 2.3F}) EXPECT_TRUE(street.steps(kRig, range).empty()) << range;
  EXPECT_EQ(street.steps(kRig, 1000).size(), 1U);
  StereoRig shifted = kRig;
  shifted.doffs_px = 5;
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) street.disparity_px(u, v) -= 5;
  }
  ASSERT_EQ(street.steps(shifted).size(), 1U);
  EXPECT_NEAR(street.steps(shifted)[0].height_m, 0.12, 0.01);
}

TEST(GroundSteps, RampsAndUnevenGroundAreNone) {
  EXPECT_TRUE(Street([](float, float) { return 0.0F; }).steps().empty());
  EXPECT_TRUE(Street([](float x, float) { return x > 1.5F ? 0.15F * (x - 1.5F) : 0.0F; }).steps().empty());
  EXPECT_TRUE(
      Street([](float x, float y) { return 0.03F * std::sin(6 * x) * std::sin(5 * y); }).steps().empty());
  EXPECT_TRUE(Street([](float x, float) { return x > 2 ? 0.05F : 0.0F; }).steps().empty()) << "too low";
  EXPECT_TRUE(Street([](float x, float) { return x > 2 ? 0.5F : 0.0F; }).steps().empty()) << "a wall";
  const auto block = [](float x, float y) {
    return std::abs(x - 2.3F) < 0.3F && std::abs(y) < 0.3F ? 0.12F : 0.0F;
  };
  EXPECT_TRUE(Street(block).steps().empty());
}

TEST(GroundSteps, TheGridHasThemAsOccupied) {
  ObstacleGrid grid{
      .cell_size_m = 0.1F, .width = 20, .height = 40, .origin_x_m = 0, .origin_y_m = -2, .cells = {}};
  grid.cells.assign(20U * 40U, ObstacleGrid::kFree);
  // From the middle of cell (15, 20) to that of cell (18, 25), and one that leaves the grid at its far end.
  add_steps(grid, {{.from_m = {1.55F, 0.05F, 0}, .to_m = {1.85F, 0.55F, 0}, .height_m = 0.1F},
                   {.from_m = {1.75F, -0.95F, 0}, .to_m = {9, -0.95F, 0}, .height_m = -0.1F},
                   {.from_m = {-1, -2.5F, 0}, .to_m = {0.15F, -1.35F, 0}, .height_m = 0.2F}});
  const auto occupied = [&](int column, int row) {
    return grid.cells[static_cast<std::size_t>(20 * row + column)] == ObstacleGrid::kOccupied;
  };
  EXPECT_TRUE(occupied(15, 20));
  EXPECT_TRUE(occupied(18, 25));
  for (int row = 0; row < 40; ++row) {
    int count = 0;
    for (int column = 0; column < 20; ++column) count += occupied(column, row) ? 1 : 0;
    const bool is_crossed = (row >= 20 && row <= 25) || row == 5 || row == 6;
    EXPECT_GE(count, is_crossed ? 1 : row == 10 ? 3 : 0) << row;
    EXPECT_LE(count, is_crossed ? 2 : row == 10 ? 3 : 0) << row;
  }
  EXPECT_TRUE(occupied(17, 10));
}

TEST(GroundSteps, ObjectsAndUnsureDisparitiesAreNotLookedAt) {
  Street street([](float x, float) { return x > 2 ? 0.12F : 0.0F; });
  ASSERT_FALSE(street.steps().empty());
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      if (street.disparity_px(u, v) < 25) street.confidence(u, v) = 0.4F;
    }
  }
  EXPECT_TRUE(street.steps().empty());
  Street box([](float x, float) { return x > 2 ? 0.12F : 0.0F; });
  for (int v = 0; v < 110; ++v) std::fill_n(box.objects.row(v), kSize.width, ObjectId{1});
  EXPECT_TRUE(box.steps().empty());
}

TEST(GroundSteps, WhatDisparitiesCannotTellApartIsNone) {
  // A tenth of the baseline: the same scene, but a disparity's height is ten times less sure.
  Street street([](float x, float) { return x > 2 ? 0.12F : 0.0F; });
  StereoRig narrow = kRig;
  narrow.baseline_m /= 10;
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) street.disparity_px(u, v) /= 10;
  }
  EXPECT_TRUE(street.steps(narrow).empty());
}

TEST(GroundSteps, NothingIsSeenInHoles) {
  Street street([](float x, float) { return x > 2 ? 0.12F : 0.0F; });
  for (int v = 0; v < kSize.height; ++v)
    std::fill_n(street.disparity_px.row(v), kSize.width, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(street.steps().empty());
}

}  // namespace
}  // namespace cairn
