// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cairn/stereo/reject.hpp>
#include <cstdint>

/// The kernels of reject_below_ground() and label_floor(), per pixel of a row; one set per instruction set.
/// Private to the library.
namespace cairn::kernels {

/// The floor along a row.
struct FloorRow {
  GroundPlane plane;
  float infinity;  // a point at infinity has disparity −infinity
  float margin;
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct FloorKernels {
  /// The disparities of row `y` that are below the floor; NaN elsewhere. The same minus the floor's disparity; NaN also
  /// where it is at least twice as far away as the floor.
  void (*find_below)(const FloorRow& floor, int y, int width, const float* disparity_px, float* below_px,
                     float* little_below_px);
  /// Rejects the marked disparities of a row as below the ground, but for those of level surfaces (NaN elsewhere).
  void (*reject_marked)(const Reject* marks, const float* level_px, int width, float* disparity_px,
                        Reject* reject);
  /// label_floor() for the pixels of row `y`.
  void (*label_floor)(const FloorRow& floor, int y, int width, const float* disparity_px,
                      std::uint8_t* label);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const FloorKernels* floor_kernels(Target target);
/// The functions for the active target of `exec`.
const FloorKernels& floor_kernels(const Exec& exec);

}  // namespace cairn::kernels
