// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/reject.hpp>

/// The kernels of reject_flat(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct FlatnessKernels {
  /// Reject::flat where (mean − cost) / mean is below `threshold`, or the mean not above 0.
  void (*compare_with_mean)(const float* cost, const float* mean, int width, float threshold,
                            Reject* verdict);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const FlatnessKernels* flatness_kernels(Target target);
/// The functions for the active target of `exec`.
const FlatnessKernels& flatness_kernels(const Exec& exec);

}  // namespace cairn::kernels
