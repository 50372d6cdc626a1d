// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/subpixel.hpp>
#include <cstdint>

/// The kernels of refine_subpixel(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// One row of refine_subpixel(). Whole vectors are read and written, beyond `width` into the padding of image
/// rows.
struct RefinedRow {
  const std::int16_t* best;
  const float* before;  // nullptr: no refinement
  const float* cost;
  const float* after;
  int width;
  float* out;
};

struct SubpixelKernels {
  void (*refine_row)(SubpixelMethod method, const RefinedRow& row);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const SubpixelKernels* subpixel_kernels(Target target);
/// The functions for the active target of `exec`.
const SubpixelKernels& subpixel_kernels(const Exec& exec);

}  // namespace cairn::kernels
