// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cstdint>
#include <vector>

namespace cairn {

struct FacetsConfig {
  float smoothing_sigma = 0.7F;  // no option, a constant: px; Gaussian smoothing before the edges
  float edge_min = 2.0F;         // grey levels, 0 … 255; basins fuse across borders weaker than this …
                                 // less keeps faint outlines, more makes larger facets
  // No options, constants:
  float noise_factor = 1.0F;     // σ of the noise; … plus this many deviations of it …
  float contrast_share = 14.0F;  // %; … plus this share of the edge that 2 % of the pixels exceed
};
template <class V>
void fields(FacetsConfig& c, V&& v) {
  v("edge_min", c.edge_min, "grey levels",
    "basins fuse across borders whose mean edge is weaker than this, the image's noise and a share of its "
    "clear edges together",
    range(0.0F, 255.0F), when("fusion.method", "evidence"));
}

/// The common border of two facets, a < b. Positions are those of the pixel pairs' midpoints, summed in half
/// pixels.
struct Border {
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::int64_t length = 0;    // pairs of 4-neighbours
  std::int64_t edge_sum = 0;  // of the stronger edge of each pair, in 1/4 grey level
  std::int64_t x2_sum = 0;
  std::int64_t y2_sum = 0;
  [[nodiscard]] double mean_edge() const {
    return static_cast<double>(edge_sum) / static_cast<double>(length);
  }
  [[nodiscard]] double x() const { return static_cast<double>(x2_sum) / static_cast<double>(2 * length); }
  [[nodiscard]] double y() const { return static_cast<double>(y2_sum) / static_cast<double>(2 * length); }
};

/// The image cut into facets: connected pieces that no clear edge runs through. Borders sorted by (a, b).
struct Facets {
  Image<RegionId> labels;  // 0 … count−1 in raster order of their first pixel
  int count = 0;
  std::vector<Border> borders;
};

/// Whether one of the eight pixels around lies in another region.
inline bool beside_border(View<const RegionId> labels, int x, int y) {
  const RegionId here = labels(x, y);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, labels.height() - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, labels.width() - 1); ++u) {
      if (labels(u, v) != here) return true;
    }
  }
  return false;
}

/// The borders between the regions of `labels`, sorted.
std::vector<Border> borders_of(View<const RegionId> labels, View<const std::uint16_t> edges);

/// Watershed of the edges (in colour where there is colour), then each basin fuses with the neighbour across
/// its weakest border where that border's mean edge is below edge_min + noise_factor·noise_sigma +
/// contrast_share·(the edge strength that one pixel in fifty exceeds);
/// borders are recomputed and it is done again until nothing fuses, sixteen times at most. Unlike a
/// comparison of means this follows shading across a plain surface and stops at faint outlines.
/// `noise_sigma`: of `gray`. (docs/stages/facets.md, beyond the paper)
Facets segment_facets(View<const Gray> gray, View<const Rgb> rgb, float noise_sigma,
                      const FacetsConfig& config, const Exec& exec);

/// The facets as a segmentation, with their grey statistics.
Segmentation as_segmentation(const Facets& facets, View<const Gray> gray, const Exec& exec);

/// Fills what is undecided (< 0) from its neighbours, across the weakest borders first: a flooding whose
/// markers are the decided facets. Where no decided facet can be reached, `otherwise`.
std::vector<std::int32_t> flooded(std::vector<std::int32_t> labels, const std::vector<Border>& borders,
                                  std::int32_t otherwise);

}  // namespace cairn
