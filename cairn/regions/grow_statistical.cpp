// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/growing_regions.hpp>
#include <limits>
#include <vector>

namespace cairn {
namespace {

/// A region with its raster position in the upper half, so that sorting does not access the regions.
using PlacedRegion = std::uint64_t;
PlacedRegion placed(const GrowingRegions& regions, std::int32_t region) {
  return (static_cast<std::uint64_t>(regions.place(region)) << 32U) | static_cast<std::uint32_t>(region);
}
std::int32_t region_of(PlacedRegion entry) {
  return static_cast<std::int32_t>(entry & 0xFFFFFFFFU);
}

/// Sorts lists that are nearly in order: late entries are sorted apart and merged. Reuses its memory.
class SortStragglers {
 public:
  void operator()(std::vector<PlacedRegion>& entries) {
    late_.clear();
    std::size_t kept = 0;
    PlacedRegion last = 0;
    for (const PlacedRegion entry : entries) {
      if (entry < last) {
        late_.push_back(entry);
      } else {
        entries[kept++] = last = entry;
      }
    }
    if (late_.empty()) return;
    std::sort(late_.begin(), late_.end());
    sorted_.resize(entries.size());
    entries.resize(kept);
    std::merge(entries.begin(), entries.end(), late_.begin(), late_.end(), sorted_.begin());
    entries.swap(sorted_);
  }

 private:
  std::vector<PlacedRegion> late_;
  std::vector<PlacedRegion> sorted_;
};

/// A neighbour of the visited region. Only the visited region changes during a visit, so the mean is cached.
struct Neighbour {
  PlacedRegion entry;
  double mean;
  bool operator<(const Neighbour& other) const { return entry < other.entry; }
};

/// Working memory of a visit and of a pass; reused by the next one.
struct Visit {
  explicit Visit(const Exec& exec) : found(0, exec.pool) {}
  ScratchList<std::int32_t> found;
  std::vector<Neighbour> neighbours;
  std::vector<Neighbour> gained;
  std::vector<Neighbour> merged;
  std::vector<PlacedRegion> order;  // of the pass
  SortStragglers sort_order;
};

/// Insertion sort for short lists: most are nearly in order, as regions are numbered so.
void sort(std::vector<Neighbour>& neighbours) {
  constexpr std::size_t kFew = 32;
  if (neighbours.size() > kFew) {
    std::sort(neighbours.begin(), neighbours.end());
    return;
  }
  for (std::size_t i = 1; i < neighbours.size(); ++i) {
    const Neighbour moved = neighbours[i];
    std::size_t at = i;
    for (; at > 0 && moved < neighbours[at - 1]; --at) neighbours[at] = neighbours[at - 1];
    neighbours[at] = moved;
  }
}

/// Converts region ids to neighbours.
void look_at(const GrowingRegions& regions, const ScratchList<std::int32_t>& found,
             std::vector<Neighbour>& neighbours) {
  neighbours.resize(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::int32_t region = found.begin()[i];
    neighbours[i] = {placed(regions, region), regions.mean(region)};
  }
}

/// A bit for each of up to 64 neighbours from `first` on: similar enough to be checked further. Without a
/// branch, which would be mispredicted half of the time.
std::uint64_t near_ones(const Absorption& absorption, const std::vector<Neighbour>& neighbours,
                        std::size_t first) {
  const std::size_t count = std::min<std::size_t>(neighbours.size() - first, 64);
  std::uint64_t near = 0;
  for (std::size_t i = 0; i < count; ++i) {
    near |= std::uint64_t{absorption.is_near(neighbours[first + i].mean)} << i;
  }
  return near;
}

/// The first neighbour from `first` on that may be absorbed; their number if there is none.
std::size_t first_admitted(const Absorption& absorption, const GrowingRegions& regions,
                           const std::vector<Neighbour>& neighbours, std::size_t first) {
  for (; first < neighbours.size(); first += 64) {
    for (std::uint64_t near = near_ones(absorption, neighbours, first); near != 0; near &= near - 1) {
      const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(near));
      if (absorption.admits(regions.brief(region_of(neighbours[i].entry)))) return i;
    }
  }
  return neighbours.size();
}

/// One round: tries every neighbour once. Fused ones leave the list, and their neighbours join it. `next`:
/// the first that fuses.
void try_each(GrowingRegions& regions, std::int32_t region, Absorption& absorption, Visit& visit,
              std::size_t next) {
  std::vector<Neighbour>& neighbours = visit.neighbours;
  visit.found.clear();
  std::size_t kept = next;
  while (next < neighbours.size()) {
    const std::int32_t other = region_of(neighbours[next].entry);
    regions.append_new_neighbours(other, visit.found);
    regions.absorb(region, other);
    absorption.update(regions.brief(region), regions.squares(region));
    const std::size_t refused = next + 1;
    next = first_admitted(absorption, regions, neighbours, refused);
    for (std::size_t i = refused; i < next; ++i) neighbours[kept++] = neighbours[i];
  }
  neighbours.resize(kept);
  if (visit.found.size() == 0) return;
  look_at(regions, visit.found, visit.gained);
  sort(visit.gained);
  visit.merged.resize(kept + visit.gained.size());
  std::merge(neighbours.begin(), neighbours.end(), visit.gained.begin(), visit.gained.end(),
             visit.merged.begin());
  neighbours.swap(visit.merged);
}

/// Grows `region`; false if nothing fused.
bool grow(GrowingRegions& regions, std::int32_t region, const GrowCriteria& criteria, Visit& visit) {
  Absorption absorption(regions.brief(region), regions.squares(region), criteria);
  if (!absorption.may_absorb() || !has_near_neighbour(regions, region, absorption)) return false;
  visit.found.clear();
  regions.start_visit(region);
  regions.append_new_neighbours(region, visit.found);
  look_at(regions, visit.found, visit.neighbours);
  sort(visit.neighbours);
  bool fused = false;
  for (;; fused = true) {
    const std::size_t next = first_admitted(absorption, regions, visit.neighbours, 0);
    if (next == visit.neighbours.size()) return fused;
    try_each(regions, region, absorption, visit, next);
  }
}

/// One pass over all living regions; false if nothing fused. A region is visited only if it is `stale`: its
/// statistics or those of a neighbour changed since its last visit. Otherwise the outcome would be the same.
bool pass(GrowingRegions& regions, const GrowCriteria& criteria, Scratch<std::uint8_t>& stale, Visit& visit) {
  std::vector<PlacedRegion>& order = visit.order;
  order.resize(slot(regions.count()) + 1);
  std::size_t count = 0;
  for (std::int32_t i = 0; i < regions.count(); ++i) {
    order[count] = placed(regions, i);
    count += static_cast<std::size_t>(regions.is_alive(i)) & static_cast<std::size_t>(stale[i] != 0);
  }
  order.resize(count);
  // Basins are numbered in raster order, but a region takes the place of an earlier one that it absorbed.
  visit.sort_order(order);
  bool fused = false;
  for (const PlacedRegion entry : order) {
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

/// The first neighbour in raster order without valid pixels that is not floor; −1 = none.
std::int32_t first_unseen(GrowingRegions& regions, std::int32_t region) {
  std::int32_t best = -1;
  regions.for_each_neighbour(region, [&](std::int32_t neighbour) {
    if (neighbour == region || regions.is_floor(neighbour) || regions.valid_count(neighbour) > 0) return;
    if (best < 0 || regions.place(neighbour) < regions.place(best)) best = neighbour;
  });
  return best;
}

/// Whether (a, b) < (c, d) in lexicographic order.
bool precedes(std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
#ifdef __SIZEOF_INT128__
  // One comparison without a branch.
  __extension__ using Both = unsigned __int128;
  return ((Both{a} << 64U) | b) < ((Both{c} << 64U) | d);
#else
  return a < c || (a == c && b < d);
#endif
}

/// The neighbour that a small region fuses with; −1 if all are floor. Hides the region's mean.
std::int32_t most_similar(GrowingRegions& regions, std::int32_t region) {
  const bool has_mean = regions.valid_count(region) > 0;
  // Hidden because the region can be in its own list of neighbours.
  const double mean = regions.hide_mean(region);
  const std::uint64_t none = ascending_bits(std::numeric_limits<double>::infinity());
  std::uint64_t least = none;
  PlacedRegion best = 0;
  // Without a branch, which would be unpredictable.
  regions.for_each_neighbour(region, [&](std::int32_t neighbour) {
    const double theirs = regions.mean(neighbour);
    const std::uint64_t value = ascending_bits(has_mean ? std::abs(mean - theirs) : theirs);
    const PlacedRegion entry = placed(regions, neighbour);
    const bool better = precedes(value, entry, least, best);
    least = better ? value : least;
    best = better ? entry : best;
  });
  return least != none ? region_of(best) : first_unseen(regions, region);
}

/// Small regions in the order of their fusion: by size, then in raster order. A fusion always makes a larger
/// region, so one pass over ascending sizes is enough.
class SmallRegions {
 public:
  SmallRegions(const GrowingRegions& regions, std::int64_t min_region_area, const Exec& exec)
      : regions_(regions),
        min_region_area_(min_region_area),
        sizes_(size_count(regions, min_region_area)),
        lists_(static_cast<std::size_t>(sizes_), {-1, -1}, exec.pool),
        blocks_(slot(regions.count()) / 4, exec.pool) {
    // Without a branch: which regions are alive is unpredictable.
    Scratch<std::int32_t> small(slot(regions.count()) + 1, exec.pool);
    std::int32_t count = 0;
    for (std::int32_t i = 0; i < regions.count(); ++i) {
      small[count] = i;
      count += regions.is_alive(i) & is_small(i) ? 1 : 0;
    }
    for (std::int32_t i = 0; i < count; ++i) enter(small[i]);
  }
  [[nodiscard]] bool is_small(std::int32_t region) const {
    const bool has_few_pixels = regions_.pixel_count(region) < min_region_area_;
    const bool is_unseen = regions_.valid_count(region) == 0;
    return (has_few_pixels | is_unseen) & !regions_.is_floor(region);
  }
  /// Requires is_small(region).
  void enter(std::int32_t region) {
    const PlacedRegion entry = placed(regions_, region);
    OfOneSize& list = lists_[regions_.pixel_count(region)];
    if (list.last < 0 || blocks_.begin()[list.last].count == kInBlock) {
      const auto block = static_cast<std::int32_t>(blocks_.size());
      blocks_.push_back({.next = -1, .count = 0, .entries = {}});
      (list.first < 0 ? list.first : blocks_.begin()[list.last].next) = block;
      list.last = block;
    }
    Block& block = blocks_.begin()[list.last];
    block.entries[static_cast<std::size_t>(block.count++)] = entry;
  }
  /// Calls fuse(region) for each small region; fuse() may enter larger ones.
  template <class Fuse>
  void for_each(Fuse fuse) {
    std::vector<PlacedRegion> of_one_size;
    SortStragglers sort;
    for (std::int32_t pixels = 0; pixels < sizes_; ++pixels) {
      of_one_size.clear();
      for (std::int32_t i = lists_[pixels].first; i >= 0; i = blocks_.begin()[i].next) {
        const Block& block = blocks_.begin()[i];
        of_one_size.insert(of_one_size.end(), block.entries.begin(), block.entries.begin() + block.count);
      }
      sort(of_one_size);
      for (const PlacedRegion entry : of_one_size) {
        const std::int32_t region = region_of(entry);
        // It may have absorbed others meanwhile; it is then also entered under its larger size.
        if (regions_.is_alive(region) && regions_.pixel_count(region) == pixels) fuse(region);
      }
    }
  }

 private:
  static constexpr std::int32_t kInBlock = 7;
  /// Up to seven entries of one size in a cache line: linked singly, each would be a cache miss.
  struct alignas(64) Block {
    std::int32_t next;  // the next block of this size, −1 = none
    std::int32_t count;
    std::array<PlacedRegion, kInBlock> entries;
  };
  struct OfOneSize {  // linked list of blocks, in the order of entry
    std::int32_t first;
    std::int32_t last;
  };
  /// One more than the largest pixel count of an entry.
  static std::int32_t size_count(const GrowingRegions& regions, std::int64_t min_region_area) {
    std::int64_t all_pixels = 0;
    bool has_unseen = false;
    for (std::int32_t i = 0; i < regions.count(); ++i) {
      const bool lives = regions.is_alive(i);
      all_pixels += lives ? regions.pixel_count(i) : 0;
      has_unseen |= lives & (regions.valid_count(i) == 0);
    }
    // Regions without valid pixels count as small at any size.
    return static_cast<std::int32_t>(
        has_unseen ? all_pixels + 1 : std::clamp<std::int64_t>(min_region_area, 0, all_pixels + 1));
  }

  const GrowingRegions& regions_;
  std::int64_t min_region_area_;
  std::int32_t sizes_;
  Scratch<OfOneSize> lists_;  // by pixel count
  ScratchList<Block> blocks_;
};

}  // namespace

void fuse_small_regions(GrowingRegions& regions, std::int64_t min_region_area, const Exec& exec) {
  SmallRegions small(regions, min_region_area, exec);
  small.for_each([&](std::int32_t region) {
    const std::int32_t target = most_similar(regions, region);
    if (target < 0) return regions.show_mean(region);
    regions.absorb(target, region);
    if (small.is_small(target)) small.enter(target);
  });
}

bool has_near_neighbour(GrowingRegions& regions, std::int32_t region, const Absorption& absorption) {
  // Without a branch, which would be unpredictable.
  bool has_one = false;
  regions.for_each_neighbour(region, [&](std::int32_t neighbour) {
    has_one |= absorption.is_near(regions.mean(neighbour)) & (neighbour != region);
  });
  return has_one;
}

bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria) {
  if (neighbour.valid_count == 0 || neighbour.is_floor) return false;
  const Absorption absorption(GrowingRegions::Brief::of(visited), visited.sum_of_squares, criteria);
  return absorption.is_near(neighbour.mean()) && absorption.admits(GrowingRegions::Brief::of(neighbour));
}

Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria, const Exec& exec) {
  GrowingRegions regions(graph, exec);
  Scratch<std::uint8_t> stale(graph.nodes.size(), 1, exec.pool);
  Visit visit(exec);
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
