// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/obstacles.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <vector>

/// Kerbs and other steps of the ground. (docs/stages/obstacles.md, beyond the paper)
namespace cairn {

/// A straight edge between two levels of the ground, one of which is the floor.
struct GroundStep {
  Vec3 from_m;         // its ends on the nearer level, in the floor frame
  Vec3 to_m;           // to the left of `from_m` for somebody on the nearer level who faces the step
  float height_m = 0;  // of the farther level above the nearer one; negative: a step down
};

/// Steps of at least 7.5 cm and at most 35 cm that are at least 1 m long, nearest first. Both levels must be visible:
/// level within 3 cm for half a metre, without objects, and four standard deviations of a disparity's height apart,
/// which limits the distance. All images have one size. `disparity_px`: of the matches, NaN = hole; `confidence`: theirs,
/// only 0.5 and more counts; empty: all are trusted. Not farther ahead or aside than config.range or 20 m.
std::vector<GroundStep> find_steps(View<const ObjectId> objects, View<const float> disparity_px,
                                   View<const float> confidence, const FloorFrame& floor,
                                   const StereoRig& rig, const ObstaclesConfig& config);
/// Marks the cells along the steps as occupied.
void add_steps(ObstacleGrid& grid, const std::vector<GroundStep>& steps);

}  // namespace cairn
