// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/first_pose.hpp>

#include <cairn/scene/floor_frame.hpp>
#include <cmath>

namespace cairn {
namespace {

Point3 point(Vec3 v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}

/// Pose of a level camera that looks along the map's x axis.
Pose level_pose() {
  return {{0, 0, 1, -1, 0, 0, 0, -1, 0}, {}};
}

/// Rotation about the vertical.
Pose heading_of(const Pose& map_from_camera) {
  const Point3 ahead = map_from_camera.rotated({0, 0, 1});
  return rotation_about({0, 0, std::atan2(ahead.y, ahead.x)});
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

std::optional<Pose> levelled(const Pose& map_from_camera, const Ground& ground,
                             const std::optional<StereoRig>& rig) {
  if (!floor_frame(ground, rig)) return std::nullopt;
  Pose level = heading_of(map_from_camera) * first_pose(ground, rig);
  level.translation_m.x = map_from_camera.translation_m.x;
  level.translation_m.y = map_from_camera.translation_m.y;
  return level;
}

Pose camera_from_level(const Pose& map_from_camera) {
  Pose turned = heading_of(map_from_camera) * level_pose();
  Pose camera_from_map = inverse(map_from_camera);
  camera_from_map.translation_m = {};
  return camera_from_map * turned;
}

}  // namespace cairn
