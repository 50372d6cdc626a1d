// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <Eigen/Dense>
#include <cmath>

#include <cairn/sequence/pose.hpp>

namespace cairn {
namespace {

using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Matrix3 matrix(const std::array<double, 9>& rows) {
  return Eigen::Map<const Matrix3>(rows.data());
}

std::array<double, 9> rows_of(const Matrix3& matrix) {
  std::array<double, 9> rows{};
  Eigen::Map<Matrix3>(rows.data()) = matrix;
  return rows;
}

}  // namespace

double length(Point3 a) {
  return std::sqrt(dot(a, a));
}

Point3 Pose::rotated(Point3 d) const {
  const auto& r = rotation;
  return {r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z,
          r[6] * d.x + r[7] * d.y + r[8] * d.z};
}

Point3 Pose::operator()(Point3 point) const {
  return rotated(point) + translation_m;
}

Pose operator*(const Pose& a, const Pose& b) {
  return {rows_of(matrix(a.rotation) * matrix(b.rotation)), a(b.translation_m)};
}

Pose inverse(const Pose& pose) {
  Pose back{rows_of(matrix(pose.rotation).transpose()), {}};
  back.translation_m = -1.0 * back.rotated(pose.translation_m);
  return back;
}

Covariance3 rotated(const Pose& pose, const Covariance3& covariance) {
  const Matrix3 r = matrix(pose.rotation);
  return rows_of(r * matrix(covariance) * r.transpose());
}

std::array<double, 4> quaternion(const Pose& pose) {
  Eigen::Quaterniond q(matrix(pose.rotation));
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return {q.x(), q.y(), q.z(), q.w()};
}

Pose pose_of(Point3 translation_m, const std::array<double, 4>& quaternion) {
  const Eigen::Quaterniond q =
      Eigen::Quaterniond(quaternion[3], quaternion[0], quaternion[1], quaternion[2]).normalized();
  return {rows_of(q.toRotationMatrix()), translation_m};
}

double angle_of(const Pose& pose) {
  return length(rotation_vector(pose));
}

double yaw_of(const Pose& pose) {
  return std::atan2(pose.rotation[3], pose.rotation[0]);
}

Point3 rotation_vector(const Pose& pose) {
  const Eigen::AngleAxisd turn(matrix(pose.rotation));
  const Eigen::Vector3d v = turn.axis() * turn.angle();
  return {v.x(), v.y(), v.z()};
}

Pose rotation_about(Point3 rotation_vector_rad) {
  const Point3 v = rotation_vector_rad;
  const double angle = length(v);
  if (angle == 0) return {};
  const Eigen::Vector3d axis(v.x / angle, v.y / angle, v.z / angle);
  return {rows_of(Eigen::AngleAxisd(angle, axis).toRotationMatrix()), {}};
}

}  // namespace cairn
