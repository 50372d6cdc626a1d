// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cstdint>

namespace cairn {

struct SuperpixelsConfig {
  int count = 250;  // pieces; more of them follow small things, and take longer
};
template <class V>
void fields(SuperpixelsConfig& c, V&& v) {
  v("count", c.count, "",
    "how many pieces the image is cut into at most; more follow small things, and take longer",
    range(1, 100000), when("fusion.method", "hierarchy"));
}

/// The image cut into connected pieces that no clear edge of brightness, colour or depth runs through.
struct Superpixels {
  Image<RegionId> labels;  // 0 … count−1 in raster order of their first pixel
  int count = 0;
  Image<std::uint16_t> edges;  // of the picture alone, in 1/4 grey level: edge_strength()
};

/// A watershed of the picture's edges (edge_strength(), σ = 0.7 px), to each pixel of which the largest step
/// of disparity to one of its four neighbours adds 2 grey levels a px (at most 8, rounded to 1/4), so that
/// depth cuts where brightness does not; what is then below 1 + noise_sigma grey levels (rounded down to 1/4)
/// counts as 0. Then basins fuse two by two, those of least
///
///     (mean edge along the common border + 1/2 grey level) · sqrt(area of the smaller one)
///
/// first, until `count` are left: small and alike before large or different. The edge between two pixels is
/// the stronger one of theirs, depth included. Ties: the border that the picture's rows show first, from each
/// pixel to the right before down. `rgb` may be empty; `disparity_px`: NaN for holes, which add nothing.
/// (docs/stages/superpixels.md, beyond the paper)
Superpixels cut_superpixels(View<const Gray> gray, View<const Rgb> rgb, View<const float> disparity_px,
                            float noise_sigma, const SuperpixelsConfig& config, const Exec& exec);

/// The superpixels as a segmentation, with their grey statistics.
Segmentation segmentation_of(const Superpixels& superpixels, View<const Gray> left, const Exec& exec);

}  // namespace cairn
