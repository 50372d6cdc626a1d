// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/region_graph.hpp>
#include <vector>

namespace cairn {

/// The intensity regions of each fused region, the candidates for objects.
struct Fusion {
  Image<RegionId> labels;                    // fused region per pixel, 0 … parts.size()−1
  std::vector<std::vector<RegionId>> parts;  // per fused region: its intensity regions, ascending
  std::vector<RegionId> disparity_region;    // per fused region: its disparity region, ascending
  std::vector<bool> is_floor;                // per fused region: whether its disparity region is the floor
};

/// Equation (4): each intensity region is assigned to the disparity region of greatest overlap (ties: the
/// higher mean disparity, then the lower id); all intensity regions of a disparity region form one fused
/// region. Fused regions are numbered in the order of their disparity regions; disparity regions without
/// intensity region are left out. (docs/stages/fusion.md; paper, "Region fusion")
Fusion fuse(const Segmentation& by_intensity, const Segmentation& by_disparity, const Exec& exec);

}  // namespace cairn
