// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>

namespace cairn {

/// A stretch of one label in a row: the pixels first … last − 1. What is known of the label is fetched once
/// for all of them.
struct Run {
  RegionId label{};
  int y = 0;
  int first = 0;
  int last = 0;
  [[nodiscard]] int length() const { return last - first; }
  [[nodiscard]] Rect box() const { return {first, y, length(), 1}; }
};

/// Calls found(run) for each run, in raster order.
template <class Found>
void for_each_run(View<const RegionId> labels, Found found) {
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const label = labels.row(y);
    for (int x = 0; x < labels.width();) {
      const int first = x;
      while (x < labels.width() && label[x] == label[first]) ++x;
      found(Run{label[first], y, first, x});
    }
  }
}

/// The run's colours, summed; its grey three times where there is no colour (`rgb` empty).
inline std::array<int, 3> colour_sum(View<const Gray> gray, View<const Rgb> rgb, const Run& run) {
  if (rgb.empty()) {
    const Gray* const row = gray.row(run.y);
    int sum = 0;
    for (int x = run.first; x < run.last; ++x) sum += row[x];
    return {sum, sum, sum};
  }
  const Rgb* const row = rgb.row(run.y);
  std::array<int, 3> sum{};
  for (int x = run.first; x < run.last; ++x) {
    sum[0] += row[x].r;
    sum[1] += row[x].g;
    sum[2] += row[x].b;
  }
  return sum;
}

}  // namespace cairn
