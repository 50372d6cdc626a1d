// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/core/geometry.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cstdint>
#include <vector>

namespace cairn {

/// A set of connected pixels. Mean and variance over the valid pixels (holes never count).
struct Region {
  int pixel_count = 0;
  int valid_count = 0;  // pixels with a value; without any, mean and variance are 0
  Rect box;
  double mean = 0;
  double variance = 0;         // population variance
  bool is_floor = false;       // the one floor region of a disparity segmentation
  bool is_background = false;  // everything but the objects
};

/// The result of a segmentation: the region of each pixel, 0 … regions.size()−1 in raster order of their
/// first pixels.
struct Segmentation {
  Image<RegionId> labels;
  std::vector<Region> regions;
};

/// Regions and their adjacency (4-neighbourhood), for region growing. Sums are integers, so the statistics do
/// not depend on the order of additions.
struct RegionGraph {
  struct Node {
    std::int64_t pixel_count = 0;
    std::int64_t valid_count = 0;
    std::int64_t sum = 0;
    std::int64_t sum_of_squares = 0;
    int first_pixel = 0;  // y·width + x of its first pixel in raster order
    Rect box;
    bool is_floor = false;
    [[nodiscard]] double mean() const {
      return valid_count > 0 ? static_cast<double>(sum) / static_cast<double>(valid_count) : 0.0;
    }
    [[nodiscard]] double variance() const {
      if (valid_count == 0) return 0.0;
      const double m = mean();
      return std::max(0.0, static_cast<double>(sum_of_squares) / static_cast<double>(valid_count) - m * m);
    }
    void absorb(const Node& other) {
      first_pixel = pixel_count == 0 ? other.first_pixel : std::min(first_pixel, other.first_pixel);
      pixel_count += other.pixel_count;
      valid_count += other.valid_count;
      sum += other.sum;
      sum_of_squares += other.sum_of_squares;
      box = united(box, other.box);
      is_floor |= other.is_floor;
    }
  };
  std::vector<Node> nodes;
  std::vector<std::int32_t>
      first_arc;  // arcs of node i: arcs[first_arc[i]] … arcs[first_arc[i+1] − 1], ascending
  std::vector<std::int32_t> arcs;
};

/// Builds the graph of the regions of `labels` (ids 0 … count−1). `values`: the input of the statistics;
/// kHole16 = no value. `floor` (may be empty): non-zero pixels are floor; a region with a floor pixel is
/// floor (the caller splits basins along the floor first).
RegionGraph build_graph(View<const RegionId> labels, int count, View<const std::int16_t> values,
                        View<const std::uint8_t> floor, const Exec& exec);

/// The same for grey levels: every pixel has a value, and there is no floor.
RegionGraph build_graph(View<const RegionId> labels, int count, View<const Gray> values, const Exec& exec);

/// The outcome of region growing: merged_into[i] = the surviving id, i itself if it survived.
using Merges = std::vector<std::int32_t>;

/// Renumbers the survivors in raster order of their first pixel and writes labels and statistics.
Segmentation apply_merges(View<const RegionId> labels, const RegionGraph& graph, const Merges& merged_into,
                          double value_scale, const Exec& exec);

}  // namespace cairn
