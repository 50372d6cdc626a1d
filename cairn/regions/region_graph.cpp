// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/gradient.hpp>
#include <cairn/regions/region_graph.hpp>
#include <numeric>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

std::vector<RegionGraph::Node> counted(View<const RegionId> labels, int count,
                                       View<const std::int16_t> values, View<const std::uint8_t> floor) {
  std::vector<RegionGraph::Node> nodes(static_cast<std::size_t>(count));
  const int width = labels.width();
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const label = labels.row(y);
    const std::int16_t* const value = values.row(y);
    const std::uint8_t* const is_floor = floor.empty() ? nullptr : floor.row(y);
    for (int x = 0; x < width;) {
      // A run of one label at a time: the node is fetched once for all of it.
      const int start = x;
      const RegionId id = label[x];
      RegionGraph::Node run;
      do {
        const int v = value[x];
        const bool valid = v != kHole16;
        run.valid_count += valid ? 1 : 0;
        run.sum += valid ? v : 0;
        run.sum_of_squares += valid ? v * v : 0;
        run.is_floor |= is_floor != nullptr && is_floor[x] != 0;
        ++x;
      } while (x < width && label[x] == id);
      run.pixel_count = x - start;
      run.first_pixel = y * width + start;
      run.box = {start, y, x - start, 1};
      nodes[index(id)].absorb(run);
    }
  }
  return nodes;
}

struct Touch {
  std::int32_t a;
  std::int32_t b;
};

/// Which regions touch; a pair may stand there several times, since only repetitions beside each other are
/// left out.
std::vector<Touch> touching(View<const RegionId> labels) {
  std::vector<Touch> touches;
  touches.reserve(static_cast<std::size_t>(labels.size().area() / 4));
  const int width = labels.width();
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const row = labels.row(y);
    const RegionId* const below = y + 1 < labels.height() ? labels.row(y + 1) : row;
    const RegionId* const above = y > 0 ? labels.row(y - 1) : row;
    bool repeats = false;  // this pixel and the one below: the pair of the column before
    for (int x = 0; x < width; ++x) {
      if (row[x] != below[x]) {
        repeats = x > 0 && row[x - 1] == row[x] && below[x - 1] == below[x];
        if (!repeats) touches.push_back({number(row[x]), number(below[x])});
      }
      if (x + 1 < width && row[x] != row[x + 1]) {
        repeats = y > 0 && above[x] == row[x] && above[x + 1] == row[x + 1];
        if (!repeats) touches.push_back({number(row[x]), number(row[x + 1])});
      }
    }
  }
  return touches;
}

/// Compact adjacency from touches: every pair in both directions once, neighbours ascending.
void link(RegionGraph& graph, const std::vector<Touch>& touches) {
  const std::size_t count = graph.nodes.size();
  std::vector<std::int32_t> first(count + 1, 0);
  for (const Touch& touch : touches) {
    ++first[static_cast<std::size_t>(touch.a) + 1];
    ++first[static_cast<std::size_t>(touch.b) + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::int32_t> unsorted(static_cast<std::size_t>(first[count]));
  std::vector<std::int32_t> end(first.begin(), first.end() - 1);
  for (const Touch& touch : touches) {
    unsorted[static_cast<std::size_t>(end[static_cast<std::size_t>(touch.a)]++)] = touch.b;
    unsorted[static_cast<std::size_t>(end[static_cast<std::size_t>(touch.b)]++)] = touch.a;
  }

  // Handing every node, in ascending order, to its neighbours' lists sorts those lists, and repetitions end
  // up side by side. Pairs are symmetric, so the lists have the same lengths as before.
  std::vector<std::int32_t> sorted(unsorted.size());
  std::copy(first.begin(), first.end() - 1, end.begin());
  for (std::size_t a = 0; a < count; ++a) {
    for (auto i = first[a]; i < first[a + 1]; ++i) {
      const auto b = static_cast<std::size_t>(unsorted[static_cast<std::size_t>(i)]);
      const bool has_it =
          end[b] > first[b] && sorted[static_cast<std::size_t>(end[b]) - 1] == static_cast<std::int32_t>(a);
      if (!has_it) sorted[static_cast<std::size_t>(end[b]++)] = static_cast<std::int32_t>(a);
    }
  }

  graph.first_arc.resize(count + 1);
  graph.first_arc[0] = 0;
  for (std::size_t a = 0; a < count; ++a) graph.first_arc[a + 1] = graph.first_arc[a] + (end[a] - first[a]);
  graph.arcs.resize(static_cast<std::size_t>(graph.first_arc[count]));
  for (std::size_t a = 0; a < count; ++a) {
    std::copy(sorted.begin() + first[a], sorted.begin() + end[a], graph.arcs.begin() + graph.first_arc[a]);
  }
}

Region region_of(const RegionGraph::Node& node, double value_scale) {
  return {.pixel_count = static_cast<int>(node.pixel_count),
          .valid_count = static_cast<int>(node.valid_count),
          .box = node.box,
          .mean = node.mean() * value_scale,
          .variance = node.variance() * value_scale * value_scale,
          .is_floor = node.is_floor};
}

}  // namespace

double RegionGraph::Node::mean() const {
  return valid_count > 0 ? static_cast<double>(sum) / static_cast<double>(valid_count) : 0.0;
}

double RegionGraph::Node::variance() const {
  if (valid_count == 0) return 0.0;
  const double m = mean();
  return std::max(0.0, static_cast<double>(sum_of_squares) / static_cast<double>(valid_count) - m * m);
}

void RegionGraph::Node::absorb(const Node& other) {
  first_pixel = pixel_count == 0 ? other.first_pixel : std::min(first_pixel, other.first_pixel);
  pixel_count += other.pixel_count;
  valid_count += other.valid_count;
  sum += other.sum;
  sum_of_squares += other.sum_of_squares;
  box = united(box, other.box);
  is_floor |= other.is_floor;
}

RegionGraph build_graph(View<const RegionId> labels, int count, View<const std::int16_t> values,
                        View<const std::uint8_t> floor, const Exec&) {
  RegionGraph graph;
  graph.nodes = counted(labels, count, values, floor);
  link(graph, touching(labels));
  return graph;
}

Segmentation apply_merges(View<const RegionId> labels, const RegionGraph& graph, const Merges& merged_into,
                          double value_scale, const Exec& exec) {
  const std::size_t count = graph.nodes.size();
  std::vector<RegionGraph::Node> merged(count);
  for (std::size_t i = 0; i < count; ++i)
    merged[static_cast<std::size_t>(merged_into[i])].absorb(graph.nodes[i]);

  std::vector<std::int32_t> survivors;
  for (std::size_t i = 0; i < count; ++i) {
    if (merged[i].pixel_count > 0) survivors.push_back(static_cast<std::int32_t>(i));
  }
  std::sort(survivors.begin(), survivors.end(), [&](std::int32_t a, std::int32_t b) {
    return merged[static_cast<std::size_t>(a)].first_pixel < merged[static_cast<std::size_t>(b)].first_pixel;
  });

  Segmentation result{Image<RegionId>(labels.size(), exec.pool), {}};
  result.regions.reserve(survivors.size());
  std::vector<RegionId> new_id(count);
  for (const std::int32_t survivor : survivors) {
    new_id[static_cast<std::size_t>(survivor)] = RegionId{static_cast<std::int32_t>(result.regions.size())};
    result.regions.push_back(region_of(merged[static_cast<std::size_t>(survivor)], value_scale));
  }
  std::vector<RegionId> relabelled(count);
  for (std::size_t i = 0; i < count; ++i) relabelled[i] = new_id[static_cast<std::size_t>(merged_into[i])];

  parallel_for(exec, labels.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const RegionId* const in = labels.row(y);
      RegionId* const out = result.labels.row(y);
      for (int x = 0; x < labels.width(); ++x) out[x] = relabelled[index(in[x])];
    }
  });
  return result;
}

}  // namespace cairn
