// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/landmark_geometry.hpp>

#include <Eigen/Eigenvalues>
#include <limits>

namespace cairn::landmarks {
namespace {

template <int N>
using Rows = Eigen::Matrix<double, N, N, Eigen::RowMajor>;

template <int N>
std::array<double, static_cast<std::size_t>(N) * N> values_of(const Rows<N>& m) {
  std::array<double, static_cast<std::size_t>(N) * N> rows{};
  Eigen::Map<Rows<N>>(rows.data()) = m;
  return rows;
}

}  // namespace

Matrix3 matrix(const Covariance3& rows) {
  return Eigen::Map<const Matrix3>(rows.data());
}
Matrix4 matrix(const std::array<double, 16>& rows) {
  return Eigen::Map<const Matrix4>(rows.data());
}
Matrix6 matrix(const Covariance6& rows) {
  return Eigen::Map<const Matrix6>(rows.data());
}
Covariance3 rows_of(const Matrix3& m) {
  return values_of<3>(m);
}
std::array<double, 16> rows_of(const Matrix4& m) {
  return values_of<4>(m);
}

double squared_distance(const Eigen::Vector3d& difference, const Matrix3& covariance) {
  return difference.dot(covariance.ldlt().solve(difference));
}

Matrix4 position_and_yaw(const Covariance6& covariance) {
  return matrix(covariance)(kPositionAndYaw, kPositionAndYaw);
}

template <class Matrix>
Matrix with_clamped_eigenvalues(const Matrix& symmetric, double least) {
  const Eigen::SelfAdjointEigenSolver<Matrix> parts(symmetric);
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(least).asDiagonal() *
         parts.eigenvectors().transpose();
}
template Matrix4 with_clamped_eigenvalues(const Matrix4& symmetric, double least);
template Matrix6 with_clamped_eigenvalues(const Matrix6& symmetric, double least);

Matrix4 carried(const Matrix4& covariance, Point3 way_m) {
  Matrix4 lever = Matrix4::Identity();
  lever(0, 3) = -way_m.y;
  lever(1, 3) = way_m.x;
  return lever * covariance * lever.transpose();
}

Pose turned(double yaw, Point3 translation) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {{c, -s, 0, s, c, 0, 0, 0, 1}, translation};
}

Placement place(const Candidate& candidate, const MapLocation& located) {
  const Eigen::Vector3d p = vector(located.map_from_odom(candidate.position_m));
  const Eigen::Vector3d camera = vector(located.map_from_odom(located.camera_in_odom_m));
  Eigen::Matrix<double, 3, 4> j = Eigen::Matrix<double, 3, 4>::Zero();
  j.leftCols<3>().setIdentity();
  j(0, 3) = -(p.y() - camera.y());
  j(1, 3) = p.x() - camera.x();
  return {p, matrix(rotated(located.map_from_odom, candidate.covariance_m2)) +
                 j * matrix(located.covariance) * j.transpose()};
}

MapLocation corrected(const MapLocation& located, const std::vector<Pull>& pulls) {
  constexpr int kIterations = 6;
  constexpr double kHuber = 2;
  const Eigen::Vector3d camera = vector(located.map_from_odom(located.camera_in_odom_m));
  // Keeps the covariance of an exactly known pose invertible.
  const Matrix4 prior = (matrix(located.covariance) + 1e-9 * Matrix4::Identity()).inverse();
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  Matrix4 normal = prior;
  for (int i = 0; i < kIterations; ++i) {
    normal = prior;
    Eigen::Vector4d right = -prior * x;
    for (const Pull& pull : pulls) {
      const Eigen::Vector3d arm =
          Eigen::AngleAxisd(x[3], Eigen::Vector3d::UnitZ()) * (pull.seen.position_m - camera);
      const Eigen::Vector3d residual = pull.known.position_m - (camera + arm + x.head<3>());
      Eigen::Matrix<double, 3, 4> j = Eigen::Matrix<double, 3, 4>::Zero();
      j.leftCols<3>().setIdentity();
      j(0, 3) = -arm.y();
      j(1, 3) = arm.x();
      const Matrix3 information = (pull.seen.covariance_m2 + pull.known.covariance_m2).inverse();
      const double distance = std::sqrt(residual.dot(information * residual));
      const double weight = distance > kHuber ? kHuber / distance : 1.0;
      normal += weight * j.transpose() * information * j;
      right += weight * j.transpose() * information * residual;
    }
    const Eigen::Vector4d step = normal.ldlt().solve(right);
    x += step;
    if (step.norm() < 1e-9) break;
  }
  Pose turn = turned(x[3], {});
  turn.translation_m = point(camera + x.head<3>()) - turn.rotated(point(camera));
  return {turn * located.map_from_odom, rows_of(Matrix4(normal.inverse())), located.camera_in_odom_m};
}

int floor_frames_at(const LandmarkMap& map, FloorCell wanted) {
  const auto at = std::lower_bound(map.floor.begin(), map.floor.end(), wanted, is_before);
  return at != map.floor.end() && at->x == wanted.x && at->y == wanted.y ? at->frames : 0;
}

void add_floor(LandmarkMap& map, const std::vector<FloorCell>& cells) {
  std::vector<FloorCell> fresh;
  for (const FloorCell& cell : cells) {
    const auto at = std::lower_bound(map.floor.begin(), map.floor.end(), cell, is_before);
    if (at != map.floor.end() && at->x == cell.x && at->y == cell.y) {
      at->frames += std::min(cell.frames, std::numeric_limits<int>::max() - at->frames);
    } else {
      fresh.push_back(cell);
    }
  }
  if (fresh.empty()) return;
  const auto middle = static_cast<std::ptrdiff_t>(map.floor.size());
  map.floor.insert(map.floor.end(), fresh.begin(), fresh.end());
  std::inplace_merge(map.floor.begin(), map.floor.begin() + middle, map.floor.end(), is_before);
}

Candidate candidate_of(const Landmark& landmark, const ColourHistogram& colours) {
  return {TrackId{number(landmark.id)}, landmark.position_m,
          landmark.covariance_m2,       landmark.size,
          landmark.height_over_floor_m, colours};
}

LandmarkLook& look_from(Landmark& landmark, int octant) {
  auto at = std::lower_bound(landmark.looks.begin(), landmark.looks.end(), octant,
                             [](const LandmarkLook& look, int wanted) { return look.octant < wanted; });
  if (at == landmark.looks.end() || at->octant != octant)
    at = landmark.looks.insert(at, {octant, {}, -1, {}, 0});
  return *at;
}

}  // namespace cairn::landmarks
