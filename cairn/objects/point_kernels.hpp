// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>

/// The seam to the instruction sets: what locate() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct PointKernels {
  /// rig.point_in_camera_m() of the pixels first … last − 1 of row y, one array per axis, of which the same
  /// pixels are written; NaN where there is no disparity, and at infinity and beyond.
  void (*points_in_camera)(const StereoRig& rig, int y, int first, int last, const float* disparity_px,
                           float* x_m, float* y_m, float* z_m);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const PointKernels* point_kernels(Target target);
/// Those for the target that `exec` gets.
const PointKernels& point_kernels(const Exec& exec);

}  // namespace cairn::kernels
