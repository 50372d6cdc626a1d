// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/disparity/background.hpp>
#include <cairn/regions/facets.hpp>
#include <cstdint>
#include <vector>

namespace cairn {

struct FigureConfig {
  float margin = 1.6F;
  float agreement = 4.7F;
  float longest_bridge = 30.0F;
  float least_known = 20.0F;
  float colour_reach = 20.0F;
};
template <class V>
void fields(FigureConfig& c, V&& v) {
  v("margin", c.margin, "‰ of the width", "how far a disparity must stand before the background to be figure",
    range(0.0F, 100.0F));
  v("agreement", c.agreement, "‰ of the width",
    "largest difference of the disparities on both sides of a plain stretch that still belongs to one "
    "surface",
    range(0.0F, 100.0F));
  v("longest_bridge", c.longest_bridge, "% of the width", "plain stretches longer than this hardly count",
    range(0.0F, 100.0F));
  v("least_known", c.least_known, "% of a facet", "a facet of which less is known is left to its neighbours",
    range(0.0F, 100.0F));
  v("colour_reach", c.colour_reach, "grey levels",
    "how alike the colours of a bridge and of the ground must be for it to be ground", off_or(0.0F, 255.0F));
}

/// For each facet: is it figure (1: before the background) or ground (0)?
///
/// Only evidence speaks. Along each row, a pixel with evidence is figure where its disparity lies more than
/// margin before the background. A plain stretch between two pieces of evidence belongs to the farther of its
/// ends, since an edge belongs to the nearer of the surfaces that it parts: it is figure where both ends are,
/// and says nothing where those lie in different depths. A stretch that runs out of the image is ground, at
/// half weight: what the picture cuts off is mostly background. The facet's pixels vote; facets of which too
/// little is known follow the neighbour across their weakest border. (METHOD §6, beyond the paper)
std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          const FigureConfig& config, const Exec& exec);

}  // namespace cairn
