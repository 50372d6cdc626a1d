// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/growing_regions.hpp>
#include <numeric>
#include <vector>

namespace cairn {
namespace {

struct Arc {
  double mean;  // of the neighbour
  std::int32_t place;
  std::int32_t neighbour;
};

/// The untried arcs of the visited node, cheapest first. Each fusion moves the node's mean and with it the
/// cost of every arc; but the cheapest arc is always the next one below or above the mean. So there are two
/// heaps, one for each side, and only arcs that the mean passes change sides.
class UntriedArcs {
 public:
  void reset(double mean) {
    below_.clear();
    above_.clear();
    mean_ = mean;
  }
  void add(const Arc& arc) {
    if (arc.mean <= mean_) {
      push(below_, arc, Lower());
    } else {
      push(above_, arc, Higher());
    }
  }
  void move_mean(double mean) {
    mean_ = mean;
    while (!above_.empty() && above_.front().mean <= mean_) push(below_, pop(above_, Higher()), Lower());
    while (!below_.empty() && below_.front().mean > mean_) push(above_, pop(below_, Lower()), Higher());
  }
  [[nodiscard]] bool empty() const { return below_.empty() && above_.empty(); }
  Arc take_cheapest() {
    if (below_.empty()) return pop(above_, Higher());
    if (above_.empty()) return pop(below_, Lower());
    const double to_below = mean_ - below_.front().mean;
    const double to_above = above_.front().mean - mean_;
    const bool tie_goes_below = to_below == to_above && below_.front().place < above_.front().place;
    return to_below < to_above || tie_goes_below ? pop(below_, Lower()) : pop(above_, Higher());
  }

 private:
  // Heap order: the arc that compares greatest is at the front.
  struct Lower {
    bool operator()(const Arc& a, const Arc& b) const {
      return a.mean < b.mean || (a.mean == b.mean && a.place > b.place);
    }
  };
  struct Higher {
    bool operator()(const Arc& a, const Arc& b) const {
      return a.mean > b.mean || (a.mean == b.mean && a.place > b.place);
    }
  };
  template <class Order>
  static void push(std::vector<Arc>& heap, const Arc& arc, Order order) {
    heap.push_back(arc);
    std::push_heap(heap.begin(), heap.end(), order);
  }
  template <class Order>
  static Arc pop(std::vector<Arc>& heap, Order order) {
    std::pop_heap(heap.begin(), heap.end(), order);
    const Arc arc = heap.back();
    heap.pop_back();
    return arc;
  }

  std::vector<Arc> below_;
  std::vector<Arc> above_;
  double mean_ = 0;
};

/// Ascending for falling means; similar means may share a key.
std::uint32_t key_of(double mean) {
  return static_cast<std::uint32_t>(~ascending_bits(mean) >> 32U);
}

/// Stable radix sort of the nodes by their keys, in three passes.
void sort_by_keys(ScratchList<Arc>& arcs, const Exec& exec) {
  constexpr std::uint32_t kDigitBits = 11;
  constexpr std::uint32_t kDigits = 1U << kDigitBits;
  ScratchList<Arc> sorted(arcs.size() + 1, exec.pool);
  std::vector<std::int32_t> first(kDigits + 1);
  for (std::uint32_t shift = 0; shift < 32; shift += kDigitBits) {
    const auto digit = [shift](const Arc& arc) { return (key_of(arc.mean) >> shift) & (kDigits - 1); };
    std::fill(first.begin(), first.end(), 0);
    for (const Arc& arc : arcs) ++first[digit(arc) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    sorted.clear();
    Arc* const room = sorted.room_for(arcs.size());
    for (const Arc& arc : arcs) room[first[digit(arc)]++] = arc;
    sorted.grown(arcs.size());
    std::swap(arcs, sorted);
  }
}

/// Descending by mean, ties in raster order; without the nodes that cannot fuse.
ScratchList<Arc> near_to_far(const GrowingRegions& regions, const Exec& exec) {
  ScratchList<Arc> order(slot(regions.count()) + 1, exec.pool);
  for (std::int32_t i = 0; i < regions.count(); ++i) {
    const double mean = regions.mean(i);
    if (mean == mean) order.push_back({mean, regions.place(i), i});
  }
  sort_by_keys(order, exec);
  for (Arc* from = order.begin(); from != order.end();) {
    Arc* const to = std::find_if(
        from, order.end(), [key = key_of(from->mean)](const Arc& arc) { return key_of(arc.mean) != key; });
    const auto before = [](const Arc& a, const Arc& b) {
      return a.mean > b.mean || (a.mean == b.mean && a.place < b.place);
    };
    if (!std::is_sorted(from, to, before)) std::sort(from, to, before);
    from = to;
  }
  return order;
}

/// Working memory of a visit; reused by the next one.
struct Visit {
  explicit Visit(const Exec& exec) : neighbours(0, exec.pool) {}
  UntriedArcs untried;
  ScratchList<std::int32_t> neighbours;  // all neighbours seen in this visit
};

void visit_node(GrowingRegions& regions, std::int32_t node, const GrowCriteria& criteria, Visit& visit) {
  Absorption absorption(regions.brief(node), regions.squares(node), criteria);
  if (!has_near_neighbour(regions, node, absorption)) return;
  visit.neighbours.clear();
  regions.start_visit(node);
  regions.append_new_neighbours(node, visit.neighbours);

  visit.untried.reset(absorption.mean());
  const auto add_from = [&](std::size_t first) {
    for (std::size_t i = first; i < visit.neighbours.size(); ++i) {
      const std::int32_t neighbour = visit.neighbours.begin()[i];
      const double mean = regions.mean(neighbour);
      if (mean == mean) visit.untried.add({mean, regions.place(neighbour), neighbour});
    }
  };
  add_from(0);
  bool grew = false;
  while (!visit.untried.empty()) {
    const Arc arc = visit.untried.take_cheapest();
    // If the cheapest arc fails Eq. (1), all do, and without a fusion the mean does not change.
    if (!absorption.is_near(arc.mean)) break;
    if (!absorption.admits(regions.brief(arc.neighbour))) continue;
    const std::size_t known = visit.neighbours.size();
    regions.append_new_neighbours(arc.neighbour, visit.neighbours);
    add_from(known);
    regions.absorb(node, arc.neighbour);
    absorption.update(regions.brief(node), regions.squares(node));
    visit.untried.move_mean(absorption.mean());
    grew = true;
  }
  if (!grew) return;
  const auto end = std::remove_if(visit.neighbours.begin(), visit.neighbours.end(),
                                  [&](std::int32_t neighbour) { return !regions.is_alive(neighbour); });
  regions.set_neighbours(node, static_cast<std::size_t>(end - visit.neighbours.begin()),
                         [&](std::size_t i) { return visit.neighbours.begin()[i]; });
}

}  // namespace

Merges grow_near_to_far(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec) {
  GrowingRegions regions(graph, exec);
  Visit visit(exec);
  for (const Arc& entry : near_to_far(regions, exec)) {
    if (regions.is_alive(entry.neighbour)) visit_node(regions, entry.neighbour, criteria, visit);
  }
  fuse_small_regions(regions, criteria.min_region_area, exec);
  return regions.merges();
}

}  // namespace cairn
