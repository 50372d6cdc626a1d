// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/regions/region_graph.hpp>
#include <utility>
#include <vector>

namespace cairn {

/// Labels as a segmentation of `count` regions. value(x, y): the input of the statistics; NaN does not count.
template <class Value>
Segmentation segmentation_of(Image<RegionId> labels, std::size_t count, Value value) {
  Segmentation result{std::move(labels), std::vector<Region>(count)};
  for (int y = 0; y < result.labels.height(); ++y) {
    const RegionId* const row = result.labels.row(y);
    for (int first = 0; first < result.labels.width();) {
      int last = first + 1;
      while (last < result.labels.width() && row[last] == row[first]) ++last;
      Region& region = result.regions[index(row[first])];
      region.pixel_count += last - first;
      region.box = united(region.box, {first, y, last - first, 1});
      double sum = region.mean;
      double squares = region.variance;
      for (int x = first; x < last; ++x) {
        const double v = value(x, y);
        if (!(v == v)) continue;
        ++region.valid_count;
        sum += v;
        squares += v * v;
      }
      region.mean = sum;
      region.variance = squares;
      first = last;
    }
  }
  for (Region& region : result.regions) {
    if (region.valid_count == 0) continue;
    region.mean /= region.valid_count;
    region.variance = std::max(0.0, region.variance / region.valid_count - region.mean * region.mean);
  }
  return result;
}

}  // namespace cairn
