// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>
#include <optional>

#include <cairn/sequence/pose.hpp>

namespace cairn {

/// The pose of the first camera in the map frame, whose origin is on the floor below it: x forward, y left, z
/// up (ROS REP 103). Without a floor the origin is the camera, whose view is assumed to be level.
Pose first_pose(const Ground& ground, const std::optional<StereoRig>& rig);

/// The camera's pose with height, roll and pitch from the floor, in a map whose z = 0 is the floor; x, y and
/// heading stay. nullopt without a floor.
std::optional<Pose> levelled(const Pose& map_from_camera, const Ground& ground,
                             const std::optional<StereoRig>& rig);

/// The rotation from a level camera with the same heading (x right, y down, z forward) to this one.
/// `map_from_camera`: z of the map is up.
Pose camera_from_level(const Pose& map_from_camera);

}  // namespace cairn
