// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/regions/gradient.hpp>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/watershed.hpp>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// Grey levels in the type whose statistics the graph keeps.
Image<std::int16_t> widened(View<const Gray> image, const Exec& exec) {
  Image<std::int16_t> result(image.size(), exec.pool);
  parallel_for(exec, image.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const Gray* const in = image.row(y);
      std::int16_t* const out = result.row(y);
      for (int x = 0; x < image.width(); ++x) out[x] = in[x];
    }
  });
  return result;
}

}  // namespace

Segmentation segment_intensity(View<const Gray> image, const IntensityConfig& config, const Exec& exec) {
  const Image<std::uint16_t> edges = gradient(image, config.smoothing_sigma, exec);
  const Basins basins = watershed(edges, exec);
  const Image<std::int16_t> values = widened(image, exec);
  const RegionGraph graph = build_graph(basins.labels, basins.count, values, {}, exec);
  const Merges merges = grow_statistical(graph,
                                         {.mean_difference_max = config.mean_difference_max,
                                          .deviation_max = config.deviation_max,
                                          .sigma_min = config.sigma_min,
                                          .min_region_area = pixels_in(config.min_region_area, image.size())},
                                         exec);
  return apply_merges(basins.labels, graph, merges, 1.0, exec);
}

}  // namespace cairn
