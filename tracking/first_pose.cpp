// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "first_pose.hpp"

#include <cairn/scene/floor_frame.hpp>
#include <cmath>

namespace cairn {
namespace {

Point3 point(Vec3 v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}

/// map_from_camera of a camera that looks level along the map's x.
Pose level_pose() {
  return {{0, 0, 1, -1, 0, 0, 0, -1, 0}, {}};
}

}  // namespace

Pose first_pose(const Ground& ground, const std::optional<StereoRig>& rig) {
  const auto floor = floor_frame(ground, rig);
  if (!floor) return level_pose();
  const Point3 x = point(floor->forward);
  const Point3 y = point(floor->left);
  const Point3 z = point(floor->up);
  return {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}, {0, 0, double{floor->camera_height_m}}};
}

Pose camera_from_level(const Pose& map_from_camera) {
  const Point3 ahead = map_from_camera.rotated({0, 0, 1});
  const double heading = std::atan2(ahead.y, ahead.x);
  Pose turned = rotation_about({0, 0, heading}) * level_pose();
  Pose camera_from_map = inverse(map_from_camera);
  camera_from_map.translation_m = {};
  return camera_from_map * turned;
}

}  // namespace cairn
