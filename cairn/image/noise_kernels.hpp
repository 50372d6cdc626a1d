// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The seam to the instruction sets: what noise_sigma() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct NoiseKernels {
  /// |(1 −2 1; −2 4 −2; 1 −2 1)| of the samples 1 … width − 2.
  void (*noise)(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down, int width,
                std::uint16_t* out);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const NoiseKernels* noise_kernels(Target target);
/// Those for the target that `exec` gets.
const NoiseKernels& noise_kernels(const Exec& exec);

}  // namespace cairn::kernels
