// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/match.hpp>
#include <cstdint>

/// The interface to the instruction sets: window comparison for match(). Private to the library.
namespace cairn::kernels {

/// One call of match(): the images to correlate (prefiltered already) and the maps to fill.
struct MatchTask {
  MatchConfig config;
  View<const Gray> left;
  View<const Gray> right;
  View<const std::int16_t> left_flat;  // zsad only: the images minus their local means
  View<const std::int16_t> right_flat;
  Matches& out;
  Pool pool;  // for the working memory
};

struct WindowKernels {
  /// Fills rows first … last − 1 of every map. Any split into bands gives the same result.
  void (*match_rows)(const MatchTask& task, int first, int last);
};

/// The functions of this build for a cost and `target`, nullptr if it has none. Never nullptr for
/// Target::scalar. Each cost has its own source file: together they would take minutes to compile.
template <Cost kCost>
const WindowKernels* window_kernels(Target target);
/// The functions for the active target of `exec`.
const WindowKernels& window_kernels(Cost cost, const Exec& exec);

}  // namespace cairn::kernels
