// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cstdint>

/// The kernels of the plane searches, per point of a sample and per pixel of a row; one set per instruction
/// set. Private to the library.
namespace cairn::kernels {

/// Points, one array per coordinate.
struct PointArrays {
  const float* x;
  const float* y;
  const float* d;
  const float* behind;  // the background's disparity there
  int count;
};

/// Sums over the points on a plane.
struct PlaneSums {
  std::uint64_t count = 0;
  std::uint64_t x = 0;
  std::uint64_t y = 0;
  std::uint64_t xx = 0;
  std::uint64_t xy = 0;
  std::uint64_t yy = 0;
};

/// Numbers of points by their distance to a plane, among those below its horizon.
struct PlaneCounts {
  int all = 0;
  int on = 0;     // within the tolerance
  int near = 0;   // within twice the tolerance
  int below = 0;  // below the plane by more than that
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct PlaneKernels {
  /// Number of points closer to the plane than `tolerance`.
  int (*count_on)(const PointArrays& points, const GroundPlane& plane, float tolerance);
  /// Number of points more than `tolerance` behind the plane and the background.
  int (*count_beyond)(const PointArrays& points, const GroundPlane& plane, float tolerance);
  /// Number of points closer to the plane than `tolerance` where it is in front of the background.
  int (*count_on_before)(const PointArrays& points, const GroundPlane& plane, float tolerance);
  /// Sums over the points closer to the plane than `tolerance`; x and y are integers. d_on[i] = the disparity
  /// of such a point, else 0.
  PlaneSums (*sum_on)(const PointArrays& points, const GroundPlane& plane, float tolerance, float* d_on);
  /// behind[i] = max(behind[i], the plane's disparity at point i).
  void (*put_behind)(const PointArrays& points, const GroundPlane& plane, float* behind);
  /// marks[i] = 1 if the distance of the point above the plane is in least … most, px of disparity; else 0.
  void (*mark_between)(const PointArrays& points, const GroundPlane& plane, float least, float most,
                       std::uint8_t* marks);
  /// A point at infinity has the disparity −infinity. Ignores `points.behind`.
  PlaneCounts (*count_about)(const PointArrays& points, const GroundPlane& plane, float infinity,
                             float tolerance);
  /// Numbers of pixels of row `y` below the horizon of a plane: `all` with a disparity, and `on`. A point at
  /// infinity has the disparity −infinity.
  PlaneCounts (*count_support)(const float* disparity_px, int y, int width, const GroundPlane& plane,
                               float infinity, float tolerance);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const PlaneKernels* plane_kernels(Target target);
/// The functions for the active target of `exec`.
const PlaneKernels& plane_kernels(const Exec& exec);

}  // namespace cairn::kernels
