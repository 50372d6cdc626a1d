// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cstdint>

namespace cairn {

/// The values to segment: grey levels, or px of disparity.
enum class Segmented : std::uint8_t { intensity, disparity };

/// The options of both segmentations of the paper; "value": a grey level 0 … 255, or px of disparity 0 … 64.
template <Segmented values>
struct SegmentConfig {
  static constexpr bool kGrey = values == Segmented::intensity;

  float smoothing_sigma = kGrey ? 0.7F : 0.0F;      // px, 0 … 5; higher for noisy images: fewer regions
  float gradient_threshold = 0.0F;                  // values, 0 = off; higher: fewer basins from noise
  float mean_difference_max = kGrey ? 3.0F : 2.0F;  // values; Eq. 1: higher fuses less similar regions
  float deviation_max = 1.0F;              // σ, 0 … 100; Eq. 2: higher lets the mean of a region drift
  float sigma_min = kGrey ? 2.0F : 0.25F;  // values, ≥ 0.01; higher lets uniform regions grow
  float min_region_area = kGrey ? 0.03F : 0.2F;  // % of the image, 0 … 100; higher leaves fewer fragments
};
template <Segmented values, class V>
void fields(SegmentConfig<values>& c, V&& v) {
  constexpr Condition kByPaper = when("pipeline.method", "paper");
  constexpr bool kGrey = SegmentConfig<values>::kGrey;
  constexpr const char* kUnit = kGrey ? "grey levels" : "px";
  constexpr float kGreatest = kGrey ? 255.0F : 64.0F;
  v("smoothing_sigma", c.smoothing_sigma, "px", "σ of the Gaussian smoothing before the gradient",
    range(0.0F, 5.0F), kByPaper);
  v("gradient_threshold", c.gradient_threshold, kUnit,
    "smallest gradient above 0: suppresses basins from noise", range(0.0F, kGreatest), kByPaper);
  v("mean_difference_max", c.mean_difference_max, kUnit,
    "Eq. 1: largest difference of the means of fusing regions", range(0.0F, kGreatest), kByPaper);
  v("deviation_max", c.deviation_max, "σ", "Eq. 2: largest shift of the mean by a fusion",
    range(0.0F, 100.0F), kByPaper);
  v("sigma_min", c.sigma_min, kUnit, "lower limit of the deviation in Eq. 2", range(0.01F, kGreatest),
    kByPaper);
  v("min_region_area", c.min_region_area, "% of the image",
    "smallest region that is not fused with its most similar neighbour", range(0.0F, 100.0F), kByPaper);
}
using IntensityConfig = SegmentConfig<Segmented::intensity>;
using DisparityConfig = SegmentConfig<Segmented::disparity>;

}  // namespace cairn
