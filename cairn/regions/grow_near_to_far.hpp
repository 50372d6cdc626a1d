// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/grow_statistical.hpp>

namespace cairn {

/// The paper's own region growing for disparity. (METHOD §5; paper, "Disparity segmentation" a–g)
/// Nodes are visited from the highest mean (nearest) to the lowest, ties in raster order; a node without valid pixel
/// comes last. The visited node tries its arcs from the lowest |μi−μj| up (ties: raster order) with may_fuse(); on fusion
/// it takes over all neighbours, arc values are recomputed, and it goes on with its cheapest arc not yet tried. Ends when
/// every node was visited. Then regions below min_region_area and regions without a valid pixel fuse with the most
/// similar neighbour, smallest first (ties: raster order); a region without valid pixel has no mean to compare, so it goes
/// to the neighbour of lowest mean: what is unseen next to an object is mostly hidden background.
/// Floor regions neither absorb nor are absorbed.
Merges grow_near_to_far(const RegionGraph& graph, const GrowCriteria& criteria);

}  // namespace cairn
