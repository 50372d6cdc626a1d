// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cstdint>

namespace cairn {

/// The values whose regions are looked for: grey levels, or px of disparity.
enum class Segmented : std::uint8_t { intensity, disparity };

/// What both of the paper's segmentations take; "value": a grey level 0 … 255, or a px of disparity 0 … 64.
template <Segmented values>
struct SegmentConfig {
  static constexpr bool kGrey = values == Segmented::intensity;

  float smoothing_sigma = kGrey ? 0.7F : 0.0F;      // px, 0 … 5; more for noisy pictures: fewer regions
  float gradient_threshold = 0.0F;                  // values, 0 = off; more lets noise make fewer basins
  float mean_difference_max = kGrey ? 3.0F : 2.0F;  // values; Eq. 1: more fuses regions less alike
  float deviation_max = 1.0F;                       // σ, 0 … 100; Eq. 2: more lets a region's mean drift
  float sigma_min = kGrey ? 2.0F : 0.25F;           // values, from 0.01 on; more lets even regions grow
  float min_region_area = kGrey ? 0.03F : 0.2F;     // % of the image, 0 … 100; more leaves fewer crumbs
};
template <Segmented values, class V>
void fields(SegmentConfig<values>& c, V&& v) {
  constexpr Condition kByOverlap = when("fusion.method", "overlap");
  constexpr bool kGrey = SegmentConfig<values>::kGrey;
  constexpr const char* kUnit = kGrey ? "grey levels" : "px";
  constexpr float kGreatest = kGrey ? 255.0F : 64.0F;
  v("smoothing_sigma", c.smoothing_sigma, "px", "Gaussian smoothing before the gradient", range(0.0F, 5.0F),
    kByOverlap);
  v("gradient_threshold", c.gradient_threshold, kUnit,
    "0 = off; a lower gradient counts as 0: no basins of noise", range(0.0F, kGreatest), kByOverlap);
  v("mean_difference_max", c.mean_difference_max, kUnit, "Eq. 1: largest difference of two means that fuse",
    range(0.0F, kGreatest), kByOverlap);
  v("deviation_max", c.deviation_max, "σ", "Eq. 2: how many deviations a fusion may move the mean",
    range(0.0F, 100.0F), kByOverlap);
  v("sigma_min", c.sigma_min, kUnit, "least deviation used in Eq. 2", range(0.01F, kGreatest), kByOverlap);
  v("min_region_area", c.min_region_area, "% of the image",
    "smaller regions fuse with the most similar neighbour", range(0.0F, 100.0F), kByOverlap);
}
using IntensityConfig = SegmentConfig<Segmented::intensity>;
using DisparityConfig = SegmentConfig<Segmented::disparity>;

}  // namespace cairn
