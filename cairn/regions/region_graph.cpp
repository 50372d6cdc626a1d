// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/gradient.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cairn/regions/scratch.hpp>
#include <limits>
#include <numeric>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

/// Where the runs of equal labels in a row end: ends[i] is one past the last pixel of run i. Returns how many
/// there are. Written without a branch, as no processor can foretell where labels change.
int find_runs(const RegionId* label, int width, std::int32_t* ends) {
  int runs = 0;
  for (int x = 0; x + 1 < width; ++x) {
    ends[runs] = x + 1;
    runs += label[x] != label[x + 1] ? 1 : 0;
  }
  ends[runs] = width;
  return runs + 1;
}

/// Sums from the start of a row up to a pixel, itself not counted.
struct Prefix {
  std::int64_t sum = 0;
  std::int64_t sum_of_squares = 0;
  std::int32_t valid_count = 0;
  std::int32_t floor_count = 0;
};

void sum_up(const std::int16_t* value, const std::uint8_t* floor, int width, Prefix* prefix) {
  Prefix p;
  for (int x = 0; x < width; ++x) {
    prefix[x] = p;
    const bool valid = value[x] != kHole16;
    const int v = valid ? value[x] : 0;
    p.sum += v;
    p.sum_of_squares += v * v;
    p.valid_count += valid ? 1 : 0;
    p.floor_count += floor != nullptr && floor[x] != 0 ? 1 : 0;
  }
  prefix[width] = p;
}

/// A row's runs added to the nodes. While counting, a box holds its right and lower end in place of width and
/// height.
void count_row(const RegionId* label, int y, int width, const Prefix* prefix, const std::int32_t* ends,
               int runs, RegionGraph::Node* nodes) {
  int begin = 0;
  for (int i = 0; i < runs; ++i) {
    const int end = ends[i];
    const Prefix& from = prefix[begin];
    const Prefix& to = prefix[end];
    RegionGraph::Node& node = nodes[index(label[begin])];
    node.pixel_count += end - begin;
    node.valid_count += to.valid_count - from.valid_count;
    node.sum += to.sum - from.sum;
    node.sum_of_squares += to.sum_of_squares - from.sum_of_squares;
    node.is_floor |= to.floor_count != from.floor_count;
    node.first_pixel = std::min(node.first_pixel, y * width + begin);
    node.box.x = std::min(node.box.x, begin);
    node.box.y = std::min(node.box.y, y);
    node.box.width = std::max(node.box.width, end);
    node.box.height = std::max(node.box.height, y + 1);
    begin = end;
  }
}

struct Touch {
  std::int32_t a;
  std::int32_t b;
};

/// Pairs of labels side by side in a row. What the row above shows at the same place is left out; without
/// branches, as find_runs(). Returns how many.
int touches_beside(const RegionId* above, const RegionId* row, const std::int32_t* ends, int runs,
                   Touch* touches) {
  int n = 0;
  for (int i = 0; i + 1 < runs; ++i) {
    const int x = ends[i];
    touches[n] = {number(row[x - 1]), number(row[x])};
    n += static_cast<int>((above[x - 1] != row[x - 1]) | (above[x] != row[x]));
  }
  return n;
}

/// Pairs of labels one above the other. What the column before shows is left out.
int touches_below(const RegionId* row, const RegionId* below, int width, Touch* touches) {
  touches[0] = {number(row[0]), number(below[0])};
  int n = row[0] != below[0] ? 1 : 0;
  for (int x = 1; x < width; ++x) {
    touches[n] = {number(row[x]), number(below[x])};
    n += static_cast<int>((row[x] != below[x]) & ((row[x - 1] != row[x]) | (below[x - 1] != below[x])));
  }
  return n;
}

/// Drops most repetitions of pairs: remembers those seen last.
class Recent {
 public:
  /// Keeps the first of each pair, smaller label first; returns how many.
  int distinct(Touch* touches, int count) {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const Touch touch{std::min(touches[i].a, touches[i].b), std::max(touches[i].a, touches[i].b)};
      const auto hash = static_cast<std::uint32_t>(touch.a) * 0x9E3779B1U +
                        static_cast<std::uint32_t>(touch.b) * 0x85EBCA6BU;
      Touch& last = seen_[hash >> (32U - kBits)];
      touches[kept] = touch;
      kept += static_cast<int>((last.a != touch.a) | (last.b != touch.b));
      last = touch;
    }
    return kept;
  }

 private:
  static constexpr unsigned kBits =
      11;  // several times the pairs that two rows show; fits the first-level cache
  std::vector<Touch> seen_ = std::vector<Touch>(1U << kBits, Touch{-1, -1});
};

/// One pass over the rows: counts the nodes and finds which of them touch. Some pairs may stand in the list
/// twice.
ScratchList<Touch> count_and_touch(View<const RegionId> labels, View<const std::int16_t> values,
                                   View<const std::uint8_t> floor, std::vector<RegionGraph::Node>& nodes,
                                   const Exec& exec) {
  constexpr int kFarthest = std::numeric_limits<int>::max();
  const int width = labels.width();
  const auto length = static_cast<std::size_t>(width);
  std::fill(nodes.begin(), nodes.end(),
            RegionGraph::Node{.first_pixel = kFarthest, .box = {kFarthest, kFarthest, 0, 0}});
  std::vector<std::int32_t> ends(length);
  std::vector<Prefix> prefix(length + 1);
  const std::vector<RegionId> nothing(length, RegionId{-1});
  ScratchList<Touch> touches(static_cast<std::size_t>(labels.size().area() / 4), exec.pool);
  Recent recent;
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const row = labels.row(y);
    sum_up(values.row(y), floor.empty() ? nullptr : floor.row(y), width, prefix.data());
    const int runs = find_runs(row, width, ends.data());
    count_row(row, y, width, prefix.data(), ends.data(), runs, nodes.data());
    Touch* const found = touches.room_for(2 * length);
    int count = touches_beside(y > 0 ? labels.row(y - 1) : nothing.data(), row, ends.data(), runs, found);
    if (y + 1 < labels.height()) count += touches_below(row, labels.row(y + 1), width, found + count);
    touches.grown(static_cast<std::size_t>(recent.distinct(found, count)));
  }
  for (RegionGraph::Node& node : nodes) {
    if (node.pixel_count == 0) node = {};
    node.box.width -= node.box.x;
    node.box.height -= node.box.y;
  }
  return touches;
}

/// Compact adjacency from touches: every pair in both directions once, neighbours ascending.
void link(RegionGraph& graph, ScratchList<Touch>& touches, const Exec& exec) {
  const auto count = static_cast<std::int32_t>(graph.nodes.size());
  std::vector<std::int32_t>& first = graph.first_arc;
  first.assign(graph.nodes.size() + 1, 0);
  for (const Touch& touch : touches) {
    ++first[static_cast<std::size_t>(touch.a) + 1];
    ++first[static_cast<std::size_t>(touch.b) + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  Scratch<std::int32_t> unsorted(2 * touches.size(), exec.pool);
  Scratch<std::int32_t> end(graph.nodes.size(), exec.pool);
  std::copy_n(first.begin(), graph.nodes.size(), end.begin());
  for (const Touch& touch : touches) {
    unsorted[end[touch.a]++] = touch.b;
    unsorted[end[touch.b]++] = touch.a;
  }

  // Handing every node, in ascending order, to its neighbours' lists sorts those lists, and repetitions end
  // up side by side, where they are seen. Pairs are symmetric, so the lists have room for the same number.
  Scratch<std::int32_t> sorted(2 * touches.size(), exec.pool);
  std::copy_n(first.begin(), graph.nodes.size(), end.begin());
  for (std::int32_t a = 0; a < count; ++a) {
    for (std::int32_t i = first[static_cast<std::size_t>(a)]; i < first[static_cast<std::size_t>(a) + 1];
         ++i) {
      const std::int32_t b = unsorted[i];
      const std::int32_t at = end[b];
      const bool is_new = at == first[static_cast<std::size_t>(b)] || sorted[at - 1] != a;
      sorted[at] = a;
      end[b] = at + (is_new ? 1 : 0);
    }
  }

  graph.arcs.resize(2 * touches.size());
  std::int32_t size = 0;
  for (std::int32_t a = 0; a < count; ++a) {
    const std::int32_t begin = first[static_cast<std::size_t>(a)];
    const std::int32_t length = end[a] - begin;
    std::copy_n(sorted.begin() + begin, length, graph.arcs.begin() + size);
    first[static_cast<std::size_t>(a)] = size;
    size += length;
  }
  first[graph.nodes.size()] = size;
  graph.arcs.resize(static_cast<std::size_t>(size));
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

RegionGraph build_graph(View<const RegionId> labels, int count, View<const std::int16_t> values,
                        View<const std::uint8_t> floor, const Exec& exec) {
  RegionGraph graph;
  graph.nodes.resize(static_cast<std::size_t>(count));
  ScratchList<Touch> touches = count_and_touch(labels, values, floor, graph.nodes, exec);
  link(graph, touches, exec);
  return graph;
}

Segmentation apply_merges(View<const RegionId> labels, const RegionGraph& graph, const Merges& merged_into,
                          double value_scale, const Exec& exec) {
  const std::size_t count = graph.nodes.size();
  // Survivors move together first, so that what is summed and sorted is as short as their number.
  std::vector<RegionGraph::Node> merged;
  std::vector<std::int32_t> compact(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    std::int32_t& at = compact[static_cast<std::size_t>(merged_into[i])];
    if (at < 0) {
      at = static_cast<std::int32_t>(merged.size());
      merged.emplace_back();
    }
    merged[static_cast<std::size_t>(at)].absorb(graph.nodes[i]);
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    if (merged[i].pixel_count > 0) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return merged[a].first_pixel < merged[b].first_pixel; });

  Segmentation result{Image<RegionId>(labels.size(), exec.pool), {}};
  result.regions.reserve(order.size());
  std::vector<RegionId> new_id(merged.size());
  for (const std::size_t i : order) {
    new_id[i] = RegionId{static_cast<std::int32_t>(result.regions.size())};
    result.regions.push_back(region_of(merged[i], value_scale));
  }
  std::vector<RegionId> relabelled(count);
  for (std::size_t i = 0; i < count; ++i) {
    relabelled[i] = new_id[static_cast<std::size_t>(compact[static_cast<std::size_t>(merged_into[i])])];
  }

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
