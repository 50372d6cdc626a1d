// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/region_graph.hpp>

namespace cairn {

/// When two regions are alike enough to fuse. Units: those of the graph's values.
struct GrowCriteria {
  double mean_difference_max = 0;  // Eq. (1)
  double deviation_max = 0;        // Eq. (2), in standard deviations
  double sigma_min = 0;            // least σ used in Eq. (2)
  std::int64_t min_region_area = 0;  // px; smaller regions fuse with the neighbour of nearest mean
};

/// Equations (1)–(3): may `visited` absorb `neighbour`?
///   |μ1−μ2| ≤ mean_difference_max  and  |μ_new−μ1| / max(σ1, sigma_min) ≤ deviation_max,
///   μ_new = (N1·μ1+N2·μ2)/(N1+N2), N the valid pixels. Regions without a valid pixel never fuse by this rule.
bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour, const GrowCriteria& criteria);

/// Statistical region growing. Regions are visited in raster order of their first pixel; each absorbs the neighbours that
/// may_fuse() admits, tried in ascending first-pixel order, neighbours that came with a fusion included, statistics
/// recomputed on each fusion, until none of its neighbours fuses; passes repeat until a whole pass fused nothing.
/// Then small regions fuse, smallest first (ties: raster order), with the neighbour of nearest mean (ties: raster order).
/// The survivor of a fusion is the visited region. (METHOD §4; paper, Eq. 1–3)
Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria);

}  // namespace cairn
