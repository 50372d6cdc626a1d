// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/evidence.hpp>
#include <cairn/regions/facets.hpp>
#include <cairn/regions/gradient.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/regions/runs.hpp>
#include <cairn/regions/scratch.hpp>
#include <cairn/regions/watershed.hpp>
#include <numeric>
#include <utility>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kRounds = 16;

std::ptrdiff_t signed_slot(std::size_t i) {
  return static_cast<std::ptrdiff_t>(i);
}

/// Disjoint sets; the smallest number is the root.
class Sets {
 public:
  explicit Sets(std::size_t count, const Pool& pool = {}) : pool_(pool), parent_(count, pool) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::int32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void unite(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  /// Numbers the sets in the order of their roots: each element's set.
  [[nodiscard]] Scratch<std::int32_t> numbers() {
    Scratch<std::int32_t> number(parent_.size(), pool_);
    count_ = 0;
    // A parent is smaller than its children and has its number already.
    for (std::ptrdiff_t i = 0; i < signed_slot(parent_.size()); ++i)
      number[i] = parent_[i] == i ? count_++ : number[parent_[i]];
    return number;
  }
  /// How many sets numbers() has found.
  [[nodiscard]] std::int32_t count() const { return count_; }

 private:
  Pool pool_;
  Scratch<std::int32_t> parent_;
  std::int32_t count_ = 0;
};

/// Part of a border. It hangs in the list of its larger region `b`, which the list knows.
struct Part {
  std::int32_t next = 0;  // in the list; −1 = the last
  std::int32_t a = 0;
  Border border;
};

/// The same for a short piece, small: sums share words.
struct Piece {
  static constexpr std::int32_t kLongest = 1 << 12;  // so that no sum leaves its half, whatever the image
  std::int32_t next = 0;
  std::int32_t a = 0;
  std::uint64_t edge_and_length = 0;
  std::uint64_t x2_and_y2 = 0;
};

void add_to(Border& sum, const Part& part) {
  sum.length += part.border.length;
  sum.edge_sum += part.border.edge_sum;
  sum.x2_sum += part.border.x2_sum;
  sum.y2_sum += part.border.y2_sum;
}

void add_to(Border& sum, const Piece& piece) {
  constexpr std::uint64_t kLow = 0xFFFFFFFF;
  sum.length += static_cast<std::int64_t>(piece.edge_and_length & kLow);
  sum.edge_sum += static_cast<std::int64_t>(piece.edge_and_length >> 32U);
  sum.x2_sum += static_cast<std::int64_t>(piece.x2_and_y2 >> 32U);
  sum.y2_sum += static_cast<std::int64_t>(piece.x2_and_y2 & kLow);
}

/// Sums parts to borders, sorted by (a, b). `first`: where the list of each region b begins, −1 = nowhere.
/// Nothing is compared: the lists come in the order of b, one array finds the sum for each a of a list, and
/// then counting sorts by a.
template <class Addend>
void sum_up(const Scratch<std::int32_t>& first, const ScratchList<Addend>& parts,
            ScratchList<Border>& borders, const Exec& exec) {
  const std::size_t count = first.size();
  Scratch<std::int32_t> place(count, -1, exec.pool);     // in `sums`, of the border with a
  Scratch<std::int32_t> start(count + 1, 0, exec.pool);  // in `borders`, of those with a
  ScratchList<Border> sums(parts.size() + 1, exec.pool);
  const Addend* const part = parts.begin();
  for (std::size_t b = 0; b < count; ++b) {
    const auto begin = static_cast<std::int32_t>(sums.size());
    for (std::int32_t i = first[signed_slot(b)]; i >= 0; i = part[i].next) {
      const std::int32_t a = part[i].a;
      if (place[a] < begin) {
        place[a] = static_cast<std::int32_t>(sums.size());
        sums.push_back({a, static_cast<std::int32_t>(b), 0, 0, 0, 0});
        ++start[a + 1];
      }
      add_to(sums.data()[place[a]], part[i]);
    }
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  borders.clear();
  Border* const sorted = borders.room_for(sums.size());
  for (const Border& sum : sums) sorted[start[sum.a]++] = sum;
  borders.grown(sums.size());
}

/// The places where neighbouring pixels belong to different regions, `count` of them at most. What follows
/// along one border goes to one piece, as long as it is remembered.
class Contacts {
 public:
  Contacts(View<const RegionId> labels, View<const std::uint16_t> edges, std::size_t count, const Exec& exec)
      : labels_(labels),
        edges_(edges),
        first_(count, -1, exec.pool),
        pieces_(static_cast<std::size_t>(labels.size().area()) / 2 + 1, exec.pool),
        recent_(std::size_t{1} << kBits) {
    const kernels::LabelKernels& run = kernels::label_kernels(exec);
    Found found(slot(labels.width()) + kernels::kListSlack);
    for (int y = 0; y < labels.height(); ++y) {
      meet(run, y, y, 1, labels.width() - 1, found);
      if (y + 1 < labels.height()) meet(run, y, y + 1, 0, labels.width(), found);
    }
  }
  void sum_up(ScratchList<Border>& borders, const Exec& exec) const {
    cairn::sum_up(first_, pieces_, borders, exec);
  }

 private:
  static constexpr unsigned kBits = 11;  // several times the borders of two rows; fits the first-level cache
  struct Recent {
    std::int32_t a = -1;
    std::int32_t b = -1;
    std::int32_t piece = 0;
    std::int32_t length = 0;
  };

  /// The contacts of a row.
  struct Found {
    explicit Found(std::size_t length) : columns(length), a(length), b(length) {}
    std::vector<std::int32_t> columns, a, b;
  };

  /// Each of the first `width` pixels of row y with the one `right` of it in row v.
  void meet(const kernels::LabelKernels& run, int y, int v, int right, int width, Found& found) {
    const auto count = slot(run.differing(labels_.row(y), labels_.row(v) + right, width, found.columns.data(),
                                          {found.a.data(), found.b.data()}));
    const std::uint16_t* const edge_here = edges_.row(y);
    const std::uint16_t* const edge_there = edges_.row(v) + right;
    Piece* const piece = pieces_.room_for(count + 1) - pieces_.size();
    std::int32_t* const first = first_.data();
    Recent* const known = recent_.data();
    auto next = static_cast<std::int32_t>(pieces_.size());
    const std::int32_t before = next;
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t x = found.columns[i];
      const std::int32_t a = found.a[i];
      const std::int32_t b = found.b[i];
      Recent& recent =
          known[(static_cast<std::uint32_t>(a) * 0x9E3779B1U + static_cast<std::uint32_t>(b) * 0x85EBCA6BU) >>
                (32U - kBits)];
      // Without a branch: every other contact begins a piece, and nothing tells which. All bits set where one
      // goes on.
      const auto other =
          static_cast<std::uint32_t>((recent.a ^ a) | (recent.b ^ b) | (recent.length / Piece::kLongest));
      const std::int32_t goes_on = static_cast<std::int32_t>((other | (0U - other)) >> 31U) - 1;
      const std::int32_t at = (recent.piece & goes_on) | (next & ~goes_on);
      recent = {a, b, at, (recent.length & goes_on) + 1};
      piece[next] = {first[b], a, 0, 0};
      first[b] = (first[b] & goes_on) | (next & ~goes_on);
      next += 1 + goes_on;
      piece[at].edge_and_length += (std::uint64_t{std::max(edge_here[x], edge_there[x])} << 32U) + 1;
      piece[at].x2_and_y2 +=
          (static_cast<std::uint64_t>(2 * x + right) << 32U) + static_cast<std::uint64_t>(y + v);
    }
    pieces_.grown(static_cast<std::size_t>(next - before));
  }

  View<const RegionId> labels_;
  View<const std::uint16_t> edges_;
  Scratch<std::int32_t> first_;
  ScratchList<Piece> pieces_;
  std::vector<Recent> recent_;
};

/// Regions that fuse, round by round, numbered anew each time so that all stays small; their order is kept.
class Fusing {
 public:
  Fusing(const Basins& basins, View<const std::uint16_t> edges, const Exec& exec)
      : exec_(exec), count_(slot(basins.count)), facets_(count_, exec.pool), borders_(0, exec.pool) {
    std::iota(facets_.begin(), facets_.end(), 0);
    Contacts(basins.labels, edges, count_, exec).sum_up(borders_, exec);
  }

  /// Each region fuses across its border of least mean edge, where that is below `limit` (ties: the first in
  /// (a, b) order); false where none is.
  bool fuse_across_weak_borders(double limit) {
    const Scratch<std::int32_t> weakest = weak_borders(limit);
    Sets sets(count_, exec_.pool);
    bool fused = false;
    for (const std::int32_t i : weakest) {
      if (i < 0) continue;
      sets.unite(borders_.begin()[i].a, borders_.begin()[i].b);
      fused = true;
    }
    if (fused) renumber(sets);
    return fused;
  }

  [[nodiscard]] int count() const { return static_cast<int>(count_); }
  /// The facet of each basin.
  [[nodiscard]] const Scratch<std::int32_t>& facets() const { return facets_; }
  [[nodiscard]] std::vector<Border> borders() const { return {borders_.begin(), borders_.end()}; }

 private:
  /// Per region its weakest border; −1 = that is not weak, or there is none.
  [[nodiscard]] Scratch<std::int32_t> weak_borders(double limit) const {
    Scratch<double> least(count_, limit, exec_.pool);
    Scratch<std::int32_t> weakest(count_, -1, exec_.pool);
    for (std::size_t i = 0; i < borders_.size(); ++i) {
      const Border& border = borders_.begin()[i];
      const double edge = border.mean_edge();
      for (const std::int32_t end : {border.a, border.b}) {
        const bool weaker = edge < least[end];
        least[end] = weaker ? edge : least[end];
        weakest[end] = weaker ? static_cast<std::int32_t>(i) : weakest[end];
      }
    }
    return weakest;
  }

  void renumber(Sets& sets) {
    const Scratch<std::int32_t> numbers = sets.numbers();
    Scratch<std::int32_t> first(slot(sets.count()), -1, exec_.pool);
    ScratchList<Part> parts(borders_.size(), exec_.pool);
    for (const Border& border : borders_) {
      const auto [a, b] = std::minmax({numbers[border.a], numbers[border.b]});
      if (a == b) continue;
      const auto i = static_cast<std::int32_t>(parts.size());
      parts.push_back({first[b], a, border});
      first[b] = i;
    }
    sum_up(first, parts, borders_, exec_);
    count_ = first.size();
    for (std::int32_t& facet : facets_) facet = numbers[facet];
  }

  const Exec& exec_;
  std::size_t count_;
  Scratch<std::int32_t> facets_;
  ScratchList<Border> borders_;
};

/// What only one edge pixel in fifty is stronger than, in 1/4 grey level.
int clear_edge(View<const std::uint16_t> edges) {
  std::vector<std::int64_t> histogram(std::size_t{1} << 16U);
  for (int y = 0; y < edges.height(); ++y) {
    const std::uint16_t* const row = edges.row(y);
    for (int x = 0; x < edges.width(); ++x) ++histogram[row[x]];
  }
  std::int64_t stronger = 0;
  int strength = static_cast<int>(histogram.size()) - 1;
  while (strength > 0 && 50 * (stronger + histogram[slot(strength)]) <= edges.size().area())
    stronger += histogram[slot(strength--)];
  return strength;
}

}  // namespace

std::vector<Border> borders_of(View<const RegionId> labels, View<const std::uint16_t> edges) {
  std::int32_t last = -1;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) last = std::max(last, number(labels(x, y)));
  }
  const Exec exec;
  ScratchList<Border> borders(0, exec.pool);
  Contacts(labels, edges, slot(last + 1), exec).sum_up(borders, exec);
  return {borders.begin(), borders.end()};
}

Facets segment_facets(View<const Gray> gray, View<const Rgb> rgb, const FacetsConfig& config,
                      const Exec& exec) {
  const Image<std::uint16_t> edges = edge_strength(gray, rgb, config.smoothing_sigma, exec);
  Basins basins = watershed(edges, exec);
  Fusing fusing(basins, edges, exec);
  const double limit = 4.0 * (config.edge_min + config.noise_factor * noise_sigma(gray)) +
                       0.01 * config.contrast_share * clear_edge(edges);
  for (int round = 0; round < kRounds && fusing.fuse_across_weak_borders(limit); ++round) {
  }
  const Scratch<std::int32_t>& facets = fusing.facets();
  parallel_for(exec, gray.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      RegionId* const row = basins.labels.row(y);
      for (int x = 0; x < gray.width(); ++x) row[x] = RegionId{facets[number(row[x])]};
    }
  });
  return {std::move(basins.labels), fusing.count(), fusing.borders()};
}

Segmentation as_segmentation(const Facets& facets, View<const Gray> gray, const Exec& exec) {
  struct Sums {
    std::int64_t sum = 0;
    std::int64_t squares = 0;
  };
  std::vector<Sums> sums(slot(facets.count));
  Segmentation result{facets.labels.clone(exec.pool), std::vector<Region>(sums.size())};
  for_each_run(facets.labels, [&](const Run& run) {
    const Gray* const grey = gray.row(run.y);
    Sums here;
    for (int x = run.first; x < run.last; ++x) {
      here.sum += grey[x];
      here.squares += grey[x] * grey[x];
    }
    Sums& whole = sums[index(run.label)];
    whole.sum += here.sum;
    whole.squares += here.squares;
    Region& region = result.regions[index(run.label)];
    region.pixel_count += run.length();
    region.box = united(region.box, run.box());
  });
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
