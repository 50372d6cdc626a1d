// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <limits>
#include <numeric>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

/// Sums over adjacent pixels of a row, as differences of prefix sums.
class GreySums {
 public:
  GreySums(View<const Gray> values, const kernels::LabelKernels& run)
      : values_(values), run_(run), up_to_(slot(values.width()) + 1) {}

  void sum_up(int y) { run_.sum_grey(values_.row(y), values_.width(), up_to_.data()); }
  void add(int begin, int end, RegionGraph::Node& node) const {
    const std::uint64_t sums = up_to_[slot(end)] - up_to_[slot(begin)];
    node.valid_count += end - begin;
    node.sum += static_cast<std::int64_t>(sums >> 40U);
    node.sum_of_squares += static_cast<std::int64_t>(sums & ((std::uint64_t{1} << 40U) - 1));
  }

 private:
  View<const Gray> values_;
  const kernels::LabelKernels& run_;
  std::vector<std::uint64_t> up_to_;
};
class DisparitySums {
 public:
  DisparitySums(View<const std::int16_t> values, View<const std::uint8_t> floor,
                const kernels::LabelKernels& run)
      : values_(values),
        floor_(floor),
        run_(run),
        up_to_(slot(values.width()) + 1),
        squares_up_to_(slot(values.width()) + 1) {}

  void sum_up(int y) {
    run_.sum_disparities(values_.row(y), floor_.empty() ? nullptr : floor_.row(y), values_.width(),
                         up_to_.data(), squares_up_to_.data());
  }
  void add(int begin, int end, RegionGraph::Node& node) const {
    const std::uint64_t sums = up_to_[slot(end)] - up_to_[slot(begin)];
    node.valid_count += static_cast<std::int64_t>((sums >> 16U) & 0xFFFF);
    node.sum += static_cast<std::int64_t>(sums) >> 32U;
    node.sum_of_squares += static_cast<std::int64_t>(squares_up_to_[slot(end)] - squares_up_to_[slot(begin)]);
    node.is_floor |= (sums & 0xFFFF) != 0;
  }

 private:
  View<const std::int16_t> values_;
  View<const std::uint8_t> floor_;
  const kernels::LabelKernels& run_;
  std::vector<std::uint64_t> up_to_;
  std::vector<std::uint64_t> squares_up_to_;
};
constexpr int kMaxSummed = 0xFFFF;  // pixels; up to here no sum overflows

/// Adds a row's runs to the nodes. Until the end, a box holds its right and lower edge instead of width and
/// height; the upper edge follows from the first pixel.
template <class Sums>
void count_row(const RegionId* label, int y, int width, const Sums& sums, const std::int32_t* ends, int runs,
               RegionGraph::Node* nodes) {
  int begin = 0;
  for (int i = 0; i < runs; ++i) {
    const int end = ends[i];
    RegionGraph::Node& node = nodes[index(label[begin])];
    node.pixel_count += end - begin;
    node.first_pixel = std::min(node.first_pixel, y * width + begin);
    node.box.x = std::min(node.box.x, begin);
    node.box.width = std::max(node.box.width, end);
    node.box.height = y + 1;
    for (; end - begin > kMaxSummed; begin += kMaxSummed) sums.add(begin, begin + kMaxSummed, node);
    sums.add(begin, end, node);
    begin = end;
  }
}

/// Sizes, boxes and sums of the regions.
template <class Sums>
std::vector<RegionGraph::Node> count_nodes(View<const RegionId> labels, int count, Sums sums,
                                           const kernels::LabelKernels& run) {
  constexpr int kMaxDistance = std::numeric_limits<int>::max();
  const int width = labels.width();
  std::vector<RegionGraph::Node> nodes(
      slot(count), RegionGraph::Node{.first_pixel = kMaxDistance, .box = {kMaxDistance, 0, 0, 0}});
  std::vector<std::int32_t> ends(slot(width) + kernels::kListSlack);
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const row = labels.row(y);
    sums.sum_up(y);
    const int runs = run.find_runs(row, row, width, ends.data());
    count_row(row, y, width, sums, ends.data(), runs, nodes.data());
  }
  for (RegionGraph::Node& node : nodes) {
    if (node.pixel_count == 0) {
      node = {};
      continue;
    }
    node.box.y = node.first_pixel / width;
    node.box.width -= node.box.x;
    node.box.height -= node.box.y;
  }
  return nodes;
}

/// Pairs of touching regions, with a < b.
struct Touches {
  ScratchList<std::int32_t> a;
  ScratchList<std::int32_t> b;

  Touches(std::size_t capacity, const Exec& exec) : a(capacity, exec.pool), b(capacity, exec.pool) {}
  [[nodiscard]] std::size_t size() const { return a.size(); }
  /// Appends the pairs that find(room) writes and counts, at most `most`.
  template <class Find>
  void append(std::size_t most, Find find) {
    std::int32_t* const room = a.room_for(most + kernels::kListSlack);
    const auto found = slot(find(kernels::LabelPairs{room, b.room_for(most + kernels::kListSlack)}));
    a.grown(found);
    b.grown(found);
  }
};

/// All touching regions; some pairs are found repeatedly.
Touches find_touches(View<const RegionId> labels, const kernels::LabelKernels& run, const Exec& exec) {
  const int width = labels.width();
  const std::vector<RegionId> nothing(slot(width), RegionId{-1});
  Touches touches(static_cast<std::size_t>(labels.size().area() / 4), exec);
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const row = labels.row(y);
    const RegionId* const above = y > 0 ? labels.row(y - 1) : nothing.data();
    touches.append(slot(width),
                   [&](kernels::LabelPairs room) { return run.touches_right(above, row, width, room); });
    if (y == 0) continue;
    touches.append(slot(width),
                   [&](kernels::LabelPairs room) { return run.touches_below(above, row, width, room); });
  }
  return touches;
}

/// A pair of touching regions.
struct Pair {
  std::int32_t a;
  std::int32_t b;
};

/// The pairs grouped by `a`, without duplicates, in no particular order within a group. Also counts the pairs
/// of each node as `a` and as `b`.
Scratch<Pair> distinct(const Touches& touches, std::int32_t* counts_a, std::int32_t* counts_b,
                       std::int32_t nodes, std::size_t& count, const Exec& exec) {
  const std::int32_t* const touch_a = touches.a.begin();
  const std::int32_t* const touch_b = touches.b.begin();
  Scratch<std::int32_t> next_room(slot(nodes) + 1, 0, exec.pool);
  std::int32_t* const next = next_room.data();
  for (std::size_t i = 0; i < touches.size(); ++i) ++next[touch_a[i] + 1];
  std::partial_sum(next, next + nodes + 1, next);
  Scratch<Pair> pairs(touches.size(), exec.pool);
  Pair* const grouped = pairs.data();
  for (std::size_t i = 0; i < touches.size(); ++i) grouped[next[touch_a[i]]++] = {touch_a[i], touch_b[i]};

  Scratch<std::int32_t> last_room(slot(nodes), -1, exec.pool);
  std::int32_t* const last_a = last_room.data();  // the last `a` seen with each `b`
  count = 0;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const auto [a, b] = grouped[i];
    const std::int32_t is_new = last_a[b] != a ? 1 : 0;
    last_a[b] = a;
    counts_a[a] += is_new;
    counts_b[b] += is_new;
    grouped[count] = {a, b};
    count += slot(is_new);
  }
  return pairs;
}

/// Compact adjacency from touches: every pair in both directions once, neighbours ascending. A radix sort:
/// grouping by `a`, then by `b`, then by `a` again leaves each list in order without a comparison.
void link(RegionGraph& graph, std::int32_t nodes, const Touches& touches, const Exec& exec) {
  Scratch<std::int32_t> larger_room(slot(nodes), 0, exec.pool);
  Scratch<std::int32_t> smaller_room(slot(nodes), 0, exec.pool);
  std::int32_t* const larger = larger_room.data();    // first the number of neighbours of a node …
  std::int32_t* const smaller = smaller_room.data();  // … then the place of the next one
  std::size_t count = 0;
  const Scratch<Pair> by_smaller = distinct(touches, larger, smaller, nodes, count, exec);

  // Lists start with the smaller neighbours.
  graph.first_arc.resize(slot(nodes) + 1);
  std::int32_t* const first = graph.first_arc.data();
  Scratch<std::int32_t> before_room(slot(nodes), exec.pool);
  std::int32_t* const larger_before = before_room.data();
  std::int32_t smaller_sum = 0;
  std::int32_t larger_sum = 0;
  for (std::int32_t i = 0; i < nodes; ++i) {
    const std::int32_t smaller_count = smaller[i];
    const std::int32_t larger_count = larger[i];
    first[i] = smaller_sum + larger_sum;
    smaller[i] = smaller_sum;
    larger[i] = first[i] + smaller_count;
    larger_before[i] = larger_sum;
    smaller_sum += smaller_count;
    larger_sum += larger_count;
  }
  first[nodes] = smaller_sum + larger_sum;

  Scratch<Pair> by_larger_room(count, exec.pool);
  Pair* const by_larger = by_larger_room.data();
  for (const Pair* pair = by_smaller.begin(); pair != by_smaller.begin() + count; ++pair)
    by_larger[smaller[pair->b]++] = *pair;
  graph.arcs.resize(2 * count);
  std::int32_t* const arcs = graph.arcs.data();
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b] = by_larger[i];
    arcs[static_cast<std::int32_t>(i) + larger_before[b]] = a;
    arcs[larger[a]++] = b;
  }
}

/// Nodes and arcs are independent and take about the same time, so they are computed concurrently.
template <class Sums>
RegionGraph count_and_link(View<const RegionId> labels, int count, const Sums& sums, const Exec& exec) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  RegionGraph graph;
  parallel_for(exec, 2, 1, [&](int first, int last) {
    if (first == 0) graph.nodes = count_nodes(labels, count, sums, run);
    if (last == 2) link(graph, count, find_touches(labels, run, exec), exec);
  });
  return graph;
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
  return count_and_link(labels, count, DisparitySums(values, floor, kernels::label_kernels(exec)), exec);
}

RegionGraph build_graph(View<const RegionId> labels, int count, View<const Gray> values, const Exec& exec) {
  return count_and_link(labels, count, GreySums(values, kernels::label_kernels(exec)), exec);
}

Segmentation apply_merges(View<const RegionId> labels, const RegionGraph& graph, const Merges& merged_into,
                          double value_scale, const Exec& exec) {
  const std::size_t count = graph.nodes.size();
  // Compacts the survivors first, so that sums and sorting cover only these.
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
