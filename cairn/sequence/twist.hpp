// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <Eigen/Dense>

#include <cairn/sequence/pose.hpp>

/// Small motions as vectors; internal to tracking.
namespace cairn {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The cross product matrix: skew(v)·w = v × w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// ξ with `to` = exp(ξ) · `from`: translation, then rotation, to first order.
inline Vector6 difference(const Pose& to, const Pose& from) {
  const Pose off = to * inverse(from);
  const Point3 turn = rotation_vector(off);
  Vector6 xi;
  xi << off.translation_m.x, off.translation_m.y, off.translation_m.z, turn.x, turn.y, turn.z;
  return xi;
}

}  // namespace cairn
