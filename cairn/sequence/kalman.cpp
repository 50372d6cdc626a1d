// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/kalman.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cairn {
namespace {

using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix3 matrix(const std::array<double, 9>& rows) {
  return Eigen::Map<const Matrix3>(rows.data());
}
Matrix6 matrix(const Covariance6& rows) {
  return Eigen::Map<const Matrix6>(rows.data());
}
/// Rounding must not make it unsymmetric over thousands of frames.
Covariance3 covariance(const Matrix3& m) {
  Covariance3 rows{};
  Eigen::Map<Matrix3>(rows.data()) = (m + m.transpose()) / 2;
  return rows;
}
Covariance6 covariance(const Matrix6& m) {
  Covariance6 rows{};
  Eigen::Map<Matrix6>(rows.data()) = (m + m.transpose()) / 2;
  return rows;
}
Vector3 vector(Point3 p) {
  return {p.x, p.y, p.z};
}
Point3 point(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

Filter3 predicted(const Filter3& filter, double dt_s, double static_noise) {
  Filter3 next = filter;
  for (const std::size_t i : {0U, 4U, 8U}) next.covariance_m2.at(i) += static_noise * static_noise * dt_s;
  return next;
}

Filter6 predicted(const Filter6& filter, double dt_s, double acceleration_noise) {
  Matrix6 step = Matrix6::Identity();
  step.topRightCorner<3, 3>() = Matrix3::Identity() * dt_s;
  Eigen::Matrix<double, 6, 3> by_acceleration;
  by_acceleration << Matrix3::Identity() * (dt_s * dt_s / 2), Matrix3::Identity() * dt_s;
  const double square = acceleration_noise * acceleration_noise;
  Filter6 next = filter;
  next.position_m = filter.position_m + dt_s * filter.velocity_m_s;
  next.covariance = covariance(Matrix6(step * matrix(filter.covariance) * step.transpose() +
                                       square * by_acceleration * by_acceleration.transpose()));
  return next;
}

Innovation innovation(Point3 expected_m, const Covariance3& expected_m2, Point3 measured_m,
                      const Covariance3& measured_m2) {
  const Matrix3 measured = matrix(measured_m2);
  const Matrix3 sum = matrix(expected_m2) + measured;
  const Vector3 off = vector(measured_m - expected_m);
  Innovation found;
  found.d2 = off.dot(sum.llt().solve(off));
  const double volume = sum.determinant();
  found.log_widening = std::log(volume / measured.determinant());
  found.log_likelihood = -(found.d2 + std::log(volume) + 3 * std::log(2 * std::numbers::pi)) / 2;
  return found;
}

double log_vagueness(const Covariance3& measured_m2) {
  constexpr double kSharp_m = 0.15;
  return std::max(0.0, std::log(matrix(measured_m2).determinant()) - 6 * std::log(kSharp_m));
}

Covariance3 of_position(const Filter6& filter) {
  return covariance(Matrix3(matrix(filter.covariance).topLeftCorner<3, 3>()));
}

Filter3 updated(const Filter3& filter, Point3 measured_m, const Covariance3& measured_m2) {
  const Matrix3 before = matrix(filter.covariance_m2);
  const Matrix3 gain = (before + matrix(measured_m2)).llt().solve(before).transpose();
  const Matrix3 rest = Matrix3::Identity() - gain;
  // Joseph's form stays positive definite.
  return {
      point(vector(filter.position_m) + gain * vector(measured_m - filter.position_m)),
      covariance(Matrix3(rest * before * rest.transpose() + gain * matrix(measured_m2) * gain.transpose()))};
}

Filter6 updated(const Filter6& filter, Point3 measured_m, const Covariance3& measured_m2) {
  const Matrix6 before = matrix(filter.covariance);
  const Matrix3 noise = matrix(measured_m2);
  const Matrix3 sum = before.topLeftCorner<3, 3>() + noise;
  const Eigen::Matrix<double, 6, 3> gain = sum.llt().solve(before.topRows<3>()).transpose();
  Vector6 state;
  state << vector(filter.position_m), vector(filter.velocity_m_s);
  state += gain * vector(measured_m - filter.position_m);
  Matrix6 rest = Matrix6::Identity();
  rest.leftCols<3>() -= gain;
  return {point(state.head<3>()), point(state.tail<3>()),
          covariance(Matrix6(rest * before * rest.transpose() + gain * noise * gain.transpose()))};
}

Covariance3 in_map(const Covariance3& in_camera_m2, Point3 point_in_camera_m, const Pose& map_from_camera,
                   const Covariance6& pose_covariance) {
  const Point3 arm = map_from_camera.rotated(point_in_camera_m);
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << 1, 0, 0, 0, arm.z, -arm.y,  //
      0, 1, 0, -arm.z, 0, arm.x,          //
      0, 0, 1, arm.y, -arm.x, 0;
  return covariance(Matrix3(matrix(rotated(map_from_camera, in_camera_m2)) +
                            jacobian * matrix(pose_covariance) * jacobian.transpose()));
}

Filter3 moved_viewpoint(Filter3 filter, Vec3 extent_m, Point3 seen_from_m, Point3 camera_m) {
  const Vector3 before = vector(seen_from_m - filter.position_m);
  const Vector3 now = vector(camera_m - filter.position_m);
  if (!(before.norm() > 0 && now.norm() > 0)) return filter;
  const Vector3 turn = now.normalized() - before.normalized();
  const double width_m = extent_m.x;
  filter.position_m = filter.position_m + nearer_surface::kShare * width_m * Point3{turn.x(), turn.y(), 0};
  const double sigma_m = nearer_surface::kSigma * (width_m + double{extent_m.y}) / 2 * turn.norm();
  for (const std::size_t i : {0U, 4U, 8U}) filter.covariance_m2.at(i) += sigma_m * sigma_m;
  return filter;
}

Drift drift_of(const std::vector<Place>& places) {
  const auto count = static_cast<double>(places.size());
  double mean_s = 0;
  Vector3 mean = Vector3::Zero();
  Matrix3 noise = Matrix3::Zero();
  for (const Place& place : places) {
    mean_s += seconds_between(places.front().stamp, place.stamp) / count;
    mean += vector(place.position_m) / count;
    noise += matrix(place.covariance_m2) / count;
  }
  double spread_s2 = 0;
  Vector3 along = Vector3::Zero();
  for (const Place& place : places) {
    const double t = seconds_between(places.front().stamp, place.stamp) - mean_s;
    spread_s2 += t * t;
    along += t * (vector(place.position_m) - mean);
  }
  const Vector3 velocity = along / spread_s2;
  const Vector3 direction = velocity.norm() > 0 ? Vector3(velocity.normalized()) : Vector3::UnitX();
  return {point(velocity), std::sqrt(direction.dot(noise * direction) / spread_s2)};
}

}  // namespace cairn
