// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/regions/region_graph.hpp>

namespace cairn {

struct DisparityConfig {
  float smoothing_sigma = 0.0F;
  float mean_difference_max = 2.0F;
  float deviation_max = 1.0F;
  float sigma_min = 0.25F;
  float min_region_area = 0.2F;
};
template <class V>
void fields(DisparityConfig& c, V&& v) {
  v("smoothing_sigma", c.smoothing_sigma, "px", "Gaussian smoothing before the gradient", range(0.0F, 5.0F));
  v("mean_difference_max", c.mean_difference_max, "px of disparity",
    "Eq. 1: largest difference of two means that fuse", range(0.0F, 64.0F));
  v("deviation_max", c.deviation_max, "σ", "Eq. 2: how many deviations a fusion may move the mean",
    range(0.0F, 100.0F));
  v("sigma_min", c.sigma_min, "px of disparity", "least deviation used in Eq. 2", range(0.01F, 64.0F));
  v("min_region_area", c.min_region_area, "% of the image",
    "smaller regions fuse with the most similar neighbour", range(0.0F, 100.0F));
}

/// Regions of like disparity, nearest first: gradient → watershed → build_graph → grow_near_to_far. Floor
/// pixels
/// (`floor` non-zero; may be empty) are one region of their own, Region::is_floor. Means in px.
/// (docs/stages/disparity.md; paper, "Disparity segmentation")
Segmentation segment_disparity(const DisparityMap& disparity, View<const std::uint8_t> floor,
                               const DisparityConfig& config, const Exec& exec);

}  // namespace cairn
