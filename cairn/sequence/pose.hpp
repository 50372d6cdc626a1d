// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string>

namespace cairn {

/// The time of a frame, in nanoseconds since the epoch of its source.
struct Stamp {
  std::int64_t ns = 0;
  friend constexpr auto operator<=>(Stamp, Stamp) = default;  // NOLINT(modernize-use-nullptr): its 0 is none
};
/// The time from the earlier to the later stamp, in s.
constexpr double seconds_between(Stamp earlier, Stamp later) {
  return static_cast<double>(later.ns - earlier.ns) * 1e-9;
}

/// "1700000000.123456789": in s with all nine digits, exact, as in trajectory files.
std::string seconds_text(Stamp stamp);

/// A position or direction in double precision; the name of the variable states unit and frame.
struct Point3 {
  double x = 0;
  double y = 0;
  double z = 0;
  friend constexpr bool operator==(Point3, Point3) = default;
  friend constexpr Point3 operator+(Point3 a, Point3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Point3 operator-(Point3 a, Point3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Point3 operator*(double s, Point3 a) { return {s * a.x, s * a.y, s * a.z}; }
};
constexpr double dot(Point3 a, Point3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double length(Point3 a);

/// Row-major: covariance of a position in m², symmetric.
using Covariance3 = std::array<double, 9>;
/// Row-major: covariance of a rigid motion, translation (m) before rotation (rad), symmetric.
using Covariance6 = std::array<double, 36>;

/// A rigid motion, named for the frames that it relates: `map_from_camera` maps points of the camera frame to
/// the map frame.
struct Pose {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major, orthonormal
  Point3 translation_m;

  /// The point in the other frame.
  [[nodiscard]] Point3 operator()(Point3 point) const;
  /// The direction in the other frame.
  [[nodiscard]] Point3 rotated(Point3 direction) const;
};
/// First b, then a: (a * b)(p) = a(b(p)).
Pose operator*(const Pose& a, const Pose& b);
Pose inverse(const Pose& pose);
/// R·C·Rᵀ: a covariance of positions in the target frame of the pose.
Covariance3 rotated(const Pose& pose, const Covariance3& covariance);

/// The rotation as a unit quaternion x, y, z, w with w ≥ 0, as in trajectory files.
std::array<double, 4> quaternion(const Pose& pose);
/// The pose of a translation and a quaternion of any length but 0 (x, y, z, w).
Pose pose_of(Point3 translation_m, const std::array<double, 4>& quaternion);
/// The angle of the rotation, in rad, 0 … π.
double angle_of(const Pose& pose);
/// The rotation about z of a pose on a floor, counter-clockwise, in rad.
double yaw_of(const Pose& pose);
/// The axis of the rotation times its angle, in rad.
Point3 rotation_vector(const Pose& pose);
/// The rotation about an axis by its length in rad, without a translation.
Pose rotation_about(Point3 rotation_vector_rad);

}  // namespace cairn
