// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/image/gradient.hpp>
#include <cairn/regions/gradient_threshold.hpp>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/watershed.hpp>

namespace cairn {
Segmentation segment_intensity(View<const Gray> image, const IntensityConfig& config, const Exec& exec) {
  Image<std::uint16_t> edges = gradient(image, config.smoothing_sigma, exec);
  level_below(config.gradient_threshold, edges, exec);
  const Basins basins = watershed(edges, exec);
  const RegionGraph graph = build_graph(basins.labels, basins.count, image, exec);
  const Merges merges = grow_statistical(graph,
                                         {.mean_difference_max = config.mean_difference_max,
                                          .deviation_max = config.deviation_max,
                                          .sigma_min = config.sigma_min,
                                          .min_region_area = pixels_in(config.min_region_area, image.size())},
                                         exec);
  return apply_merges(basins.labels, graph, merges, 1.0, exec);
}

}  // namespace cairn
