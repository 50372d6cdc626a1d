// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/disparity/reject.hpp>

/// The seam to the instruction sets: what reject_flat() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct FlatnessKernels {
  /// Reject::flat where (mean − cost) / mean is below `threshold`, or the mean not above 0.
  void (*compare_with_mean)(const float* cost, const float* mean, int width, float threshold,
                            Reject* verdict);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const FlatnessKernels* flatness_kernels(Target target);
/// Those for the target that `exec` gets.
const FlatnessKernels& flatness_kernels(const Exec& exec);

}  // namespace cairn::kernels
