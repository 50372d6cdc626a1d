// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/regions/region_graph.hpp>
#include <vector>

namespace cairn {

/// How regions become objects. overlap: the paper's, intensity regions by the disparity region that they
/// overlap most. hierarchy: superpixels fuse to a tree of regions, and the likeliest objects in it are
/// chosen.
enum class FusionMethod : std::uint8_t { overlap, hierarchy };
inline constexpr std::array kFusionMethods{Choice<FusionMethod>{"overlap", FusionMethod::overlap},
                                           Choice<FusionMethod>{"hierarchy", FusionMethod::hierarchy}};

struct FusionConfig {
  FusionMethod method = FusionMethod::overlap;  // overlap: what the paper describes
};
template <class V>
void fields(FusionConfig& c, V&& v) {
  v("method", c.method, "",
    "overlap: the paper's two segmentations; hierarchy: the likeliest objects in a tree of regions",
    kFusionMethods);
}

/// Which intensity regions make up each fused region: the candidates for objects.
struct Fusion {
  Image<RegionId> labels;                    // fused region per pixel, 0 … parts.size()−1
  std::vector<std::vector<RegionId>> parts;  // per fused region: its intensity regions, ascending
  std::vector<RegionId>
      disparity_region;        // per fused region: the disparity region that it follows, ascending
  std::vector<bool> is_floor;  // per fused region: whether that one is the floor
};

/// Equation (4): each intensity region goes to the disparity region with the greatest overlap (ties: the one
/// of higher mean disparity, then the lower id); all intensity regions of one disparity region form one fused
/// region. Fused regions are numbered by their disparity region; disparity regions that no intensity region
/// chose are left out. (docs/stages/fusion.md; paper, "Region fusion")
Fusion fuse(const Segmentation& by_intensity, const Segmentation& by_disparity, const Exec& exec);

}  // namespace cairn
