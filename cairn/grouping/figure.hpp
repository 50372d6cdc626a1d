// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/grouping/facets.hpp>
#include <cairn/scene/background.hpp>
#include <cstdint>
#include <vector>

namespace cairn {

struct FigureConfig {
  float margin = 1.6F;  // ‰ of the width, 0 … 100; less finds flatter things, more bears inexact matches
  float agreement = 4.7F;  // ‰ of the width, 0 … 100; more bridges plain stretches of slanted surfaces
  // No options, constants:
  float longest_bridge = 30.0F;  // % of the width; plain stretches longer than this hardly count
  float border_weight = 0.4F;    // px of evidence; what a pixel beside a facet's border counts that is seen
                                 // before the background: the matcher gives the nearer surface's disparity
                                 // to both sides of its edge; 1 = as much as any
  float skirting = 2.5F;         // % of the width; a plain facet within this above the foot of a wall is
                                 // figure only where that is seen; 0 = anywhere
  float smoothness = 2.0F;       // px of evidence; what it costs, for each pixel of a border without an edge,
                                 // to part figure and ground there
  float colour_weight = 0.4F;    // px of evidence; what a plain pixel's colour says, when it is e times as
                                 // common in the figure as in the ground; 0 = nothing
  float continuation_weight = 0.5F;  // px of evidence; what it says for ground that ground of its colour goes
                                     // on beside it; 0 = nothing
  float largest_part = 2.0F;  // % of the image; ground that touches figure speaks for its colour only with
                              // what it is larger than this: it may be a part of an object without evidence
};
template <class V>
void fields(FigureConfig& c, V&& v) {
  constexpr Condition kByEvidence = when("fusion.method", "evidence");
  v("margin", c.margin, "‰ of the width", "how far a disparity must stand before the background to be figure",
    range(0.0F, 100.0F), kByEvidence);
  v("agreement", c.agreement, "‰ of the width",
    "largest difference of the disparities on both sides of a plain stretch that still belongs to one "
    "surface",
    range(0.0F, 100.0F), kByEvidence);
}

/// For each facet: is it figure (1: before the background) or ground (0)?
///
/// Only evidence knows. Along each row, a pixel with evidence is figure where its disparity lies more than
/// margin before the background. A plain stretch between two pieces of evidence belongs to the farther of its
/// ends, since an edge belongs to the nearer of the surfaces that it parts: it is figure where both ends are,
/// and says nothing where those lie in different depths. A stretch that runs out of the image is ground, at
/// half weight: what the picture cuts off is mostly background. Figure that is seen right beside a facet's
/// border counts border_weight, for it may be the neighbour's. No conclusion is drawn along the foot of a
/// wall: a skirting board has no upright edges, and would join all that stands before it.
///
/// These votes are the costs of a facet's two labels; parting two neighbours costs the more the longer and
/// the weaker their common border. The labelling of least cost is exact: a minimum cut. It is found three
/// times: the second and third time facets that are not seen to be figure also go by their colour, compared
/// with all that is ground and with all that is seen to be figure, and by whether the ground around them goes
/// on in their colour, as a wall does behind two objects. Ground that touches figure has a say in that only
/// with what it is larger than largest_part: it may be the object's (but where no floor is known, it may as
/// well mirror it). `noise_sigma`: of `gray`. (docs/stages/figure.md, beyond the paper; colour against the
/// two models and cut in turn: Rother, Kolmogorov & Blake 2004, "GrabCut")
std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          float noise_sigma, const FigureConfig& config, const Exec& exec);

}  // namespace cairn
