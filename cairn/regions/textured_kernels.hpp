// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/reject.hpp>
#include <cstdint>

/// The kernels of select_textured(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// A row of the smoothed image and its neighbours, in 1/64 grey level.
struct SmoothRows {
  const std::int16_t* up;
  const std::int16_t* here;
  const std::int16_t* down;
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct TexturedKernels {
  /// Smooths by (1 6 1)/8 along both axes, in 1/64 level. Working memory: `column`, width + 2 samples.
  void (*smooth_lightly)(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down,
                         int width, std::int16_t* column, std::int16_t* out);
  /// The disparities of valid pixels whose horizontal difference exceeds `least` and half of the vertical
  /// one; NaN elsewhere.
  void (*textured)(const SmoothRows& smooth, const Reject* reject, const float* disparity_px, int width,
                   int least, float* out);
  /// Keeps the values of rows[2] with at least three other values of the 5×5 neighbourhood within
  /// `agreement`; NaN elsewhere. All rows are padded by two NaN at either end.
  void (*agreed)(const float* const* rows, int width, float agreement, float* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const TexturedKernels* textured_kernels(Target target);
/// The functions for the active target of `exec`.
const TexturedKernels& textured_kernels(const Exec& exec);

}  // namespace cairn::kernels
