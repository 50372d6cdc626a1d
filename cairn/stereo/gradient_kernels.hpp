// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The kernels of quantised() and of gradient() of disparities, per pixel of a row; one set per instruction
/// set. Private to the library.
namespace cairn::kernels {

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct DisparityGradientKernels {
  /// See gradient() in stereo/gradient.hpp.
  void (*disparity_steepness)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                              int width, std::uint16_t* out);
  /// Disparities in 1/16 px: see quantised() in stereo/gradient.hpp.
  void (*quantise)(const float* disparity_px, int width, std::int16_t* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const DisparityGradientKernels* disparity_gradient_kernels(Target target);
/// The functions for the active target of `exec`.
const DisparityGradientKernels& disparity_gradient_kernels(const Exec& exec);

}  // namespace cairn::kernels
