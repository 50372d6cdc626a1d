// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/grouping/figure.hpp>
#include <cairn/regions/region_graph.hpp>
#include <optional>

namespace cairn {

struct GroupConfig {
  float step = 2.0F;  // ‰ of the width, 0 … 1000; less parts what touches, more holds slanted things together
  // No options, constants:
  float step_share = 6.0F;        // % of the disparity; … or this share of it, if that is more
  float deviation = 4.0F;         // ‰ of the width; how far a facet may lie off its object's plane …
  float deviation_share = 12.0F;  // % of the disparity; … or this share of it, if that is more
  float gap_share = 50.0F;        // % of its border; a facet without evidence that has more ground around it
                                  // than this connects nothing
  float min_area = 0.6F;       // % of the image, 0 … 100; an option: less keeps small parts for themselves
  float occluded_gap = 10.0F;  // % of the width; a constant: groups of one depth this close to each other
                               // behind a common nearer one are one object; 0 = never
};
template <class V>
void fields(GroupConfig& c, V&& v) {
  constexpr Condition kByEvidence = when("fusion.method", "evidence");
  v("step", c.step, "‰ of the width", "largest step of disparity across a border within one object",
    range(0.0F, 1000.0F), kByEvidence);
  v("min_area", c.min_area, "% of the image", "smaller groups join a neighbour", range(0.0F, 100.0F),
    kByEvidence);
}

/// Groups figure facets to objects: the paper's growing from near to far, on facets and with planes instead
/// of means, so that slanted surfaces hold together and a step in depth parts what touches in the picture.
///
/// Each facet gets the plane of its disparities (pixels next to its border hardly count, for there the
/// matcher blends two surfaces; slopes are damped, so that small facets are level). The nearest free facet
/// begins a group; the group takes in neighbours, least step across the common border first, as long as the
/// step is at most `step` and the neighbour there lies within `deviation` of the group's own plane, which is
/// refitted each time. Both grow with disparity: a share of it is a share of the distance, near or far. A
/// facet that shows no evidence of its own and mostly borders on ground may be what is seen between two
/// objects, and connects nothing. Then groups below min_area join the figure neighbour with the longest,
/// smoothest common border, facets without disparity follow their weakest border, and what a nearer object
/// parts is put together again. (docs/stages/group.md, beyond the paper)
///
/// Result: region 0 is the background (is_background), the others are groups. Means in px.
Segmentation group_facets(const Facets& facets, const std::vector<std::int32_t>& figure,
                          const DisparityMap& disparity, View<const float> evidence_px,
                          const Background& background, const std::optional<StereoRig>& rig,
                          const FigureConfig& figure_config, const GroupConfig& config, const Exec& exec);

}  // namespace cairn
