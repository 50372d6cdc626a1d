// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The kernels of lacks_texture(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// Sums of squared differences, for lacks_texture(). Narrower sums fit more lanes.
template <class Sum>
struct SquareKernels {
  /// sums[x] += min((here[x] − there[x])², most) for `count` pixels, and the same subtracted.
  void (*add)(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most, Sum* sums);
  void (*remove)(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                 Sum* sums);
  /// low[x] = 1 if columns[x] + … + columns[x + window − 1] < limits[x]. Working memory: `blocks` 2 · (width
  /// + window) samples, `sums` width samples. The window is odd.
  void (*flag_low)(const Sum* columns, int width, int window, const Sum* limits, Sum* blocks, Sum* sums,
                   std::uint8_t* low);
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct TextureKernels {
  SquareKernels<std::uint16_t> narrow_squares;
  SquareKernels<std::uint32_t> wide_squares;
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const TextureKernels* texture_kernels(Target target);
/// The functions for the active target of `exec`.
const TextureKernels& texture_kernels(const Exec& exec);

}  // namespace cairn::kernels
