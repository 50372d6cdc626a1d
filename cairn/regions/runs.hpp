// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <limits>
#include <vector>

namespace cairn {

/// A run of one label in a row: the pixels first … last − 1. The data of the label is fetched once per run.
struct Run {
  RegionId label{};
  int y = 0;
  int first = 0;
  int last = 0;
  [[nodiscard]] int length() const { return last - first; }
  [[nodiscard]] Rect box() const { return {first, y, length(), 1}; }
};

/// The bounding box of a region whose runs are added in raster order.
struct Extent {
  int left = std::numeric_limits<int>::max();
  int right = 0;
  int top = -1;
  int bottom = 0;
  void add(const Run& run) {
    left = std::min(left, run.first);
    right = std::max(right, run.last);
    top = top < 0 ? run.y : top;
    bottom = run.y + 1;
  }
  [[nodiscard]] Rect box() const { return top < 0 ? Rect{} : Rect{left, top, right - left, bottom - top}; }
};

/// Calls found(run) for each run, in raster order.
template <class Found>
void for_each_run(View<const RegionId> labels, const Exec& exec, Found found) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  std::vector<std::int32_t> ends(slot(labels.width()) + kernels::kListSlack);
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const label = labels.row(y);
    const int count = run.find_runs(label, label, labels.width(), ends.data());
    int first = 0;
    for (int i = 0; i < count; ++i) {
      const int last = ends[slot(i)];
      found(Run{label[first], y, first, last});
      first = last;
    }
  }
}

/// Colour sums over runs; grey, three times, without colour (`rgb` empty). For runs in raster order: prefix
/// sums are computed once per row.
class ColourSums {
 public:
  ColourSums(View<const Gray> gray, View<const Rgb> rgb)
      : gray_(gray), rgb_(rgb), until_(slot(gray.width()) + 1) {}

  std::array<int, 3> of(const Run& run) {
    if (run.y != y_) sum_up(run.y);
    const std::array<int, 3>& before = until_[slot(run.first)];
    const std::array<int, 3>& all = until_[slot(run.last)];
    return {all[0] - before[0], all[1] - before[1], all[2] - before[2]};
  }

 private:
  void sum_up(int y) {
    y_ = y;
    std::array<int, 3> sum{};
    for (int x = 0; x < gray_.width(); ++x) {
      const Rgb colour = rgb_.empty() ? Rgb{gray_(x, y), gray_(x, y), gray_(x, y)} : rgb_(x, y);
      sum = {sum[0] + colour.r, sum[1] + colour.g, sum[2] + colour.b};
      until_[slot(x) + 1] = sum;
    }
  }

  View<const Gray> gray_;
  View<const Rgb> rgb_;
  int y_ = -1;
  std::vector<std::array<int, 3>> until_;
};

}  // namespace cairn
