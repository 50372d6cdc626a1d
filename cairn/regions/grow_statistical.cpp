// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/growing_regions.hpp>
#include <limits>
#include <vector>

namespace cairn {
namespace {

/// A region with its place in raster order before it, so that sorting needs no look at the regions.
using Placed = std::uint64_t;
Placed placed(const GrowingRegions& regions, std::int32_t region) {
  return (static_cast<std::uint64_t>(regions.brief(region).place) << 32U) |
         static_cast<std::uint32_t>(region);
}
std::int32_t region_of(Placed entry) {
  return static_cast<std::int32_t>(entry & 0xFFFFFFFFU);
}

/// A neighbour of the visited region. Nothing but the visited region changes during a visit, so the mean is
/// kept here.
struct Neighbour {
  Placed entry;
  double mean;
  bool operator<(const Neighbour& other) const { return entry < other.entry; }
};
Neighbour neighbour_of(const GrowingRegions& regions, std::int32_t region) {
  return {placed(regions, region), regions.brief(region).mean};
}

/// The lists of a visit; they keep their memory from one visit to the next.
struct Visit {
  std::vector<Neighbour> neighbours;
  std::vector<Neighbour> gained;
  std::vector<Neighbour> merged;
};

bool admits(const Absorption& absorption, const GrowingRegions& regions, const Neighbour& neighbour) {
  return absorption.is_near(neighbour.mean) && absorption.admits(regions.sums(region_of(neighbour.entry)));
}

/// One round: every neighbour is tried once. Those that fuse leave the list, what they bring along joins it.
void try_each(GrowingRegions& regions, std::int32_t region, Absorption& absorption, Visit& visit) {
  visit.gained.clear();
  std::size_t kept = 0;
  for (const Neighbour& neighbour : visit.neighbours) {
    if (!admits(absorption, regions, neighbour)) {
      visit.neighbours[kept++] = neighbour;
      continue;
    }
    const std::int32_t other = region_of(neighbour.entry);
    regions.for_each_new_neighbour(other,
                                   [&](std::int32_t n) { visit.gained.push_back(neighbour_of(regions, n)); });
    regions.absorb(region, other);
    absorption.update(regions.sums(region));
  }
  visit.neighbours.resize(kept);
  std::sort(visit.gained.begin(), visit.gained.end());
  visit.merged.resize(kept + visit.gained.size());
  std::merge(visit.neighbours.begin(), visit.neighbours.end(), visit.gained.begin(), visit.gained.end(),
             visit.merged.begin());
  visit.neighbours.swap(visit.merged);
}

/// Lets `region` grow; false where nothing fused.
bool grow(GrowingRegions& regions, std::int32_t region, const GrowCriteria& criteria, Visit& visit) {
  Absorption absorption(regions.sums(region), criteria);
  if (!absorption.may_absorb()) return false;
  visit.neighbours.clear();
  bool grows = false;
  regions.start_visit(region);
  regions.for_each_new_neighbour(region, [&](std::int32_t n) {
    visit.neighbours.push_back(neighbour_of(regions, n));
    grows |= admits(absorption, regions, visit.neighbours.back());
  });
  if (!grows) return false;  // the order would matter only after a fusion
  std::sort(visit.neighbours.begin(), visit.neighbours.end());
  for (std::int32_t pixels = 0; pixels != regions.brief(region).pixel_count;) {
    pixels = regions.brief(region).pixel_count;
    try_each(regions, region, absorption, visit);
  }
  return true;
}

/// One pass over all living regions; false where nothing fused. Regions whose own and whose neighbours'
/// statistics have not changed since they were last visited would refuse the same neighbours again, so they
/// are passed over: `stale` marks the others.
bool pass(GrowingRegions& regions, const GrowCriteria& criteria, Scratch<std::uint8_t>& stale, Visit& visit) {
  std::vector<Placed> order;
  for (std::int32_t i = 0; i < regions.count(); ++i) {
    if (regions.is_alive(i) && stale[i] != 0) order.push_back(placed(regions, i));
  }
  std::sort(order.begin(), order.end());
  bool fused = false;
  for (const Placed entry : order) {
    const std::int32_t region = region_of(entry);
    if (!regions.is_alive(region)) continue;
    stale[region] = 0;
    if (!grow(regions, region, criteria, visit)) continue;
    fused = true;
    for (const Neighbour& neighbour : visit.neighbours) stale[region_of(neighbour.entry)] = 1;
    regions.set_neighbours(region, visit.neighbours.size(),
                           [&](std::size_t i) { return region_of(visit.neighbours[i].entry); });
  }
  return fused;
}

/// The neighbour that a small region fuses with; −1 where all are floor.
std::int32_t most_similar(GrowingRegions& regions, std::int32_t region) {
  const bool has_mean = regions.sums(region).valid_count > 0;
  const double mean = regions.brief(region).mean;
  std::int32_t best = -1;
  double least = 0;
  regions.start_visit(region);
  regions.for_each_new_neighbour(region, [&](std::int32_t neighbour) {
    const GrowingRegions::Brief& brief = regions.brief(neighbour);
    double value = has_mean ? std::abs(mean - brief.mean) : brief.mean;
    if (brief.mean != brief.mean) {
      if (regions.sums(neighbour).is_floor) return;
      value = std::numeric_limits<double>::infinity();
    }
    if (best < 0 || value < least || (value == least && brief.place < regions.brief(best).place)) {
      best = neighbour;
      least = value;
    }
  });
  return best;
}

/// Small regions in the order in which they fuse: by size, then in raster order. A fusion always makes a
/// larger region, so sizes are gone through once, upwards.
class SmallRegions {
 public:
  SmallRegions(const GrowingRegions& regions, std::int64_t min_region_area, const Exec& exec)
      : regions_(regions),
        min_region_area_(min_region_area),
        sizes_(size_count(regions, min_region_area)),
        first_(static_cast<std::size_t>(sizes_), -1, exec.pool),
        entries_(static_cast<std::size_t>(regions.count()), exec.pool) {
    for (std::int32_t i = 0; i < regions.count(); ++i) {
      if (regions.is_alive(i)) enter(i);
    }
  }
  void enter(std::int32_t region) {
    const auto pixels = regions_.brief(region).pixel_count;
    if (pixels >= min_region_area_ && regions_.sums(region).valid_count > 0) return;
    if (regions_.sums(region).is_floor) return;
    entries_.push_back({region, first_[pixels]});
    first_[pixels] = static_cast<std::int32_t>(entries_.size()) - 1;
  }
  /// Calls fuse(region) for each; fuse() may enter larger ones.
  template <class Fuse>
  void for_each(Fuse fuse) {
    std::vector<Placed> of_one_size;
    for (std::int32_t pixels = 0; pixels < sizes_; ++pixels) {
      of_one_size.clear();
      for (std::int32_t i = first_[pixels]; i >= 0; i = entries_.begin()[i].next) {
        of_one_size.push_back(placed(regions_, entries_.begin()[i].region));
      }
      std::sort(of_one_size.begin(), of_one_size.end());
      for (const Placed entry : of_one_size) {
        const std::int32_t region = region_of(entry);
        // Others may have fused with it meanwhile; then it stands among the larger ones too.
        if (regions_.is_alive(region) && regions_.brief(region).pixel_count == pixels) fuse(region);
      }
    }
  }

 private:
  struct Entry {
    std::int32_t region;
    std::int32_t next;  // of the same size, −1 = none
  };
  /// One more than the most pixels that an entry can have.
  static std::int32_t size_count(const GrowingRegions& regions, std::int64_t min_region_area) {
    std::int64_t all_pixels = 0;
    bool has_unseen = false;
    for (std::int32_t i = 0; i < regions.count(); ++i) {
      if (!regions.is_alive(i)) continue;
      all_pixels += regions.brief(i).pixel_count;
      has_unseen |= regions.sums(i).valid_count == 0;
    }
    // Regions without valid pixel count as small at any size.
    return static_cast<std::int32_t>(
        has_unseen ? all_pixels + 1 : std::clamp<std::int64_t>(min_region_area, 0, all_pixels + 1));
  }

  const GrowingRegions& regions_;
  std::int64_t min_region_area_;
  std::int32_t sizes_;
  Scratch<std::int32_t> first_;  // per number of pixels: the entry last made
  ScratchList<Entry> entries_;
};

GrowingRegions::Sums sums_of(const RegionGraph::Node& node) {
  return {node.sum, node.sum_of_squares, static_cast<std::int32_t>(node.valid_count), node.is_floor};
}

}  // namespace

void fuse_small_regions(GrowingRegions& regions, std::int64_t min_region_area, const Exec& exec) {
  SmallRegions small(regions, min_region_area, exec);
  small.for_each([&](std::int32_t region) {
    const std::int32_t target = most_similar(regions, region);
    if (target < 0) return;
    regions.absorb(target, region);
    small.enter(target);
  });
}

bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria) {
  if (neighbour.valid_count == 0 || neighbour.is_floor) return false;
  const Absorption absorption(sums_of(visited), criteria);
  return absorption.is_near(neighbour.mean()) && absorption.admits(sums_of(neighbour));
}

Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec) {
  GrowingRegions regions(graph, exec);
  Scratch<std::uint8_t> stale(graph.nodes.size(), 1, exec.pool);
  Visit visit;
  while (pass(regions, criteria, stale, visit)) {
  }
  fuse_small_regions(regions, criteria.min_region_area, exec);
  return regions.merges();
}

Merges fuse_small_regions(const RegionGraph& graph, const Merges& merged_into, std::int64_t min_region_area,
                          const Exec& exec) {
  GrowingRegions regions(graph, exec);
  for (std::int32_t i = 0; i < regions.count(); ++i) {
    const std::int32_t survivor = merged_into[static_cast<std::size_t>(i)];
    if (survivor != i) regions.absorb(survivor, i);
  }
  fuse_small_regions(regions, min_region_area, exec);
  return regions.merges();
}

}  // namespace cairn
