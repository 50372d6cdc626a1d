// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/disjoint_sets.hpp>
#include <cairn/regions/gradient_threshold.hpp>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/split_floor.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/stereo/gradient.hpp>

namespace cairn {
namespace {

constexpr double kPerPixel = 16.0;  // the graph counts in 1/16 px

/// A run of pixels of one kind in a row.
struct Run {
  std::int32_t begin;
  std::int32_t end;
  std::int32_t kind;
};

constexpr std::int32_t kFloor = -1;

/// Appends the runs of a row; a pixel's kind is its basin, or kFloor.
void append_runs(const RegionId* basin, const std::uint8_t* floor, int width, std::vector<Run>& runs) {
  for (int x = 0; x < width;) {
    const bool on_floor = floor[x] != 0;
    Run run{x, x + 1, on_floor ? kFloor : number(basin[x])};
    while (run.end < width && (floor[run.end] != 0) == on_floor && (on_floor || basin[run.end] == basin[x]))
      ++run.end;
    runs.push_back(run);
    x = run.end;
  }
}

}  // namespace

Basins split_floor(const Basins& basins, View<const std::uint8_t> floor, const Exec& exec) {
  const Size size = basins.labels.size();
  std::vector<Run> runs;
  std::vector<std::size_t> row_begin{0};
  for (int y = 0; y < size.height; ++y) {
    append_runs(basins.labels.row(y), floor.row(y), size.width, runs);
    row_begin.push_back(runs.size());
  }
  // The earlier run becomes the root, so roots are first in raster order.
  DisjointSets sets(runs.size());
  std::int32_t floor_run = -1;
  for (std::size_t y = 0; y + 1 < row_begin.size(); ++y) {
    std::size_t above = y > 0 ? row_begin[y - 1] : 0;
    for (std::size_t i = row_begin[y]; i < row_begin[y + 1]; ++i) {
      const auto id = static_cast<std::int32_t>(i);
      if (runs[i].kind == kFloor) {
        if (floor_run < 0) floor_run = id;
        sets.unite(id, floor_run);
        continue;
      }
      while (above < row_begin[y] && runs[above].end <= runs[i].begin) ++above;
      for (std::size_t j = above; j < row_begin[y] && runs[j].begin < runs[i].end; ++j) {
        if (runs[j].kind == runs[i].kind) sets.unite(id, static_cast<std::int32_t>(j));
      }
    }
  }

  Basins result{Image<RegionId>(size, exec.pool), 0};
  std::vector<std::int32_t> labels(runs.size());
  result.count = sets.number(labels.data());
  for (int y = 0; y < size.height; ++y) {
    RegionId* const out = result.labels.row(y);
    for (std::size_t i = row_begin[static_cast<std::size_t>(y)];
         i < row_begin[static_cast<std::size_t>(y) + 1]; ++i) {
      std::fill(out + runs[i].begin, out + runs[i].end, RegionId{labels[i]});
    }
  }
  return result;
}

Image<std::uint8_t> floor_with_holes(const Basins& basins, View<const std::uint8_t> floor,
                                     View<const std::int16_t> values, const Exec& exec) {
  const Size size = basins.labels.size();
  // For each basin: number of floor pixels − number of other pixels with a value.
  std::vector<std::int32_t> balance(slot(basins.count));
  for (int y = 0; y < size.height; ++y) {
    const RegionId* const basin = basins.labels.row(y);
    const std::uint8_t* const on_floor = floor.row(y);
    const std::int16_t* const value = values.row(y);
    for (int x = 0; x < size.width; ++x) {
      const bool counts = value[x] != kHole16;
      balance[index(basin[x])] += on_floor[x] != 0 ? 1 : counts ? -1 : 0;
    }
  }
  Image<std::uint8_t> result(size, exec.pool);
  for (int y = 0; y < size.height; ++y) {
    const RegionId* const basin = basins.labels.row(y);
    const std::uint8_t* const on_floor = floor.row(y);
    const std::int16_t* const value = values.row(y);
    std::uint8_t* const out = result.row(y);
    for (int x = 0; x < size.width; ++x) {
      const bool hole_in_floor = value[x] == kHole16 && balance[index(basin[x])] > 0;
      out[x] = on_floor[x] != 0 || hole_in_floor ? std::uint8_t{255} : std::uint8_t{0};
    }
  }
  return result;
}

Segmentation segment_disparity(const DisparityMap& disparity, View<const std::uint8_t> floor,
                               const DisparityConfig& config, const Exec& exec) {
  const Image<std::int16_t> values = quantised(disparity, exec);
  Image<std::uint16_t> edges = gradient(values, config.smoothing_sigma, exec);
  level_below(config.gradient_threshold * kPerPixel, edges, exec);
  Basins basins = watershed(edges, exec);
  Image<std::uint8_t> whole_floor;
  if (!floor.empty()) {
    whole_floor = floor_with_holes(basins, floor, values, exec);
    basins = split_floor(basins, whole_floor, exec);
  }
  const RegionGraph graph = build_graph(basins.labels, basins.count, values, whole_floor, exec);
  const Merges merges =
      grow_near_to_far(graph,
                       {.mean_difference_max = config.mean_difference_max * kPerPixel,
                        .deviation_max = config.deviation_max,
                        .sigma_min = config.sigma_min * kPerPixel,
                        .min_region_area = pixels_in(config.min_region_area, values.size())},
                       exec);
  return apply_merges(basins.labels, graph, merges, 1.0 / kPerPixel, exec);
}

}  // namespace cairn
