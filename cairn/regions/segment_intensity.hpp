// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/regions/region_graph.hpp>

namespace cairn {

struct IntensityConfig {
  float smoothing_sigma = 0.7F;
  float mean_difference_max = 3.0F;
  float deviation_max = 1.0F;
  float sigma_min = 2.0F;
  float min_region_area = 0.03F;
};
template <class V>
void fields(IntensityConfig& c, V&& v) {
  v("smoothing_sigma", c.smoothing_sigma, "px", "Gaussian smoothing before the gradient", range(0.0F, 5.0F));
  v("mean_difference_max", c.mean_difference_max, "grey levels",
    "Eq. 1: largest difference of two means that fuse", range(0.0F, 255.0F));
  v("deviation_max", c.deviation_max, "σ", "Eq. 2: how many deviations a fusion may move the mean",
    range(0.0F, 100.0F));
  v("sigma_min", c.sigma_min, "grey levels", "least deviation used in Eq. 2", range(0.01F, 255.0F));
  v("min_region_area", c.min_region_area, "% of the image",
    "smaller regions fuse with the most similar neighbour", range(0.0F, 100.0F));
}

/// Regions of like intensity: gradient → watershed → build_graph → grow_statistical.
/// (docs/stages/intensity.md; paper, "Intensity segmentation")
Segmentation segment_intensity(View<const Gray> image, const IntensityConfig& config, const Exec& exec);

}  // namespace cairn
