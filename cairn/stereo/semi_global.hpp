// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/match.hpp>

namespace cairn {

/// Penalties for a change of disparity along a path, in units of the greatest cost of a pixel.
struct SemiGlobalConfig {
  float penalty_small = 0.6F;  // greatest costs, 0 … 2.3; by 1 px: lower for slanted and curved surfaces
  float penalty_large = 2.2F;  // greatest costs, 0 … 2.3; by more: lower for thin objects, higher for noise
  float penalty_edge = 0.15F;  // 1/grey level, 0 … 10; decay of the large penalty with the intensity step:
                               // higher if objects differ from their background in grey level
};
template <class V>
void fields(SemiGlobalConfig& c, V&& v) {
  constexpr Condition kSemiGlobal = when("match.method", "semi_global");
  v("penalty_small", c.penalty_small, "greatest cost",
    "penalty for a disparity change of 1 px between neighbours", range(0.0F, 2.3F), kSemiGlobal);
  v("penalty_large", c.penalty_large, "greatest cost", "penalty for a larger disparity change",
    range(0.0F, 2.3F), kSemiGlobal);
  v("penalty_edge", c.penalty_edge, "1/grey level",
    "decay of the large penalty at intensity edges; higher: sharper outlines", range(0.0F, 10.0F),
    kSemiGlobal);
}

/// Matches single pixels under a smoothness constraint: disparity propagates from textured pixels into areas
/// where a window has no texture, and edges stay sharp because no window straddles them. (Hirschmüller 2008,
/// "Stereo processing by semiglobal matching and mutual information")
///
/// 1. census(x, y): 24 bits, one for each other pixel of the 5x5 window, 1 if it is darker than the centre.
///    (Zabih & Woodfill 1994) The border is replicated, here and below.
/// 2. h(x, y, d): Hamming distance of the census at left (x, y) and right (x − d, y); 12 if the latter is
///    outside the image.
/// 3. C(x, y, d) = (Σh + 2) / 4 over the 3x3 pixels around (x, y), rounded down: 0 … 54.
/// 4. Along each of four paths (rightward, leftward, down, up), with p the pixel after q, and L = C at the
///    first pixel of the path:
///      L(p, d) = C(p, d) + min(L(q, d), L(q, d±1) + P1, min L(q, ·) + P2) − min L(q, ·)     (their Eq. 13)
///      P1 = 54·penalty_small
///      P2 = max(P1, 54·max(1/2, penalty_large / (1 + penalty_edge·|ΔI|)))
///    ΔI is the step from q to p in the left image, smoothed by the weights 6 58 128 58 6 (σ = 0.8) across
///    and down.
/// 5. S(x, y, d) = the sum of the four L, and the cost in the maps of Matches; candidates outside the right
///    image have no cost and never win. Ties and best_right as in match_windows().
///
/// All steps are integer, so every instruction set gets the same bits. Only min_disparity, num_disparities
/// and maps of `config` are read; row_offset stays empty. Needs 2 bytes for each candidate of the pixels of a band of
/// rows: of about 10 MB together, or √height rows if that is more.
Matches match_semi_global(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties, const Exec& exec);

/// match_windows() or match_semi_global(), according to config.method; on exec.device if there is one that can.
Matches match(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties,
              const Exec& exec);

}  // namespace cairn
