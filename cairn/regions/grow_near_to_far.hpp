// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/grow_statistical.hpp>

namespace cairn {

/// The paper's region growing for disparity. (docs/stages/disparity.md; paper, "Disparity segmentation" a–g)
/// Nodes are visited once each, from the highest mean (nearest) to the lowest, ties in raster order; absorbed
/// nodes count as visited. The visited node tries its arcs by may_fuse() in ascending order of |μi−μj| (ties:
/// raster order of the first pixels of the neighbours). After a fusion it survives and inherits all
/// neighbours, arc values are recomputed, and it continues with its cheapest untried arc; a refused neighbour
/// is not tried again during this visit. Nodes visited earlier may be absorbed like any other. Regions
/// without valid pixel and floor regions neither absorb nor are absorbed. Small regions come last: see
/// fuse_small_regions().
Merges grow_near_to_far(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec);

}  // namespace cairn
