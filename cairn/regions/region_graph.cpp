// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/gradient.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cairn/regions/scratch.hpp>
#include <limits>
#include <numeric>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

/// What the values of some pixels beside each other sum up to. Small numbers share a word, so that sums up to
/// every pixel of a row are made and looked up fast.
struct GreySums {
  using Packed = std::uint64_t;  // sum · 2⁴⁰ + sum of squares
  static Packed of(Gray value) {
    const Packed v = value;
    return (v << 40U) + v * v;
  }
  static void add(Packed sums, int pixels, RegionGraph::Node& node) {
    node.valid_count += pixels;
    node.sum += static_cast<std::int64_t>(sums >> 40U);
    node.sum_of_squares += static_cast<std::int64_t>(sums & ((Packed{1} << 40U) - 1));
  }
};
struct DisparitySums {
  struct Packed {
    std::int64_t squares = 0;
    // sum · 2³² + valid pixels · 2¹⁶ + floor pixels. Up to the end of a long row it may overflow, which does
    // no harm: the difference of two is right again.
    std::uint64_t rest = 0;
    Packed& operator+=(Packed o) {
      squares += o.squares;
      rest += o.rest;
      return *this;
    }
    Packed operator-(Packed o) const { return {squares - o.squares, rest - o.rest}; }
  };
  static Packed of(std::int16_t value, bool is_floor) {
    const bool valid = value != kHole16;
    const std::int64_t v = valid ? value : 0;
    return {v * v, (static_cast<std::uint64_t>(v) << 32U) + (valid ? 1U << 16U : 0U) + (is_floor ? 1U : 0U)};
  }
  static void add(Packed sums, int, RegionGraph::Node& node) {
    node.valid_count += static_cast<std::int64_t>((sums.rest >> 16U) & 0xFFFF);
    node.sum += static_cast<std::int64_t>(sums.rest) >> 32U;
    node.sum_of_squares += sums.squares;
    node.is_floor |= (sums.rest & 0xFFFF) != 0;
  }
};
constexpr int kMostSummed = 0xFFFF;  // pixels whose sums surely fit

/// A row's runs added to the nodes, from the sums up to each pixel, itself not counted. While counting, a box
/// holds its right and lower end in place of width and height, and no upper one: that is the first pixel's
/// row.
template <class Sums>
void count_row(const RegionId* label, int y, int width, const typename Sums::Packed* up_to,
               const std::int32_t* ends, int runs, RegionGraph::Node* nodes) {
  int begin = 0;
  for (int i = 0; i < runs; ++i) {
    const int end = ends[i];
    RegionGraph::Node& node = nodes[index(label[begin])];
    node.pixel_count += end - begin;
    node.first_pixel = std::min(node.first_pixel, y * width + begin);
    node.box.x = std::min(node.box.x, begin);
    node.box.width = std::max(node.box.width, end);
    node.box.height = y + 1;
    for (; end - begin > kMostSummed; begin += kMostSummed)
      Sums::add(up_to[begin + kMostSummed] - up_to[begin], kMostSummed, node);
    Sums::add(up_to[end] - up_to[begin], end - begin, node);
    begin = end;
  }
}

/// Pairs of regions that touch, the smaller number in `a`.
struct Touches {
  ScratchList<std::int32_t> a;
  ScratchList<std::int32_t> b;

  Touches(std::size_t capacity, const Exec& exec) : a(capacity, exec.pool), b(capacity, exec.pool) {}
  [[nodiscard]] std::size_t size() const { return a.size(); }
  /// Appends what find(room) writes there, at most `most` pairs; it returns how many.
  template <class Find>
  void append(std::size_t most, Find find) {
    std::int32_t* const room = a.room_for(most + kernels::kListSlack);
    const auto found = slot(find(kernels::LabelPairs{room, b.room_for(most + kernels::kListSlack)}));
    a.grown(found);
    b.grown(found);
  }
};

/// One pass over the rows: counts the nodes and finds which of them touch. Some pairs are found more than
/// once. `sums_at(x, y)`: those of one pixel.
template <class Sums, class SumsAt>
Touches count_and_touch(View<const RegionId> labels, std::vector<RegionGraph::Node>& nodes, const Exec& exec,
                        SumsAt sums_at) {
  constexpr int kFarthest = std::numeric_limits<int>::max();
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  const int width = labels.width();
  const std::size_t length = slot(width) + kernels::kListSlack;
  std::fill(nodes.begin(), nodes.end(),
            RegionGraph::Node{.first_pixel = kFarthest, .box = {kFarthest, 0, 0, 0}});
  std::vector<std::int32_t> ends(length);
  std::vector<typename Sums::Packed> up_to(slot(width) + 1);
  const std::vector<RegionId> nothing(slot(width), RegionId{-1});
  Touches touches(static_cast<std::size_t>(labels.size().area() / 4), exec);
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const row = labels.row(y);
    typename Sums::Packed sums{};
    for (int x = 0; x < width; ++x) {
      up_to[slot(x)] = sums;
      sums += sums_at(x, y);
    }
    up_to[slot(width)] = sums;
    const int runs = run.find_runs(row, row, width, ends.data());
    count_row<Sums>(row, y, width, up_to.data(), ends.data(), runs, nodes.data());
    const RegionId* const above = y > 0 ? labels.row(y - 1) : nothing.data();
    touches.append(slot(width),
                   [&](kernels::LabelPairs room) { return run.touches_beside(above, row, width, room); });
    if (y == 0) continue;
    touches.append(slot(width),
                   [&](kernels::LabelPairs room) { return run.touches_below(above, row, width, room); });
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
  return touches;
}

/// Sorts the numbers and keeps each once; returns their end. Lists are short, and mostly in order.
std::int32_t* sort_once(std::int32_t* begin, std::int32_t* end) {
  constexpr std::ptrdiff_t kFew = 24;
  if (end - begin > kFew) {
    std::sort(begin, end);
    return std::unique(begin, end);
  }
  if (begin == end) return end;
  for (std::int32_t* next = begin + 1; next < end; ++next) {
    const std::int32_t moved = *next;
    std::int32_t* at = next;
    for (; at > begin && at[-1] > moved; --at) *at = at[-1];
    *at = moved;
  }
  std::int32_t* last = begin;
  for (const std::int32_t* next = begin + 1; next < end; ++next) {
    last += *next != *last ? 1 : 0;
    *last = *next;
  }
  return last + 1;
}

/// Compact adjacency from touches: every pair in both directions once, neighbours ascending.
void link(RegionGraph& graph, const Touches& touches, const Exec& exec) {
  const auto count = static_cast<std::int32_t>(graph.nodes.size());
  const std::int32_t* const touch_a = touches.a.begin();
  const std::int32_t* const touch_b = touches.b.begin();
  // The larger neighbours of each node, which are half of the work, as they were met.
  Scratch<std::int32_t> end_room(graph.nodes.size() + 1, 0, exec.pool);
  Scratch<std::int32_t> larger_room(touches.size(), exec.pool);
  std::int32_t* const end = end_room.data();
  std::int32_t* const larger = larger_room.data();
  for (std::size_t i = 0; i < touches.size(); ++i) ++end[touch_a[i] + 1];
  std::partial_sum(end, end + count + 1, end);
  for (std::size_t i = 0; i < touches.size(); ++i) larger[end[touch_a[i]]++] = touch_b[i];

  // Each list in order and without repetitions, all without gaps; end[a] becomes how many a has.
  graph.first_arc.assign(graph.nodes.size() + 1, 0);
  std::int32_t* const first = graph.first_arc.data();
  std::int32_t* kept = larger;
  std::int32_t* list = larger;
  for (std::int32_t a = 0; a < count; ++a) {
    std::int32_t* const list_end = larger + end[a];
    const std::int32_t* const last = sort_once(list, list_end);
    end[a] = static_cast<std::int32_t>(last - list);
    first[a + 1] += end[a];
    for (const std::int32_t* b = list; b != last; ++b) {
      ++first[*b + 1];
      *kept++ = *b;
    }
    list = list_end;
  }
  std::partial_sum(first, first + count + 1, first);

  // A node's smaller neighbours come to it in ascending order, and before its larger ones.
  graph.arcs.resize(slot(first[count]));
  Scratch<std::int32_t> next_room(graph.nodes.size(), exec.pool);
  std::int32_t* const next = next_room.data();
  std::int32_t* const arcs = graph.arcs.data();
  std::copy_n(first, count, next);
  const std::int32_t* b = larger;
  for (std::int32_t a = 0; a < count; ++a) {
    std::int32_t own = next[a];
    for (std::int32_t i = 0; i < end[a]; ++i, ++b) {
      arcs[own++] = *b;
      arcs[next[*b]++] = a;
    }
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

RegionGraph build_graph(View<const RegionId> labels, int count, View<const std::int16_t> values,
                        View<const std::uint8_t> floor, const Exec& exec) {
  RegionGraph graph;
  graph.nodes.resize(slot(count));
  const auto sums_at = [&](int x, int y) {
    return DisparitySums::of(values(x, y), !floor.empty() && floor(x, y) != 0);
  };
  link(graph, count_and_touch<DisparitySums>(labels, graph.nodes, exec, sums_at), exec);
  return graph;
}

RegionGraph build_graph(View<const RegionId> labels, int count, View<const Gray> values, const Exec& exec) {
  RegionGraph graph;
  graph.nodes.resize(slot(count));
  const auto sums_at = [&](int x, int y) { return GreySums::of(values(x, y)); };
  link(graph, count_and_touch<GreySums>(labels, graph.nodes, exec, sums_at), exec);
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
