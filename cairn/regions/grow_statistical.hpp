// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/region_graph.hpp>

namespace cairn {

/// When two regions are alike enough to fuse. Units: those of the graph's values.
struct GrowCriteria {
  double mean_difference_max = 0;    // Eq. (1)
  double deviation_max = 0;          // Eq. (2), in standard deviations
  double sigma_min = 0;              // least σ used in Eq. (2)
  std::int64_t min_region_area = 0;  // px; smaller regions fuse with the neighbour of nearest mean
};

/// Equations (1)–(3): may `visited` absorb `neighbour`?
///   |μ1−μ2| ≤ mean_difference_max  and  |μ_new−μ1| / max(σ1, sigma_min) ≤ deviation_max,
///   μ_new = (N1·μ1+N2·μ2)/(N1+N2), N the valid pixels; N·μ is taken as the exact sum.
/// Regions without a valid pixel and floor regions never fuse by this rule.
bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria);

/// Statistical region growing. (docs/stages/intensity.md; paper, Eq. 1–3)
/// A pass visits the regions in raster order of the first pixel that they had when the pass began. The
/// visited region goes through its neighbours in raster order of their first pixels and absorbs those that
/// may_fuse() admits, statistics recomputed on each fusion; it does so again, neighbours that came with the
/// fusions included, until a round fused nothing. Passes repeat until a whole pass fused nothing. The
/// survivor of a fusion is the visited region. Last come the small regions: see fuse_small_regions().
Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec);

/// The end of either growing, as a rule. As long as there is one, the smallest region that is small (fewer
/// pixels than min_region_area, or not one valid pixel), is no floor and has a neighbour that is no floor
/// fuses with the most similar of those neighbours, which survives. Most similar is the nearest mean; a
/// region without valid pixel has no mean to compare, so it goes to the neighbour of lowest mean: what is
/// unseen next to an object is mostly hidden background. Neighbours without valid pixel come last. All ties:
/// raster order of the first pixels. (Paper, step g) `merged_into`: the fusions so far; returns them with the
/// new ones.
Merges fuse_small_regions(const RegionGraph& graph, const Merges& merged_into, std::int64_t min_region_area,
                          const Exec& exec);

}  // namespace cairn
