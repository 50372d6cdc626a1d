// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The kernels of noise_sigma(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct NoiseKernels {
  /// |(1 −2 1; −2 4 −2; 1 −2 1)| of the samples 1 … width − 2.
  void (*noise)(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down, int width,
                std::uint16_t* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const NoiseKernels* noise_kernels(Target target);
/// The functions for the active target of `exec`.
const NoiseKernels& noise_kernels(const Exec& exec);

}  // namespace cairn::kernels
