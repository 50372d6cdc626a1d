// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/matching/match.hpp>
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

/// Fills the rows first … last − 1 of every map. Any split into bands gives the same result.
using MatchRows = void (*)(const MatchTask& task, int first, int last);

/// The function of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
MatchRows match_rows(Target target);

}  // namespace cairn::kernels
