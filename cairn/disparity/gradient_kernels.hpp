// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The seam to the instruction sets: what quantised() and the gradient() of disparities do for each pixel of
/// a row. Private to the library.
namespace cairn::kernels {

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct DisparityGradientKernels {
  /// See gradient() in disparity/gradient.hpp.
  void (*disparity_steepness)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                              int width, std::uint16_t* out);
  /// Disparities in 1/16 px: see quantised() in disparity/gradient.hpp.
  void (*quantise)(const float* disparity_px, int width, std::int16_t* out);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const DisparityGradientKernels* disparity_gradient_kernels(Target target);
/// Those for the target that `exec` gets.
const DisparityGradientKernels& disparity_gradient_kernels(const Exec& exec);

}  // namespace cairn::kernels
