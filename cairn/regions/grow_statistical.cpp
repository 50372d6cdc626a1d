// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/growing_regions.hpp>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace cairn {
namespace {

/// A region with its place in raster order before it, so that sorting needs no look at the nodes.
using Placed = std::uint64_t;
Placed placed(const GrowingRegions& regions, int region) {
  return (static_cast<std::uint64_t>(regions.place(region)) << 32U) | static_cast<std::uint32_t>(region);
}
int region_of(Placed entry) {
  return static_cast<int>(entry & 0xFFFFFFFFU);
}

/// The buffers of a visit; they keep their memory from one visit to the next.
struct Visit {
  std::vector<Placed> neighbours;
  std::vector<Placed> gained;
  std::vector<Placed> merged;
  std::vector<std::int32_t> final_neighbours;
};

/// Lets `region` grow; false where nothing fused.
bool grow(GrowingRegions& regions, int region, const GrowCriteria& criteria, Visit& visit) {
  Absorption absorption(regions.node(region), criteria);
  if (!absorption.may_absorb()) return false;
  visit.neighbours.clear();
  regions.start_visit(region);
  regions.for_each_new_neighbour(region, [&](int n) { visit.neighbours.push_back(placed(regions, n)); });
  std::sort(visit.neighbours.begin(), visit.neighbours.end());

  for (bool grew = false;; grew = true) {
    visit.gained.clear();
    std::size_t kept = 0;
    for (const Placed entry : visit.neighbours) {
      const int neighbour = region_of(entry);
      if (absorption.admits(regions.node(neighbour), regions.mean(neighbour))) {
        regions.for_each_new_neighbour(neighbour, [&](int n) { visit.gained.push_back(placed(regions, n)); });
        regions.absorb(region, neighbour);
        absorption.update(regions.node(region));
      } else {
        visit.neighbours[kept++] = entry;
      }
    }
    if (kept == visit.neighbours.size()) return grew;
    visit.neighbours.resize(kept);
    std::sort(visit.gained.begin(), visit.gained.end());
    visit.merged.resize(kept + visit.gained.size());
    std::merge(visit.neighbours.begin(), visit.neighbours.end(), visit.gained.begin(), visit.gained.end(),
               visit.merged.begin());
    visit.neighbours.swap(visit.merged);
  }
}

/// One pass over all living regions; false where nothing fused. Regions whose own and whose neighbours'
/// statistics have not changed since they were last visited would refuse the same neighbours again, so they
/// are passed over: `stale` marks the others.
bool pass(GrowingRegions& regions, const GrowCriteria& criteria, std::vector<std::uint8_t>& stale,
          Visit& visit) {
  std::vector<Placed> order;
  for (int i = 0; i < regions.count(); ++i) {
    if (regions.is_alive(i)) order.push_back(placed(regions, i));
  }
  if (!std::is_sorted(order.begin(), order.end())) std::sort(order.begin(), order.end());
  bool fused = false;
  for (const Placed entry : order) {
    const int region = region_of(entry);
    if (!regions.is_alive(region) || stale[static_cast<std::size_t>(region)] == 0) continue;
    stale[static_cast<std::size_t>(region)] = 0;
    if (!grow(regions, region, criteria, visit)) continue;
    fused = true;
    visit.final_neighbours.clear();
    for (const Placed neighbour : visit.neighbours) {
      visit.final_neighbours.push_back(region_of(neighbour));
      stale[static_cast<std::size_t>(region_of(neighbour))] = 1;
    }
    regions.set_neighbours(region, visit.final_neighbours);
  }
  return fused;
}

/// How far a neighbour is from being the most similar one; less is better, ties are decided by its place.
double dissimilarity(const GrowingRegions& regions, int region, int neighbour) {
  if (regions.node(neighbour).valid_count == 0) return std::numeric_limits<double>::infinity();
  if (regions.node(region).valid_count == 0) return regions.mean(neighbour);
  return std::abs(regions.mean(region) - regions.mean(neighbour));
}

/// The neighbour that a small region fuses with; −1 where all are floor.
int most_similar(GrowingRegions& regions, int region) {
  int best = -1;
  double least = 0;
  regions.start_visit(region);
  regions.for_each_new_neighbour(region, [&](int neighbour) {
    if (regions.node(neighbour).is_floor) return;
    const double value = dissimilarity(regions, region, neighbour);
    if (best < 0 || value < least || (value == least && regions.place(neighbour) < regions.place(best))) {
      best = neighbour;
      least = value;
    }
  });
  return best;
}

}  // namespace

void fuse_small_regions(GrowingRegions& regions, std::int64_t min_region_area) {
  // Smallest first. A region that grew meanwhile has been entered again with its new size; its old entry is
  // passed over.
  using Entry = std::tuple<std::int64_t, int, int>;  // pixels, place, region
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> small;
  const auto enter = [&](int region) {
    const RegionGraph::Node& node = regions.node(region);
    if (node.is_floor || (node.pixel_count >= min_region_area && node.valid_count > 0)) return;
    small.emplace(node.pixel_count, regions.place(region), region);
  };
  for (int i = 0; i < regions.count(); ++i) {
    if (regions.is_alive(i)) enter(i);
  }
  while (!small.empty()) {
    const auto [pixels, place, region] = small.top();
    small.pop();
    if (!regions.is_alive(region) || regions.node(region).pixel_count != pixels) continue;
    const int target = most_similar(regions, region);
    if (target < 0) continue;
    regions.absorb(target, region);
    enter(target);
  }
}

bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria) {
  return Absorption(visited, criteria).admits(neighbour, neighbour.mean());
}

Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria) {
  GrowingRegions regions(graph);
  std::vector<std::uint8_t> stale(graph.nodes.size(), 1);
  Visit visit;
  while (pass(regions, criteria, stale, visit)) {
  }
  fuse_small_regions(regions, criteria.min_region_area);
  return regions.merges();
}

Merges fuse_small_regions(const RegionGraph& graph, const Merges& merged_into, std::int64_t min_region_area) {
  GrowingRegions regions(graph);
  for (int i = 0; i < regions.count(); ++i) {
    const int survivor = merged_into[static_cast<std::size_t>(i)];
    if (survivor != i) regions.absorb(survivor, i);
  }
  fuse_small_regions(regions, min_region_area);
  return regions.merges();
}

}  // namespace cairn
