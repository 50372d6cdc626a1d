// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/matching/match.hpp>

namespace cairn {

/// What it costs a path when the disparity changes, in units of the greatest cost that one pixel's match can
/// have.
struct SemiGlobalConfig {
  float penalty_small = 0.6F;  // greatest costs, 0 … 2.3; by one pixel: less for slanted and curved surfaces
  float penalty_large = 2.2F;  // greatest costs, 0 … 2.3; by more: less for thin objects, more for noise
  float penalty_edge = 0.15F;  // 1/grey level, 0 … 10; how fast the large penalty falls with the intensity's
                               // step: more where objects stand out by their grey level
};
template <class V>
void fields(SemiGlobalConfig& c, V&& v) {
  constexpr Condition kSemiGlobal = when("match.method", "semi_global");
  v("penalty_small", c.penalty_small, "greatest cost", "for a change of disparity by one pixel",
    range(0.0F, 2.3F), kSemiGlobal);
  v("penalty_large", c.penalty_large, "greatest cost", "for a larger change of disparity", range(0.0F, 2.3F),
    kSemiGlobal);
  v("penalty_edge", c.penalty_edge, "1/grey level",
    "how fast the large penalty falls where the intensity changes", range(0.0F, 10.0F), kSemiGlobal);
}

/// Matches single pixels and lets the disparities of neighbours vote on each other: where a window sees no
/// texture, the answer comes from where there is some, and rims stay sharp because no window lies across
/// them. (Hirschmüller 2008, "Stereo processing by semiglobal matching and mutual information")
///
/// 1. census(x, y): 24 bits, one for each other pixel of the 5x5 window, 1 where it is darker than the
/// centre.
///    (Zabih & Woodfill 1994) The border is replicated, here and below.
/// 2. h(x, y, d): in how many bits left (x, y) and right (x − d, y) differ; 12 where the latter lies outside.
/// 3. C(x, y, d) = (Σh + 2) / 4 over the 3x3 pixels around (x, y), rounded down: 0 … 54.
/// 4. Along each of four paths (rightward, leftward, down, up), p being the pixel after q, and from C alone
/// at
///    its first pixel:
///      L(p, d) = C(p, d) + min(L(q, d), L(q, d±1) + P1, min L(q, ·) + P2) − min L(q, ·)          (their Eq.
///      13)
///    P1 = 54·penalty_small. P2 = 54·max(1/2, penalty_large / (1 + penalty_edge·|ΔI|)), but at least P1; ΔI
///    is the step from q to p in the left image, smoothed by the weights 6 58 128 58 6 (σ = 0.8) across and
///    down.
/// 5. S(x, y, d) = the sum of the four L. It is what the maps of Matches hold for costs; candidates outside
/// the
///    right image have none and never win. Ties and best_right as with match_windows().
///
/// All of it is integer, so that every instruction set gets the same bits. Of `config` only min_disparity,
/// num_disparities and maps count; row_offset stays empty. Unlike a window's, this takes memory for all
/// candidates of all pixels: 2 bytes for each.
Matches match_semi_global(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties, const Exec& exec);

/// By either method, as config.method says: match_windows() or match_semi_global().
Matches match(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties,
              const Exec& exec);

}  // namespace cairn
