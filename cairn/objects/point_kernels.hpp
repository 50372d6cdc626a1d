// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>

/// The kernels of locate(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct PointKernels {
  /// rig.point_in_camera_m() for the pixels first … last − 1 of row y, one output array per axis, indexed
  /// alike; NaN in holes, and at or beyond infinity.
  void (*points_in_camera)(const StereoRig& rig, int y, int first, int last, const float* disparity_px,
                           float* x_m, float* y_m, float* z_m);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const PointKernels* point_kernels(Target target);
/// The functions for the active target of `exec`.
const PointKernels& point_kernels(const Exec& exec);

}  // namespace cairn::kernels
