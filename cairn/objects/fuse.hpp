// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/regions/region_graph.hpp>
#include <vector>

namespace cairn {

/// The method that makes objects of regions. overlap: the paper's, intensity regions joined by the disparity
/// region that they overlap most. hierarchy: superpixels are merged into a tree of regions, and the likeliest
/// objects in it are chosen.
enum class FusionMethod : std::uint8_t { overlap, hierarchy };
inline constexpr std::array kFusionMethods{Choice<FusionMethod>{"overlap", FusionMethod::overlap},
                                           Choice<FusionMethod>{"hierarchy", FusionMethod::hierarchy}};

struct FusionConfig {
  FusionMethod method = FusionMethod::overlap;  // overlap: as in the paper
};
template <class V>
void fields(FusionConfig& c, V&& v) {
  v("method", c.method, "", "overlap: the paper's method; hierarchy: likeliest objects of a region tree",
    kFusionMethods);
}

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
