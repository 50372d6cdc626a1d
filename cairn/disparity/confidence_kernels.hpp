// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cstdint>

/// The seam to the instruction sets: what estimate_confidence() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

/// Holes (low byte) and jumps of the disparity (high byte), counted over some pixels.
using HolesAndJumps = std::uint16_t;

/// What confidence is judged by in a row.
struct ConfidenceRow {
  const float* cost;
  const float* runner_up;
  const float* mean_cost;
  const float* disparity_px;
  const HolesAndJumps* around;  // each pixel
  const float* inverse_area;    // 1 / the pixels that these were counted over
};

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
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

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const ConfidenceKernels* confidence_kernels(Target target);
/// Those for the target that `exec` gets.
const ConfidenceKernels& confidence_kernels(const Exec& exec);

}  // namespace cairn::kernels
