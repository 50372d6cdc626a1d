// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <optional>

namespace cairn {

/// The floor frame, in metres: origin on the floor below the left camera, x forward (viewing direction
/// projected onto the floor), y left, z up, as in robotics (ROS REP 103).
struct FloorFrame {
  Vec3 forward;  // unit vectors of the floor frame, in the left camera frame
  Vec3 left;
  Vec3 up;
  float camera_height_m = 0;

  [[nodiscard]] Vec3 to_floor(Vec3 in_camera_m) const;
  [[nodiscard]] Vec3 to_camera(Vec3 in_floor_m) const;
  /// Pitch of the camera: positive looks down.
  [[nodiscard]] float pitch_rad() const;
  /// Roll of the camera: positive lowers its right side.
  [[nodiscard]] float roll_rad() const;
  /// The transform of homogeneous points from the camera frame to the floor frame, row-major.
  [[nodiscard]] std::array<float, 16> floor_from_camera() const;
};

/// nullopt for a plane that cannot be a floor below the camera: through the camera, or above it.
std::optional<FloorFrame> floor_frame(const GroundPlane& ground, const StereoRig& rig);
/// The same; nullopt also without ground or rig.
std::optional<FloorFrame> floor_frame(const Ground& ground, const std::optional<StereoRig>& rig);

}  // namespace cairn
