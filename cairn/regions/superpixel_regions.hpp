// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/regions/region_graph.hpp>
#include <cairn/regions/runs.hpp>
#include <utility>
#include <vector>

namespace cairn {

/// Labels as a segmentation of `count` regions. add_values(run, region): adds the input of the statistics, the
/// values of the pixels of a run, to the region: their number to valid_count, their sum to mean, and the sum of
/// their squares to variance. Called in raster order.
template <class AddValues>
Segmentation superpixel_regions(Image<RegionId> labels, std::size_t count, const Exec& exec,
                                AddValues add_values) {
  Segmentation result{std::move(labels), std::vector<Region>(count)};
  for_each_run(result.labels, exec, [&](const Run& run) {
    Region& region = result.regions[index(run.label)];
    region.pixel_count += run.length();
    region.box = united(region.box, run.box());
    add_values(run, region);
  });
  for (Region& region : result.regions) {
    if (region.valid_count == 0) continue;
    region.mean /= region.valid_count;
    region.variance = std::max(0.0, region.variance / region.valid_count - region.mean * region.mean);
  }
  return result;
}

}  // namespace cairn
