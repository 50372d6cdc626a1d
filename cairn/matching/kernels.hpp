// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/matching/match.hpp>
#include <cairn/matching/subpixel.hpp>
#include <cstdint>

/// The seam to the instruction sets: everything of match() that runs per pixel and disparity. Private to the
/// library.
namespace cairn::kernels {

/// One call of match(): the images to correlate (prefiltered already) and the maps to fill.
struct MatchTask {
  MatchConfig config;
  View<const Gray> left;
  View<const Gray> right;
  View<const std::int16_t> left_flat;  // zsad only: the same without their local means
  View<const std::int16_t> right_flat;
  Matches& out;
  Pool pool;  // for the working memory
};

/// One row of refine_subpixel(). Rows of images: whole vectors are read and written, beyond `width` in their
/// padding.
struct RefinedRow {
  const std::int16_t* best;
  const float* before;  // nullptr: nothing is refined
  const float* cost;
  const float* after;
  int width;
  float* out;
};

struct MatchKernels {
  /// Fills the rows first … last − 1 of every map. Any split into bands gives the same result.
  void (*match_rows)(const MatchTask& task, int first, int last);
  /// Out of three rows of an image one of filter_xsobel(). `columns`: room for a row.
  void (*filter_row)(const Gray* above, const Gray* here, const Gray* below, int width, int cap,
                     std::int16_t* columns, Gray* out);
  void (*refine_row)(SubpixelMethod method, const RefinedRow& row);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const MatchKernels* match_kernels(Target target);
/// Those for the target that `exec` gets.
const MatchKernels& match_kernels(const Exec& exec);

}  // namespace cairn::kernels
