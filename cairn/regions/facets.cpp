// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/disparity/evidence.hpp>
#include <cairn/regions/facets.hpp>
#include <cairn/regions/gradient.hpp>
#include <cairn/regions/watershed.hpp>
#include <numeric>
#include <utility>

namespace cairn {
namespace {

constexpr int kRounds = 16;

std::size_t slot(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

/// Disjoint sets; the smaller number is the root.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t root(std::int32_t i) {
    while (parent_[slot(i)] != i) {
      parent_[slot(i)] = parent_[slot(parent_[slot(i)])];
      i = parent_[slot(i)];
    }
    return i;
  }
  void unite(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    parent_[slot(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

void sort_and_sum(std::vector<Border>& borders) {
  std::sort(borders.begin(), borders.end(),
            [](const Border& p, const Border& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < borders.size(); ++i) {
    if (kept > 0 && borders[kept - 1].a == borders[i].a && borders[kept - 1].b == borders[i].b) {
      Border& sum = borders[kept - 1];
      sum.length += borders[i].length;
      sum.edge_sum += borders[i].edge_sum;
      sum.x2_sum += borders[i].x2_sum;
      sum.y2_sum += borders[i].y2_sum;
    } else {
      borders[kept++] = borders[i];
    }
  }
  borders.resize(kept);
}

/// A region's border of least mean edge; −1 = it has none. Ties: the first in (a, b) order.
std::vector<std::int32_t> weakest_border(const std::vector<Border>& borders, std::size_t count) {
  std::vector<std::int32_t> weakest(count, -1);
  for (std::size_t i = 0; i < borders.size(); ++i) {
    for (const std::int32_t end : {borders[i].a, borders[i].b}) {
      std::int32_t& best = weakest[slot(end)];
      if (best < 0 || borders[i].mean_edge() < borders[slot(best)].mean_edge())
        best = static_cast<std::int32_t>(i);
    }
  }
  return weakest;
}

/// One round of fusions; false where there was none.
bool fuse_across_weak_borders(std::vector<Border>& borders, Sets& sets, std::size_t count, double limit) {
  bool fused = false;
  for (const std::int32_t i : weakest_border(borders, count)) {
    if (i < 0 || !(borders[slot(i)].mean_edge() < limit)) continue;
    sets.unite(borders[slot(i)].a, borders[slot(i)].b);
    fused = true;
  }
  for (Border& border : borders) {
    const std::int32_t a = sets.root(border.a);
    const std::int32_t b = sets.root(border.b);
    border.a = std::min(a, b);
    border.b = std::max(a, b);
  }
  std::erase_if(borders, [](const Border& border) { return border.a == border.b; });
  sort_and_sum(borders);
  return fused;
}

}  // namespace

std::vector<Border> borders_of(View<const RegionId> labels, View<const std::uint16_t> edges) {
  const int width = labels.width();
  const int height = labels.height();
  std::vector<Border> borders;
  const auto meet = [&](int x, int y, int u, int v) {
    const std::int32_t p = number(labels(x, y));
    const std::int32_t q = number(labels(u, v));
    if (p == q) return;
    const std::int64_t edge = std::max(edges(x, y), edges(u, v));
    // Neighbouring pairs often belong to the same border: joining them here keeps the list short.
    if (!borders.empty() && borders.back().a == std::min(p, q) && borders.back().b == std::max(p, q)) {
      Border& last = borders.back();
      ++last.length;
      last.edge_sum += edge;
      last.x2_sum += x + u;
      last.y2_sum += y + v;
    } else {
      borders.push_back({std::min(p, q), std::max(p, q), 1, edge, x + u, y + v});
    }
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x + 1 < width; ++x) meet(x, y, x + 1, y);
    for (int x = 0; x < width && y + 1 < height; ++x) meet(x, y, x, y + 1);
  }
  sort_and_sum(borders);
  return borders;
}

Facets segment_facets(View<const Gray> gray, View<const Rgb> rgb, const FacetsConfig& config,
                      const Exec& exec) {
  const Image<std::uint16_t> edges = edge_strength(gray, rgb, config.smoothing_sigma, exec);
  Basins basins = watershed(edges, exec);
  const auto count = slot(basins.count);
  std::vector<Border> borders = borders_of(basins.labels, edges);
  Sets sets(count);
  const double limit = 4.0 * (config.edge_min + config.noise_factor * noise_sigma(gray));
  for (int round = 0; round < kRounds && fuse_across_weak_borders(borders, sets, count, limit); ++round) {
  }

  std::vector<std::int32_t> renumbered(count, -1);
  int kept = 0;
  for (std::size_t i = 0; i < count; ++i) {  // roots are the smallest number, so raster order is kept
    const std::int32_t root = sets.root(static_cast<std::int32_t>(i));
    if (renumbered[slot(root)] < 0) renumbered[slot(root)] = kept++;
    renumbered[i] = renumbered[slot(root)];
  }
  for (Border& border : borders) {
    border.a = renumbered[slot(border.a)];
    border.b = renumbered[slot(border.b)];
  }
  for (int y = 0; y < gray.height(); ++y) {
    RegionId* const row = basins.labels.row(y);
    for (int x = 0; x < gray.width(); ++x) row[x] = RegionId{renumbered[index(row[x])]};
  }
  return {std::move(basins.labels), kept, std::move(borders)};
}

Segmentation as_segmentation(const Facets& facets, View<const Gray> gray, const Exec& exec) {
  struct Sums {
    std::int64_t sum = 0;
    std::int64_t squares = 0;
  };
  std::vector<Sums> sums(slot(facets.count));
  Segmentation result{facets.labels.clone(exec.pool), std::vector<Region>(sums.size())};
  for (int y = 0; y < gray.height(); ++y) {
    for (int x = 0; x < gray.width(); ++x) {
      const std::size_t i = index(facets.labels(x, y));
      const int value = gray(x, y);
      sums[i].sum += value;
      sums[i].squares += value * value;
      ++result.regions[i].pixel_count;
      result.regions[i].box = united(result.regions[i].box, {x, y, 1, 1});
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    Region& region = result.regions[i];
    region.valid_count = region.pixel_count;
    region.mean = static_cast<double>(sums[i].sum) / region.pixel_count;
    region.variance =
        std::max(0.0, static_cast<double>(sums[i].squares) / region.pixel_count - region.mean * region.mean);
  }
  return result;
}

std::vector<std::int32_t> flooded(std::vector<std::int32_t> labels, const std::vector<Border>& borders,
                                  std::int32_t otherwise) {
  std::vector<std::int32_t> order(borders.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t p, std::int32_t q) {
    return borders[slot(p)].mean_edge() < borders[slot(q)].mean_edge();
  });
  Sets sets(labels.size());
  for (const std::int32_t i : order) {
    const std::int32_t p = sets.root(borders[slot(i)].a);
    const std::int32_t q = sets.root(borders[slot(i)].b);
    if (p == q || (labels[slot(p)] >= 0 && labels[slot(q)] >= 0)) continue;
    const std::int32_t label = std::max(labels[slot(p)], labels[slot(q)]);
    sets.unite(p, q);
    labels[slot(sets.root(p))] = label;
  }
  std::vector<std::int32_t> filled(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::int32_t label = labels[slot(sets.root(static_cast<std::int32_t>(i)))];
    filled[i] = label >= 0 ? label : otherwise;
  }
  return filled;
}

}  // namespace cairn
