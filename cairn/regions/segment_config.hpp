// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cstdint>

namespace cairn {

/// The values to segment: grey levels, or px of disparity.
enum class SegmentedQuantity : std::uint8_t { intensity, disparity };

/// The options of both segmentations of the paper; "value": a grey level 0 … 255, or px of disparity 0 … 64.
template <SegmentedQuantity values>
struct SegmentConfig {
  static constexpr bool kGrey = values == SegmentedQuantity::intensity;

  float gradient_threshold = 0.0F;                  // values, 0 = off; higher: fewer basins from noise
  float mean_difference_max = kGrey ? 3.0F : 2.0F;  // values; Eq. 1: higher fuses less similar regions
  float deviation_max = 1.0F;  // σ, 0 … 100; Eq. 2: higher lets the mean of a region drift
  // Constants, not options; fitted by lab/search_paper.cpp.
  float smoothing_sigma = kGrey ? 1.5F : 0.0F;   // px; σ of the Gaussian smoothing before the gradient
  float sigma_min = kGrey ? 2.0F : 0.25F;        // values; lower limit of the deviation in Eq. 2
  float min_region_area = kGrey ? 0.03F : 1.0F;  // % of the image; smaller regions fuse with a neighbour
};
template <SegmentedQuantity values, class V>
void fields(SegmentConfig<values>& c, V&& v) {
  constexpr Condition kByPaper = when("pipeline.method", "paper");
  constexpr bool kGrey = SegmentConfig<values>::kGrey;
  constexpr const char* kUnit = kGrey ? "grey levels" : "px";
  constexpr float kMax = kGrey ? 255.0F : 64.0F;
  v("gradient_threshold", c.gradient_threshold, kUnit,
    "smallest gradient above 0: suppresses basins from noise", range(0.0F, kMax), kByPaper);
  v("mean_difference_max", c.mean_difference_max, kUnit,
    "Eq. 1: largest difference of the means of fusing regions", range(0.0F, kMax), kByPaper);
  v("deviation_max", c.deviation_max, "σ", "Eq. 2: largest shift of the mean by a fusion",
    range(0.0F, 100.0F), kByPaper);
}
using IntensityConfig = SegmentConfig<SegmentedQuantity::intensity>;
using DisparityConfig = SegmentConfig<SegmentedQuantity::disparity>;

}  // namespace cairn
