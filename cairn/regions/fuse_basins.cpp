// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/disjoint_sets.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/core/pool_memory.hpp>
#include <cairn/regions/fuse_basins.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;                // rows
constexpr double kEvenWithoutEdge = 2.0;  // 1/4 grey level
constexpr int kSmall = 40;                // times smaller than superpixels are on average

/// Two neighbouring pixels of different labels.
struct Contact {
  std::int32_t a = 0;  // < b
  std::int32_t b = 0;
  int edge = 0;  // the stronger one of the two
};

/// Row by row, first the pixels side by side, then those below each other.
template <class Found>
void for_each_contact(View<const RegionId> labels, View<const std::uint16_t> edges, const Exec& exec,
                      Found found) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  const std::size_t room = slot(labels.width()) + kernels::kListSlack;
  std::vector<std::int32_t> pixels(room);
  std::vector<std::int32_t> a(room);
  std::vector<std::int32_t> b(room);
  const auto report = [&](int y, const RegionId* other, int count, int dx, int dy) {
    const int found_there = run.differing(labels.row(y), other, count, pixels.data(), {a.data(), b.data()});
    for (std::size_t i = 0; i < slot(found_there); ++i) {
      const int x = pixels[i];
      found(Contact{a[i], b[i], std::max(edges(x, y), edges(x + dx, y + dy))});
    }
  };
  for (int y = 0; y < labels.height(); ++y) {
    report(y, labels.row(y) + 1, labels.width() - 1, 1, 0);
    if (y + 1 < labels.height()) report(y, labels.row(y + 1), labels.width(), 0, 1);
  }
}

std::vector<std::int64_t> areas_of(const Basins& basins, const Exec& exec) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  const int width = basins.labels.width();
  std::vector<std::int64_t> areas(slot(basins.count));
  std::vector<std::int32_t> ends(slot(width) + kernels::kListSlack);
  for (int y = 0; y < basins.labels.height(); ++y) {
    const RegionId* const row = basins.labels.row(y);
    const int runs = run.find_runs(row, row, width, ends.data());
    int first = 0;
    for (std::size_t i = 0; i < slot(runs); first = ends[i++]) areas[index(row[first])] += ends[i] - first;
  }
  return areas;
}

/// Sets become basins.
Basins united(Basins basins, const DisjointSets& sets, const Exec& exec) {
  Scratch<std::int32_t> numbers(sets.size(), exec.pool);
  basins.count = sets.number(numbers.data());
  parallel_for(exec, basins.labels.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      RegionId* const row = basins.labels.row(y);
      for (int x = 0; x < basins.labels.width(); ++x) row[x] = RegionId{numbers.begin()[index(row[x])]};
    }
  });
  return basins;
}

/// Basins of fewer than `least` pixels join the neighbour across their lowest pass: most would be fused with it
/// anyway, one after the other.
Basins without_small_ones(Basins basins, View<const std::uint16_t> edges, std::int64_t least,
                          const Exec& exec) {
  struct Pass {
    int edge = std::numeric_limits<int>::max();
    std::int32_t to = 0;
  };
  std::vector<Pass> lowest(slot(basins.count));
  for_each_contact(basins.labels, edges, exec, [&](const Contact& contact) {
    // Without a branch: which pass is lower cannot be predicted.
    const auto pass = [&](std::int32_t from, std::int32_t to) {
      Pass& known = lowest[slot(from)];
      const bool is_lower = contact.edge < known.edge;
      known = {is_lower ? contact.edge : known.edge, is_lower ? to : known.to};
    };
    pass(contact.a, contact.b);
    pass(contact.b, contact.a);
  });
  const std::vector<std::int64_t> areas = areas_of(basins, exec);
  DisjointSets sets(areas.size(), exec.pool);
  if (basins.count > 1) {
    for (std::size_t i = 0; i < areas.size(); ++i)
      if (areas[i] < least) sets.unite(static_cast<std::int32_t>(i), lowest[i].to);
  }
  return united(std::move(basins), sets, exec);
}

/// Merges basins pairwise, by ascending key. No merge makes the key of a border smaller than both that it joins, so
/// two regions that are each other's best neighbour stay so until they merge. Hence they are merged where chains of
/// best neighbours end, which is near in the image and thus in memory, and ordered by key afterwards.
class BasinFuser {
 public:
  BasinFuser(const Basins& basins, View<const std::uint16_t> edges, const Exec& exec)
      : memory_(exec.pool),
        links_(&memory_),
        areas_(areas_of(basins, exec)),
        roots_(slot(basins.count)),
        links_of_(slot(basins.count), -1),
        common_(slot(basins.count), -1) {
    links_.reserve(3 * slot(basins.count));  // a planar graph has no more
    for_each_contact(basins.labels, edges, exec, [&](const Contact& contact) {
      Link& link = link_between(contact.a, contact.b);
      ++link.length;
      link.edge_sum += contact.edge;
    });
    for (std::size_t i = 0; i < areas_.size(); ++i) roots_[i] = std::sqrt(static_cast<double>(areas_[i]));
    merges_.reserve(slot(basins.count));
    if (basins.count > 0) merge();
  }

  /// The sets of basins after all but `count` − 1 merges.
  DisjointSets sets(int count, const Pool& pool) {
    const std::size_t basins = areas_.size();
    const std::size_t made = basins - std::min(basins, slot(count));
    if (made < merges_.size())
      std::nth_element(merges_.begin(), merges_.begin() + static_cast<std::ptrdiff_t>(made), merges_.end());
    DisjointSets sets(basins, pool);
    for (std::size_t i = 0; i < made; ++i) sets.unite(merges_[i].a, merges_[i].b);
    return sets;
  }

 private:
  struct Link {
    std::int32_t a = 0;
    std::int32_t b = 0;
    // The next link in the list of a, and of b; −1 = none.
    std::int32_t next_of_a = -1;
    std::int32_t next_of_b = -1;
    std::int32_t first = 0;   // rank in raster order of first occurrence
    std::int32_t length = 0;  // 0 = the link no longer exists
    std::int64_t edge_sum = 0;
    [[nodiscard]] std::int32_t other(std::int32_t end) const { return a == end ? b : a; }
    [[nodiscard]] std::int32_t& next(std::int32_t end) { return a == end ? next_of_a : next_of_b; }
  };
  struct Merge {
    double key;
    std::int32_t first;
    std::int32_t a;  // regions are numbered like one of their basins
    std::int32_t b;
    bool operator<(const Merge& other) const {
      return key < other.key || (key == other.key && first < other.first);
    }
  };

  Link& link_between(std::int32_t a, std::int32_t b) {
    for (std::int32_t i = links_of_[slot(a)]; i >= 0; i = links_[slot(i)].next(a)) {
      if (links_[slot(i)].other(a) == b) return links_[slot(i)];
    }
    const auto made = static_cast<std::int32_t>(links_.size());
    links_.push_back(
        {a, b, std::exchange(links_of_[slot(a)], made), std::exchange(links_of_[slot(b)], made), made});
    return links_.back();
  }

  /// The best link of a region, −1 if it has none; drops those that no longer exist from its list.
  std::int32_t best_of(std::int32_t region, double& least) {
    std::int32_t best = -1;
    std::int32_t* end = &links_of_[slot(region)];
    const double root = roots_[slot(region)];
    while (*end >= 0) {
      Link& link = links_[slot(*end)];
      if (link.length == 0) {
        *end = link.next(region);
        continue;
      }
      const double edge = static_cast<double>(link.edge_sum) / static_cast<double>(link.length);
      const double key = (edge + kEvenWithoutEdge) * std::min(root, roots_[slot(link.other(region))]);
      if (best < 0 || key < least || (key == least && link.first < links_[slot(best)].first)) {
        best = *end;
        least = key;
      }
      end = &link.next(region);
    }
    return best;
  }

  /// Down to one region: the image is connected.
  void merge() {
    std::vector<std::int32_t> chain{0};
    double key = 0;
    for (std::int32_t best = 0; (best = best_of(chain.back(), key)) >= 0;) {
      const std::int32_t here = chain.back();
      const std::int32_t there = links_[slot(best)].other(here);
      if (chain.size() < 2 || chain[chain.size() - 2] != there) {
        chain.push_back(there);
        continue;
      }
      chain.resize(chain.size() - 2);
      merges_.push_back({key, links_[slot(best)].first, here, there});
      const std::int32_t kept = fuse(best);
      if (chain.empty()) chain.push_back(kept);
    }
  }

  /// Returns the number of the merged region.
  std::int32_t fuse(std::int32_t across) {
    std::int32_t kept = links_[slot(across)].a;
    std::int32_t lost = links_[slot(across)].b;
    if (areas_[slot(kept)] < areas_[slot(lost)])
      std::swap(kept, lost);  // the smaller one usually has fewer links
    links_[slot(across)].length = 0;
    areas_[slot(kept)] += areas_[slot(lost)];
    roots_[slot(kept)] = std::sqrt(static_cast<double>(areas_[slot(kept)]));
    std::int32_t* end = &links_of_[slot(kept)];
    while (*end >= 0) {
      Link& link = links_[slot(*end)];
      if (link.length == 0) {
        *end = link.next(kept);
      } else {
        common_[slot(link.other(kept))] = *end;
        end = &link.next(kept);
      }
    }
    for (std::int32_t next = links_of_[slot(lost)]; next >= 0;) {
      const std::int32_t i = next;
      Link& link = links_[slot(i)];
      next = link.next(lost);
      if (link.length == 0) continue;
      const std::int32_t known = common_[slot(link.other(lost))];
      if (known >= 0) {
        Link& both = links_[slot(known)];
        both.first = std::min(both.first, link.first);
        both.length += std::exchange(link.length, 0);
        both.edge_sum += link.edge_sum;
      } else {
        (link.a == lost ? link.a : link.b) = kept;
        link.next(kept) = std::exchange(links_of_[slot(kept)], i);
      }
    }
    for (std::int32_t i = links_of_[slot(kept)]; i >= 0; i = links_[slot(i)].next(kept))
      common_[slot(links_[slot(i)].other(kept))] = -1;
    return kept;
  }

  PoolMemory memory_;
  std::pmr::vector<Link> links_;
  std::vector<std::int64_t> areas_;     // 0 = merged into another region
  std::vector<double> roots_;           // of the areas
  std::vector<std::int32_t> links_of_;  // the first of each region's list; some of its links may be gone
  std::vector<std::int32_t> common_;    // during a merge: the link with the region that is kept; −1 = none
  std::vector<Merge> merges_;
};

}  // namespace

Basins fuse_basins(Basins basins, View<const std::uint16_t> edges, int count, const Exec& exec) {
  const std::int64_t mean_area = edges.size().area() / std::max(count, 1);
  basins = without_small_ones(std::move(basins), edges, mean_area / kSmall, exec);
  const DisjointSets sets = BasinFuser(basins, edges, exec).sets(count, exec.pool);
  return united(std::move(basins), sets, exec);
}

}  // namespace cairn
