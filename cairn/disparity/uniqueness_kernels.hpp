// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/disparity/reject.hpp>

/// The seam to the instruction sets: what reject_ambiguous() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct UniquenessKernels {
  /// Reject::not_unique where runner_up · share < cost · 100.
  void (*compare_with_runner_up)(const float* cost, const float* runner_up, int width, float share,
                                 Reject* verdict);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const UniquenessKernels* uniqueness_kernels(Target target);
/// Those for the target that `exec` gets.
const UniquenessKernels& uniqueness_kernels(const Exec& exec);

}  // namespace cairn::kernels
