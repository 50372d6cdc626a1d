// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/geometry.hpp>
#include <cairn/core/image.hpp>
#include <cairn/sequence/pose.hpp>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

/// A checkerboard in front of a wall, above a floor, seen by two raw cameras with lens distortion: rendered,
/// so that estimates can be compared with the truth.
namespace cairn::support {

/// A rigid motion: rotation (row-major), then translation; a Pose without the library of sequences.
struct Motion {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Point3 translation_m;

  [[nodiscard]] Point3 rotated(Point3 p) const {
    const auto& r = rotation;
    return {r[0] * p.x + r[1] * p.y + r[2] * p.z, r[3] * p.x + r[4] * p.y + r[5] * p.z,
            r[6] * p.x + r[7] * p.y + r[8] * p.z};
  }
  Point3 operator()(Point3 p) const { return rotated(p) + translation_m; }
};
inline Motion inverse(const Motion& motion) {
  const auto& r = motion.rotation;
  Motion back{{r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, {}};
  back.translation_m = -1.0 * back.rotated(motion.translation_m);
  return back;
}
/// Rotation about an axis by its length in rad (Rodrigues).
inline Motion rotation_about(Point3 axis) {
  const double angle = std::hypot(axis.x, axis.y, axis.z);
  const double x = axis.x / angle;
  const double y = axis.y / angle;
  const double z = axis.z / angle;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double k = 1 - c;
  return {{c + k * x * x, k * x * y - s * z, k * x * z + s * y, k * x * y + s * z, c + k * y * y,
           k * y * z - s * x, k * x * z - s * y, k * y * z + s * x, c + k * z * z},
          {}};
}

inline constexpr Size kRawSize{640, 480};
inline constexpr double kRawFocal = 530;  // px; the principal point is 4 px right of the middle, 3 px below
inline constexpr double kRawBaseline = 0.083;  // m
inline constexpr int kBoardColumns = 9;        // inner corners
inline constexpr int kBoardRows = 6;
inline constexpr double kBoardSquare = 0.025;  // m

/// The right camera in the left one's frame: slightly raised, tilted and rolled, as by careless mounting.
inline Motion right_from_left() {
  Motion pose = rotation_about({0.022, 0.004, 0.012});
  pose.translation_m = {-kRawBaseline, 0.001, 0.0015};
  return pose;
}

/// Poses of the board's centre in the left camera's frame.
inline Motion board_in_left(int place) {
  Motion pose = rotation_about(
      {0.45 * std::sin(2.1 * place), 0.5 * std::cos(1.3 * place), 0.3 * std::sin(0.7 * place)});
  pose.translation_m = {0.07 * std::sin(1.7 * place) + 0.03, 0.05 * std::cos(2.3 * place),
                        0.52 + 0.03 * (place % 4)};
  return pose;
}

namespace drawing {

/// Projection through a lens with k1 = −0.27, k2 = 0.09, p1 = 0.001, p2 = −0.0005.
inline std::array<double, 2> distorted(double x, double y) {
  constexpr double k1 = -0.27;
  constexpr double k2 = 0.09;
  constexpr double p1 = 0.001;
  constexpr double p2 = -0.0005;
  const double r2 = x * x + y * y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2;
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

inline std::array<double, 2> undistorted(double x, double y) {
  std::array<double, 2> guess{x, y};
  for (int i = 0; i < 12; ++i) {
    const auto seen = distorted(guess[0], guess[1]);
    guess = {guess[0] + x - seen[0], guess[1] + y - seen[1]};
  }
  return guess;
}

inline double hash(int x, int y) {
  auto n = static_cast<std::uint32_t>(x) * 374761393U + static_cast<std::uint32_t>(y) * 668265263U;
  n = (n ^ (n >> 13)) * 1274126177U;
  return static_cast<double>((n ^ (n >> 16)) & 0xFFU) / 255;
}

/// Noise with patches of 2 cm.
inline double wall(double u, double v) {
  constexpr double kBlotch = 0.02;
  const double x = u / kBlotch;
  const double y = v / kBlotch;
  const int left = static_cast<int>(std::floor(x));
  const int top = static_cast<int>(std::floor(y));
  const double a = x - left;
  const double b = y - top;
  return 40 + 170 * ((1 - b) * ((1 - a) * hash(left, top) + a * hash(left + 1, top)) +
                     b * ((1 - a) * hash(left, top + 1) + a * hash(left + 1, top + 1)));
}

/// The surface hit by a ray of the left camera's frame: the board, its white margin, the floor, or the wall
/// 1.6 m away.
inline double grey_of(Point3 from, Point3 ray, const Motion& board) {
  const Motion to_board = inverse(board);
  const Point3 start = to_board(from);
  const Point3 along = to_board.rotated(ray);
  const double steps = -start.z / along.z;
  const double u = (start.x + steps * along.x) / kBoardSquare + (kBoardColumns + 1) / 2.0;
  const double v = (start.y + steps * along.y) / kBoardSquare + (kBoardRows + 1) / 2.0;
  if (u > -1 && v > -1 && u < kBoardColumns + 2 && v < kBoardRows + 2) {
    const bool is_margin = u < 0 || v < 0 || u >= kBoardColumns + 1 || v >= kBoardRows + 1;
    const int square = static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v));
    return is_margin || square % 2 != 0 ? 225 : 25;
  }
  constexpr double kWall = 1.6;
  constexpr double kFloor = 0.3;
  const double far = (kWall - from.z) / ray.z;
  if (from.y + far * ray.y > kFloor) {
    const double near = (kFloor - from.y) / ray.y;
    return wall(from.x + near * ray.x, from.z + near * ray.z);
  }
  return wall(from.x + far * ray.x, from.y + far * ray.y);
}

/// Four rays per pixel, in the camera's frame.
inline const std::vector<Point3>& rays() {
  static const std::vector<Point3> all = [] {
    std::vector<Point3> rays;
    for (int y = 0; y < kRawSize.height; ++y) {
      for (int x = 0; x < kRawSize.width; ++x) {
        for (int k = 0; k < 4; ++k) {
          const double u = x - 0.25 + 0.5 * (k % 2) - ((kRawSize.width - 1) / 2.0 + 4);
          const double v = y - 0.25 + 0.5 * (k / 2) - ((kRawSize.height - 1) / 2.0 + 3);
          const auto at = undistorted(u / kRawFocal, v / kRawFocal);
          rays.push_back({at[0], at[1], 1});
        }
      }
    }
    return rays;
  }();
  return all;
}

inline Image<Gray> seen_from(const Motion& left_from_camera, const Motion& board) {
  Image<Gray> image(kRawSize);
  std::size_t at = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0;
      for (int k = 0; k < 4; ++k)
        sum += grey_of(left_from_camera.translation_m, left_from_camera.rotated(rays()[at++]), board);
      image(x, y) = static_cast<Gray>(std::lround(sum / 4));
    }
  }
  return image;
}

}  // namespace drawing

/// The pair with the board in pose `place`.
inline std::pair<Image<Gray>, Image<Gray>> drawn_board(int place) {
  const Motion board = board_in_left(place);
  return {drawing::seen_from({}, board), drawing::seen_from(inverse(right_from_left()), board)};
}

}  // namespace cairn::support
