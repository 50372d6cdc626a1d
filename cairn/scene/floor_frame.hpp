// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <optional>

namespace cairn {

/// Where the floor is, in metres. The floor's frame has its origin on the floor below the left camera, x
/// forward (the camera's view, laid on the floor), y left, z up, as robots count (ROS REP 103).
struct FloorFrame {
  Vec3 forward;  // unit vectors of the floor's frame, in the left camera's
  Vec3 left;
  Vec3 up;
  float camera_height_m = 0;

  [[nodiscard]] Vec3 to_floor(Vec3 in_camera_m) const;
  [[nodiscard]] Vec3 to_camera(Vec3 in_floor_m) const;
  /// Of the camera: positive looks down.
  [[nodiscard]] float pitch_rad() const;
  /// Of the camera: positive lowers its right side.
  [[nodiscard]] float roll_rad() const;
  /// The same as a matrix that takes homogeneous points from the camera's frame to the floor's, row by row.
  [[nodiscard]] std::array<float, 16> floor_from_camera() const;
};

/// nullopt for a plane that no floor below a camera can show: one through the camera, or above it.
std::optional<FloorFrame> floor_frame(const GroundPlane& ground, const StereoRig& rig);
/// The same; nullopt also where there is no ground, or no rig.
std::optional<FloorFrame> floor_frame(const Ground& ground, const std::optional<StereoRig>& rig);

}  // namespace cairn
