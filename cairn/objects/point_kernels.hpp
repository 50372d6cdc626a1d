// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/floor_frame.hpp>

/// The kernels of locate(), per pixel of a row or point of a list; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

/// The coordinates of points, one array per axis.
struct PointLists {
  float* x;
  float* y;
  float* z;
};

/// Rectangles at several yaws, processed in one pass over the points: a single sum would wait for each of its
/// additions.
struct TurnedRectangles {
  static constexpr std::size_t kCount = 16;
  static constexpr std::size_t kMaxTail = 6;
  template <class T>
  using Each = std::array<T, kCount>;
  Each<float> cosine{};  // of the yaw
  Each<float> sine{};
  std::array<Each<float>, 2> low{};  // the sides: along the turned x and y
  std::array<Each<float>, 2> high{};
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct PointKernels {
  /// rig.point_in_camera_m() for `count` pixels from `first` to the right; NaN in holes, and at or beyond infinity.
  /// Returns the number of points whose coordinates are all within ±farthest_m.
  int (*points_in_camera)(const StereoRig& rig, Point first, int count, const float* disparity_px,
                          float farthest_m, const PointLists& out);
  /// floor.to_floor() for points in the camera's frame.
  void (*points_in_floor)(const FloorFrame& floor, const PointLists& in_camera, int count,
                          const PointLists& out);
  /// The coordinates along axes turned by a yaw.
  void (*turn)(const float* xs, const float* ys, int count, float cosine, float sine, float* turned_xs,
               float* turned_ys);
  /// Moves the low sides of each rectangle to the value at rank `low_tail` of the points' turned coordinates, and the
  /// high ones to that at rank `high_tail` from the top; rank 0 = the last one. Both < kMaxTail, and there are more
  /// points than that.
  void (*find_sides)(const float* xs, const float* ys, int count, std::size_t low_tail, std::size_t high_tail,
                     TurnedRectangles& rectangles);
  /// For each rectangle, the sum of the distances of the points from the nearest side, in the order of the points.
  void (*sum_distances)(const float* xs, const float* ys, int count, const TurnedRectangles& rectangles,
                        TurnedRectangles::Each<double>& sums);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const PointKernels* point_kernels(Target target);
/// The functions for the active target of `exec`.
const PointKernels& point_kernels(const Exec& exec);

}  // namespace cairn::kernels
