// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/grow_statistical.hpp>

namespace cairn {

/// The paper's own region growing for disparity. (docs/stages/disparity.md; paper, "Disparity segmentation"
/// a–g) Nodes are visited once each, from the highest mean (nearest) to the lowest, ties in raster order;
/// absorbed nodes count as visited. The visited node tries its arcs from the lowest |μi−μj| up (ties: raster
/// order of the neighbours' first pixels) with may_fuse(). On fusion it survives and takes over all
/// neighbours, arc values are recomputed, and it goes on with its cheapest arc not yet tried; a neighbour
/// that was refused is not tried again in this visit. Nodes visited before may be absorbed like any other.
/// Regions without valid pixel and floor regions neither absorb nor are absorbed. Last come the small
/// regions: see fuse_small_regions().
Merges grow_near_to_far(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec);

}  // namespace cairn
