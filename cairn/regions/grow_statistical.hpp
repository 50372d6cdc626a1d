// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/region_graph.hpp>

namespace cairn {

/// The similarity that two regions need to fuse, in units of the values of the graph.
struct GrowCriteria {
  double mean_difference_max = 0;    // Eq. (1)
  double deviation_max = 0;          // Eq. (2), in standard deviations
  double sigma_min = 0;              // lower limit of σ in Eq. (2)
  std::int64_t min_region_area = 0;  // px; smaller regions fuse with the neighbour of nearest mean
};

/// Equations (1)–(3): may `visited` absorb `neighbour`?
///   |μ1−μ2| ≤ mean_difference_max  and  |μ_new−μ1| / max(σ1, sigma_min) ≤ deviation_max,
///   μ_new = (N1·μ1+N2·μ2)/(N1+N2), N the number of valid pixels; N·μ is the exact sum.
/// Regions without a valid pixel and floor regions never fuse by this rule.
bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria);

/// Statistical region growing. (docs/stages/intensity.md; paper, Eq. 1–3) A pass visits the regions in raster
/// order of their first pixels at the start of the pass. The visited region tries its neighbours in raster
/// order of their first pixels and absorbs those that may_fuse() admits; statistics are recomputed after each
/// fusion. It repeats this, including neighbours gained by fusions, until a round has no fusion. Passes
/// repeat until a pass has no fusion. The visited region survives a fusion. Small regions come last: see
/// fuse_small_regions().
Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec);

/// The last step of both kinds of growing. A small region has fewer pixels than min_region_area, or no valid
/// pixel, and is not floor. While one has a neighbour that is not floor, the smallest of them fuses with the
/// most similar such neighbour, which survives: the one of nearest mean. A region without valid pixel has no
/// mean and fuses with the neighbour of lowest mean: an unseen area next to an object is mostly occluded
/// background. Neighbours without valid pixel come last. All ties: raster order of the first pixels. (Paper,
/// step g) `merged_into`: the fusions so far; returns them with the new ones.
Merges fuse_small_regions(const RegionGraph& graph, const Merges& merged_into, std::int64_t min_region_area,
                          const Exec& exec);

}  // namespace cairn
