// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/obstacles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/objects/obstacle_kernels.hpp>
#include <cmath>
#include <limits>

#include "support/first_difference.hpp"
#include "support/grids.hpp"
#include "support/noise.hpp"
#include "support/random_input.hpp"

namespace cairn {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
constexpr StereoRig kRig{.focal_px = 100, .cx_px = 40, .cy_px = 20, .baseline_m = 0.2F, .doffs_px = 1.5F};
constexpr GroundPlane kFloor{0.01F, 0.2F, -3};
constexpr GroundPlane kLeftWall{-0.1F, 0.01F, 4};
constexpr GroundPlane kRightWall{0.08F, 0, 1};

/// A scene with every kind of pixel: disparities on and off the planes, holes, pieces in part on the floor.
struct Scene {
  DisparityMap disparity;
  Image<float> seen;
  Image<float> confidence;
  Image<ObjectId> objects;

  Scene(Size size, std::uint32_t seed)
      : disparity{Image<float>(size), Image<Reject>(size, Reject::none, {})},
        seen(size),
        confidence(size),
        objects(size) {
    support::Noise noise(seed);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const float floor = kFloor.disparity_px(static_cast<float>(x), static_cast<float>(y));
        const int piece = y / 6 * 20 + x / 7;
        const double off = piece % 3 == 0 ? 0.1 : 0.5;  // share of the pixels off the floor
        const auto step = static_cast<float>(8 * noise.uniform() - 2);
        disparity.disparity_px(x, y) = noise.uniform() < 0.3   ? kHole
                                       : noise.uniform() < off ? floor + step
                                                               : floor;
        seen(x, y) = noise.uniform() < 0.1 ? floor : disparity.disparity_px(x, y);
        confidence(x, y) = static_cast<float>(noise.uniform());
        objects(x, y) = ObjectId{noise.uniform() < 0.1 ? 1 : 0};
        if (std::isnan(disparity.disparity_px(x, y)) && noise.uniform() < 0.3)
          disparity.reject(x, y) = Reject::sky;
      }
    }
  }
};

void expect_equal_to_reference(const ObstacleCues& cues, const std::optional<StereoRig>& rig) {
  const GroundConfig config;
  const Image<ObstacleLabel> expected = reference::label_obstacles(cues, rig, config);
  for (const Target target : supported_targets()) {
    EXPECT_EQ(grids::numbers(label_obstacles(cues, rig, config, Exec::with_threads(1, target))),
              grids::numbers(expected))
        << text(expected.size());
    const Image<float> placed = obstacle_disparities(expected, cues, Exec::with_threads(1, target));
    EXPECT_EQ(first_difference(reference::obstacle_disparities(expected, cues), placed), "");
  }
}

TEST(SpaceEquivalence, HoldsForEverySize) {
  for (const Size size : {Size{1, 1}, {1, 40}, {31, 7}, {64, 30}, {67, 70}, {130, 40}}) {
    const Scene scene(size, static_cast<std::uint32_t>(size.width));
    const Ground ground{kFloor, 1, 0, Refusal::none};
    const Background background{{kFloor, kLeftWall, kRightWall}, true};
    expect_equal_to_reference(
        {scene.disparity, scene.seen, scene.confidence, ground, background, {}, scene.objects}, kRig);
  }
}

TEST(SpaceEquivalence, HoldsForAnyKnownInputs) {
  const Scene scene({67, 45}, 3);
  const Image<float> no_confidence, no_probability;
  const Image<float> likely_floor = random_input::random_floats({67, 45}, 1, 0.3F, 4);
  for (const Ground& ground : {Ground{kFloor, 1, 0, Refusal::none}, Ground{}}) {
    for (const bool walls : {false, true}) {
      Background background{{}, ground.plane.has_value()};
      if (ground.plane) background.planes.push_back(kFloor);
      if (walls) background.planes.insert(background.planes.end(), {kLeftWall, kRightWall});
      for (const Image<float>* const confidence : {&scene.confidence, &no_confidence}) {
        for (const Image<float>* const probability : {&likely_floor, &no_probability}) {
          const ObstacleCues cues{scene.disparity, {}, *confidence, ground,      background, {},
                                  scene.objects,   {}, {},          *probability};
          expect_equal_to_reference(cues, kRig);
          expect_equal_to_reference(cues, std::nullopt);
        }
      }
    }
  }
}

TEST(SpaceEquivalence, HoldsForRefinedDisparities) {
  const Scene scene({67, 45}, 5);
  const Image<float> likely = random_input::random_floats({67, 45}, 10, 0.1F, 1);
  const Image<float> refined = random_input::random_floats({67, 45}, 40, 0.5F, 2);
  const Ground ground{kFloor, 1, 0, Refusal::none};
  const Background background{{kFloor, kLeftWall}, true};
  const Image<float> no_confidence;
  for (const Image<float>* const confidence : {&scene.confidence, &no_confidence}) {
    expect_equal_to_reference(
        {scene.disparity, scene.seen, *confidence, ground, background, {}, scene.objects, refined, likely},
        kRig);
    expect_equal_to_reference(
        {scene.disparity, {}, *confidence, ground, background, {}, scene.objects, refined, likely}, kRig);
  }
}

/// From the definition, one pixel.
std::pair<int, int> from_floor(float d, float confidence, float floor_px, float margin) {
  using Out = kernels::HeightsOut;
  if (std::isnan(d)) return {0, 0};
  const float height = d - floor_px;
  int marks =
      Out::kKnown | static_cast<int>(std::floor(std::clamp(confidence, 0.0F, 1.0F) * Out::kSureSteps + 0.5F));
  if (std::abs(height) <= margin) marks |= Out::kOn;
  if (height > margin) marks |= Out::kFront;
  const float above = std::clamp(height, Out::kLowest, Out::kHighest) - Out::kLowest;
  return {static_cast<int>(std::floor(above * Out::kSteps + 0.5F)), marks};
}

TEST(Obstacles, HeightsAboveTheFloorAreThoseOfTheDefinition) {
  const Size size{131, 9};
  const Image<float> disparity = random_input::random_floats(size, 40, 0.2F, 5);
  const Image<float> confidence = random_input::random_floats(size, 2, 0.1F, 6);
  const GroundPlane floor{0.05F, 1.5F, 2};
  for (const Target target : supported_targets()) {
    const kernels::ObstacleKernels* const run = kernels::obstacle_kernels(target);
    ASSERT_NE(run, nullptr);
    for (int y = 0; y < size.height; ++y) {
      std::vector<std::int32_t> heights(slot(size.width));
      std::vector<std::int32_t> marks(heights.size());
      run->in_steps_from_floor(disparity.row(y), confidence.row(y), y, floor, 1, size.width,
                               {heights.data(), marks.data()});
      for (int x = 0; x < size.width; ++x) {
        const float sure = std::isnan(confidence(x, y)) ? 0 : confidence(x, y);
        const auto expected = from_floor(disparity(x, y), sure,
                                         floor.disparity_px(static_cast<float>(x), static_cast<float>(y)), 1);
        EXPECT_EQ(std::pair(heights[slot(x)], marks[slot(x)]), expected)
            << name(target) << " " << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace cairn
