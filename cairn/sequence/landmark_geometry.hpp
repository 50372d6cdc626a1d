// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include <cairn/sequence/landmarks.hpp>

/// Shared by the sources of this library; not installed.
namespace cairn::landmarks {

using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

// Functions of Eigen's are defined in one source: to compile them takes seconds in each.
Matrix3 matrix(const Covariance3& rows);
Matrix4 matrix(const std::array<double, 16>& rows);
Matrix6 matrix(const Covariance6& rows);
inline Eigen::Vector3d vector(Point3 p) {
  return {p.x, p.y, p.z};
}
inline Point3 point(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Covariance3 rows_of(const Matrix3& m);
std::array<double, 16> rows_of(const Matrix4& m);

/// The squared Mahalanobis distance.
double squared_distance(const Eigen::Vector3d& difference, const Matrix3& covariance);

/// A rotation about z by `yaw_rad`, then a translation.
Pose turned(double yaw_rad, Point3 translation_m);

/// Rows and columns of x, y, z and yaw in a Covariance6.
inline constexpr std::array<Eigen::Index, 4> kPositionAndYaw{0, 1, 2, 5};
Matrix4 position_and_yaw(const Covariance6& covariance);

/// The symmetric matrix, a Matrix4 or Matrix6, with eigenvalues below `least` raised to it.
template <class Matrix>
Matrix with_clamped_eigenvalues(const Matrix& symmetric, double least);

/// Covariance of a camera's x, y, z and yaw after it moved by `way_m`: the uncertainty of the heading shifts it.
Matrix4 carried(const Matrix4& covariance, Point3 way_m);

/// A position in the map of something in the odometry frame: uncertain by itself and by the pose of that
/// frame.
struct Placement {
  Eigen::Vector3d position_m;
  Matrix3 covariance_m2;
};
Placement place(const Candidate& candidate, const MapLocation& located);

/// One landmark and its observed position, both in the map.
struct Pull {
  Placement seen;
  Placement known;
};
/// `located` rotated about the camera and translated so that observed positions match the known ones as well
/// as their covariances demand; a rotation about z and a translation. (Gauss-Newton, Huber weights)
MapLocation corrected(const MapLocation& located, const std::vector<Pull>& pulls);

/// The look from an octant; a new one, with -1 pixels, if there is none.
LandmarkLook& look_from(Landmark& landmark, int octant);

/// Frames that show a cell of the floor before it counts as free.
inline constexpr int kFloorFrames = 10;
/// Cells farther away, which only a damaged file has, count as unknown.
inline constexpr int kFarthestCell = 1'000'000'000;
/// The cell of the floor below a point, with no frames.
inline FloorCell cell_at(Point3 in_map) {
  const auto index = [](double at_m) {
    const double most = kFarthestCell;
    return static_cast<int>(std::floor(std::clamp(at_m / kFloorCell_m, -most, most)));
  };
  return {index(in_map.x), index(in_map.y), 0};
}
/// The order of LandmarkMap::floor.
inline bool is_before(FloorCell a, FloorCell b) {
  return std::tie(a.x, a.y) < std::tie(b.x, b.y);
}
/// The frames in which the floor was seen there.
int floor_frames_at(const LandmarkMap& map, FloorCell wanted);

/// Adds what was seen of the floor: different cells, by x, then y.
void add_floor(LandmarkMap& map, const std::vector<FloorCell>& cells);

/// The landmark as a candidate for recognition.
Candidate candidate_of(const Landmark& landmark, const ColourHistogram& colours);

}  // namespace cairn::landmarks
