// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The kernels of gradient() and edge_strength(), per pixel of a row; one set per instruction set. Private to
/// the library.
namespace cairn::kernels {

/// Half of a symmetric smoothing kernel in 1/256: weights[i] applies to +i and −i.
struct RowWeights {
  const int* weights;
  int radius;
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct GradientKernels {
  /// Smooths the rows −radius … +radius around a row vertically, then horizontally: `rows[i]` is row i −
  /// radius, `width` samples of `channels` interleaved bytes each. Output in 1/16 level. Working memory:
  /// `padded` width + 2 · radius samples, `sum` width samples.
  void (*smooth)(const std::uint8_t* const* rows, int width, int channels, RowWeights kernel,
                 std::uint16_t* padded, std::uint32_t* sum, std::int16_t* out);
  /// Gradient magnitude in 1/4 level, maximum over the channels, of a row from smooth() and the rows above
  /// and below. Working memory: `squares`, width samples.
  void (*edges)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                int channels, std::uint32_t* squares, std::uint16_t* out);
  /// Gradient magnitude in whole levels, capped at 255, from one side of a pixel to the other, of
  /// single-channel rows from smooth().
  void (*steepness)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                    std::uint16_t* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const GradientKernels* gradient_kernels(Target target);
/// The functions for the active target of `exec`.
const GradientKernels& gradient_kernels(const Exec& exec);

}  // namespace cairn::kernels
