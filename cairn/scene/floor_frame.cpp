// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/scene/floor_frame.hpp>
#include <cmath>

namespace cairn {
namespace {

double dot(Vec3 p, Vec3 q) {
  return double{p.x} * q.x + double{p.y} * q.y + double{p.z} * q.z;
}
Vec3 cross(Vec3 p, Vec3 q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
Vec3 scaled(Vec3 v, double by) {
  return {static_cast<float>(v.x * by), static_cast<float>(v.y * by), static_cast<float>(v.z * by)};
}
Vec3 sum(Vec3 p, Vec3 q) {
  return {p.x + q.x, p.y + q.y, p.z + q.z};
}
/// The component of `v` perpendicular to the unit vector `axis`, normalised.
Vec3 square_to(Vec3 axis, Vec3 v) {
  const Vec3 rest = sum(v, scaled(axis, -dot(axis, v)));
  return scaled(rest, 1 / std::sqrt(dot(rest, rest)));
}

}  // namespace

Vec3 FloorFrame::to_floor(Vec3 in_camera_m) const {
  return {static_cast<float>(dot(forward, in_camera_m)), static_cast<float>(dot(left, in_camera_m)),
          static_cast<float>(dot(up, in_camera_m) + double{camera_height_m})};
}

Vec3 FloorFrame::to_camera(Vec3 in_floor_m) const {
  return sum(sum(scaled(forward, in_floor_m.x), scaled(left, in_floor_m.y)),
             scaled(up, double{in_floor_m.z} - camera_height_m));
}

float FloorFrame::pitch_rad() const {
  return std::asin(-up.z);
}

float FloorFrame::roll_rad() const {
  return std::atan2(-up.x, -up.y);
}

std::array<float, 16> FloorFrame::floor_from_camera() const {
  return {forward.x, forward.y, forward.z,       0, left.x, left.y, left.z, 0, up.x,
          up.y,      up.z,      camera_height_m, 0, 0,      0,      1};
}

std::optional<FloorFrame> floor_frame(const GroundPlane& ground, const StereoRig& rig) {
  // A floor point X has n·X = height for the direction n of gravity. With d + doffs = focal·baseline / Z that
  // is d + doffs = baseline/height · (n_x·(x − cx) + n_y·(y − cy) + n_z·focal): see fit_ground(), source
  // pose.
  const Vec3 down{ground.a, ground.b,
                  (ground.disparity_px(rig.cx_px, rig.cy_px) + rig.doffs_px) / rig.focal_px};
  const double length = std::sqrt(dot(down, down));
  const double height = double{rig.baseline_m} / length;
  if (!(down.y > 0) || !std::isfinite(height)) return std::nullopt;
  FloorFrame frame;
  frame.camera_height_m = static_cast<float>(height);
  frame.up = scaled(down, -1 / length);
  // For a camera that looks straight down, up in the image is forward.
  constexpr float kStraightDown = 0.999F;
  frame.forward = square_to(frame.up, std::abs(frame.up.z) < kStraightDown ? Vec3{0, 0, 1} : Vec3{0, -1, 0});
  frame.left = cross(frame.up, frame.forward);
  return frame;
}

std::optional<FloorFrame> floor_frame(const Ground& ground, const std::optional<StereoRig>& rig) {
  return ground.plane && rig ? floor_frame(*ground.plane, *rig) : std::nullopt;
}

}  // namespace cairn
