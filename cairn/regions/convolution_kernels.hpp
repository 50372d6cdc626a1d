// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The kernels of hint_objects(), per row; one set per instruction set, and one more with VNNI for those that have it.
/// Private to the library.
namespace cairn::kernels {

/// A convolution of integers. `inputs` is even, `outputs` a multiple of 8 up to kMaxOutputs.
struct Convolution {
  int inputs = 0;
  int outputs = 0;
  int side = 1;                           // of the window: 1 or 3
  int stride = 1;                         // pixels from one output to the next
  int least = 0;                          // of an output: 0 is a rectifier
  const std::int16_t* weights = nullptr;  // [window row][column][pair of inputs][output][2]
  const std::int32_t* bias = nullptr;     // [output]
  const float* scale = nullptr;           // [output]
  // For convolve_two(): [row][column of a transformed tile][pair of inputs][output][2]; nullptr if its
  // preconditions do not hold.
  const std::int16_t* transformed_weights = nullptr;
};

/// The largest number of outputs.
inline constexpr int kMaxOutputs = 112;

/// The number of elements of a transformed tile of convolve_two().
inline constexpr int kPlaces = 16;

/// The limit of an output: no sum of products can then exceed 32 bits …
inline constexpr int kMaxActivation = 4096;
/// … nor can four times a sum of convolve_two(), with at most that many inputs and weights of 8 bits.
inline constexpr int kMaxTiledInputs = 112;
static_assert(std::int64_t{4} * 9 * kMaxTiledInputs * 127 * kMaxActivation < INT32_MAX);

/// Integer sums, one multiplication by a float, rounded to nearest: the same bits on every target.
struct ConvolutionKernels {
  /// `rows`: the `side` rows of the window, channels interleaved, from the window's first
  /// column of the first output on. Output o of pixel x, at out[x · outputs + o], is
  /// (bias[o] + Σ weights · inputs) · scale[o], rounded, from `least` to kMaxActivation.
  void (*convolve)(const std::int16_t* const* rows, const Convolution& by, int width, std::int16_t* out);
  /// The same for two neighbouring rows of outputs, with fewer multiplications. `rows`: the four rows of inputs.
  /// `out[1]` may be nullptr. Preconditions: side 3, stride 1, `inputs` a multiple of 8 up to kMaxTiledInputs.
  void (*convolve_two)(const std::int16_t* const* rows, const Convolution& by, int width,
                       std::int16_t* const* out);
  /// A row of `like`, `width` pixels, plus one of `small`, each pixel of which counts twice; limited to kMaxActivation.
  /// Preconditions: `channels` is a multiple of 8; all numbers are from 0 to kMaxActivation.
  void (*add_doubled)(const std::int16_t* small, const std::int16_t* like, int channels, int width,
                      std::int16_t* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const ConvolutionKernels* convolution_kernels(Target target);
/// The same, but products of 16 bits are added to sums of 32 in one instruction: AVX-VNNI for Target::avx2,
/// AVX512-VNNI for Target::avx512. nullptr if the build or this processor has none. Precondition: the processor supports
/// `target`.
const ConvolutionKernels* vnni_convolution_kernels(Target target);
/// The fastest functions for the active target of `exec`.
const ConvolutionKernels& convolution_kernels(const Exec& exec);

}  // namespace cairn::kernels
