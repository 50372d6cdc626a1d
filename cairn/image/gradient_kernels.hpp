// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The seam to the instruction sets: what gradient() and edge_strength() do for each pixel of a row. Private
/// to the library.
namespace cairn::kernels {

/// One side of a symmetric smoothing kernel in 1/256: weights[i] stands at +i and −i.
struct RowWeights {
  const int* weights;
  int radius;
};

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct GradientKernels {
  /// The rows −radius … +radius around a row, smoothed down and then across: `rows[i]` stands for row i −
  /// radius, `width` samples of `channels` interleaved bytes each. Writes 1/16 levels. `padded`: width + 2 ·
  /// radius samples, `sum`: width, working memory.
  void (*smooth)(const std::uint8_t* const* rows, int width, int channels, RowWeights kernel,
                 std::uint16_t* padded, std::uint32_t* sum, std::int16_t* out);
  /// Magnitude in 1/4 level, of the channel where it is largest, of the gradient of a row that smooth() made
  /// and those above and below. `squares`: width samples, working memory.
  void (*edges)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                int channels, std::uint32_t* squares, std::uint16_t* out);
  /// Magnitude in whole levels, capped at 255, of the gradient from one side of a pixel to the other of a row
  /// that smooth() made from single samples.
  void (*steepness)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                    std::uint16_t* out);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const GradientKernels* gradient_kernels(Target target);
/// Those for the target that `exec` gets.
const GradientKernels& gradient_kernels(const Exec& exec);

}  // namespace cairn::kernels
