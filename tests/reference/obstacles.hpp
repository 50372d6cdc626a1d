// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/obstacles.hpp>

/// The slow twins of label_obstacles() and obstacle_disparities(): each pixel from scratch.
namespace cairn::reference {

Image<ObstacleLabel> label_obstacles(const ObstacleCues& cues, const std::optional<StereoRig>& rig,
                                     const GroundConfig& config);
Image<float> obstacle_disparities(View<const ObstacleLabel> space, const ObstacleCues& cues);

}  // namespace cairn::reference
