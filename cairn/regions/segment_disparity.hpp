// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/region_graph.hpp>
#include <cairn/regions/segment_config.hpp>
#include <cairn/stereo/disparity_map.hpp>

namespace cairn {

/// Regions of similar disparity: gradient → watershed → build_graph → grow_near_to_far, nearest first. Floor
/// pixels (`floor` non-zero; may be empty) are one separate region, Region::is_floor. Means in px.
/// (docs/stages/disparity.md; paper, "Disparity segmentation")
Segmentation segment_disparity(const DisparityMap& disparity, View<const std::uint8_t> floor,
                               const DisparityConfig& config, const Exec& exec);

}  // namespace cairn
