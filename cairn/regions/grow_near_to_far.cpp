// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/growing_regions.hpp>
#include <vector>

namespace cairn {
namespace {

struct Arc {
  double mean;  // of the neighbour
  std::int32_t place;
  std::int32_t neighbour;
};

/// The untried arcs of the visited node, cheapest first. Its mean moves with every fusion and takes all arc
/// values along; but the cheapest arc is always the first one below the mean or the first one above it. So
/// two heaps, one for each side, and only arcs that the mean passes change sides.
class UntriedArcs {
 public:
  void reset(double mean) {
    below_.clear();
    above_.clear();
    mean_ = mean;
  }
  void add(const Arc& arc) { arc.mean <= mean_ ? push(below_, arc, lower) : push(above_, arc, higher); }
  void move_mean(double mean) {
    mean_ = mean;
    while (!above_.empty() && above_.front().mean <= mean_) push(below_, pop(above_, higher), lower);
    while (!below_.empty() && below_.front().mean > mean_) push(above_, pop(below_, lower), higher);
  }
  [[nodiscard]] bool empty() const { return below_.empty() && above_.empty(); }
  Arc take_cheapest() {
    if (below_.empty()) return pop(above_, higher);
    if (above_.empty()) return pop(below_, lower);
    const double to_below = mean_ - below_.front().mean;
    const double to_above = above_.front().mean - mean_;
    const bool tie_goes_below = to_below == to_above && below_.front().place < above_.front().place;
    return to_below < to_above || tie_goes_below ? pop(below_, lower) : pop(above_, higher);
  }

 private:
  // Heap orders: the arc that compares greatest is in front.
  static bool lower(const Arc& a, const Arc& b) {
    return a.mean < b.mean || (a.mean == b.mean && a.place > b.place);
  }
  static bool higher(const Arc& a, const Arc& b) {
    return a.mean > b.mean || (a.mean == b.mean && a.place > b.place);
  }
  using Order = bool (*)(const Arc&, const Arc&);
  static void push(std::vector<Arc>& heap, const Arc& arc, Order order) {
    heap.push_back(arc);
    std::push_heap(heap.begin(), heap.end(), order);
  }
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

/// From the highest mean to the lowest, ties in raster order. Nodes that cannot fuse are left out.
std::vector<Arc> near_to_far(const GrowingRegions& regions) {
  std::vector<Arc> order;
  for (std::int32_t i = 0; i < regions.count(); ++i) {
    const GrowingRegions::Brief& brief = regions.brief(i);
    if (brief.mean == brief.mean) order.push_back({brief.mean, brief.place, i});
  }
  std::sort(order.begin(), order.end(), [](const Arc& a, const Arc& b) {
    return a.mean > b.mean || (a.mean == b.mean && a.place < b.place);
  });
  return order;
}

/// The lists of a visit; they keep their memory from one visit to the next.
struct Visit {
  explicit Visit(const Exec& exec) : neighbours(0, exec.pool) {}
  UntriedArcs untried;
  ScratchList<std::int32_t> neighbours;  // every one that the visit saw
};

void visit_node(GrowingRegions& regions, std::int32_t node, const GrowCriteria& criteria, Visit& visit) {
  Absorption absorption(regions.sums(node), criteria);
  visit.untried.reset(absorption.mean());
  visit.neighbours.clear();
  const auto add_neighbours_of = [&](std::int32_t region) {
    const std::size_t known = visit.neighbours.size();
    regions.append_new_neighbours(region, visit.neighbours);
    for (std::size_t i = known; i < visit.neighbours.size(); ++i) {
      const std::int32_t neighbour = visit.neighbours.begin()[i];
      const GrowingRegions::Brief& brief = regions.brief(neighbour);
      if (brief.mean == brief.mean) visit.untried.add({brief.mean, brief.place, neighbour});
    }
  };
  regions.start_visit(node);
  add_neighbours_of(node);
  bool grew = false;
  while (!visit.untried.empty()) {
    const Arc arc = visit.untried.take_cheapest();
    // Once the cheapest arc is beyond Eq. (1), so are all, and as nothing fuses nothing moves the mean.
    if (!absorption.is_near(arc.mean)) break;
    if (!absorption.admits(regions.sums(arc.neighbour))) continue;
    add_neighbours_of(arc.neighbour);
    regions.absorb(node, arc.neighbour);
    absorption.update(regions.sums(node));
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
  for (const Arc& entry : near_to_far(regions)) {
    if (regions.is_alive(entry.neighbour)) visit_node(regions, entry.neighbour, criteria, visit);
  }
  fuse_small_regions(regions, criteria.min_region_area, exec);
  return regions.merges();
}

}  // namespace cairn
