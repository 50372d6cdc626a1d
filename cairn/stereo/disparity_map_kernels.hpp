// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/reject.hpp>
#include <cstdint>

/// The kernels of combine(): the rejection bits of a row; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct DisparityMapKernels {
  /// Reject::border where there is no disparity (NaN).
  void (*mark_holes)(const float* disparity_px, int width, Reject* reject);
  void (*add_reasons)(const Reject* more, int width, Reject* reject);
  /// NaN where there is a reason.
  void (*punch_holes)(const Reject* reject, int width, float* disparity_px);
  /// `why` where `mask` is not 0.
  void (*reject_where)(const std::uint8_t* mask, int width, Reject why, Reject* verdict);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const DisparityMapKernels* disparity_map_kernels(Target target);
/// The functions for the active target of `exec`.
const DisparityMapKernels& disparity_map_kernels(const Exec& exec);

}  // namespace cairn::kernels
