// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/reject.hpp>

/// The kernels of reject_ambiguous(), per pixel of a row; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct UniquenessKernels {
  /// Reject::not_unique where runner_up · share < cost · 100.
  void (*compare_with_runner_up)(const float* cost, const float* runner_up, int width, float share,
                                 Reject* verdict);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const UniquenessKernels* uniqueness_kernels(Target target);
/// The functions for the active target of `exec`.
const UniquenessKernels& uniqueness_kernels(const Exec& exec);

}  // namespace cairn::kernels
