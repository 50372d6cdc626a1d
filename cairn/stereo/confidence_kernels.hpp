// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/confidence.hpp>
#include <cstdint>

/// The kernels of estimate_confidence(), per pixel of a row; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

/// Number of holes (low byte) and of disparity jumps (high byte) in a set of pixels.
using HolesAndJumps = std::uint16_t;

/// The features of a row.
struct ConfidenceRow {
  const float* cost;
  const float* runner_up;
  const float* mean_cost;
  const float* disparity_px;
  const HolesAndJumps* around;  // in the window of each pixel
  const float* inverse_area;    // 1 / number of pixels in that window
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct ConfidenceKernels {
  /// Marks each hole, and each disparity that differs by more than `jump` from the one to the right or below.
  /// The last pixel has no right neighbour.
  void (*mark_jumps)(const float* here, const float* below, int width, float jump, HolesAndJumps* marks);
  /// counts[x] += more[x], or −= .
  void (*add_counts)(const HolesAndJumps* more, int width, HolesAndJumps* counts);
  void (*remove_counts)(const HolesAndJumps* less, int width, HolesAndJumps* counts);
  /// sums[x] = columns[x] + … + columns[x + window − 1]. `blocks`: 2 · (width + window)
  /// samples, working memory. The window is odd.
  void (*sum_counts)(const HolesAndJumps* columns, int width, int window, HolesAndJumps* blocks,
                     HolesAndJumps* sums);
  /// See estimate_confidence().
  void (*judge_confidence)(const ConfidenceRow& row, int width, const ConfidenceModel& model, float* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const ConfidenceKernels* confidence_kernels(Target target);
/// The functions for the active target of `exec`.
const ConfidenceKernels& confidence_kernels(const Exec& exec);

}  // namespace cairn::kernels
