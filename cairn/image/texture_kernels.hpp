// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The seam to the instruction sets: what lacks_texture() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// Sums of squared differences, for lacks_texture(). The narrower the sums, the more at once.
template <class Sum>
struct SquareKernels {
  /// sums[x] += min((here[x] − there[x])², most) for `count` pixels; and the same taken away again.
  void (*add)(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most, Sum* sums);
  void (*remove)(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                 Sum* sums);
  /// low[x] = 1 where columns[x] + … + columns[x + window − 1] is below limits[x]. `blocks`:
  /// 2 · (width + window) samples, `sums`: width, working memory. The window is odd.
  void (*flag_low)(const Sum* columns, int width, int window, const Sum* limits, Sum* blocks, Sum* sums,
                   std::uint8_t* low);
};

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct TextureKernels {
  SquareKernels<std::uint16_t> narrow_squares;
  SquareKernels<std::uint32_t> wide_squares;
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const TextureKernels* texture_kernels(Target target);
/// Those for the target that `exec` gets.
const TextureKernels& texture_kernels(const Exec& exec);

}  // namespace cairn::kernels
