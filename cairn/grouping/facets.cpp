// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/disjoint_sets.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/core/pool_memory.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/grouping/facets.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/regions/runs.hpp>
#include <cairn/regions/watershed.hpp>
#include <numeric>
#include <tuple>
#include <utility>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kRounds = 16;

std::ptrdiff_t signed_slot(std::size_t i) {
  return static_cast<std::ptrdiff_t>(i);
}

/// Part of a border. It hangs in the list of its larger region `b`, which the list knows.
struct Part {
  std::int32_t next = 0;  // in the list; −1 = the last
  std::int32_t a = 0;
  const Border* border = nullptr;
};

/// The same for a short piece, small: sums share words.
struct Piece {
  static constexpr std::int32_t kLongest = 1 << 12;  // so that no sum leaves its half, whatever the image
  std::int32_t next = 0;
  std::int32_t a = 0;
  std::uint64_t edge_and_length = 0;
  std::uint64_t x2_and_y2 = 0;
};

void add_to(Border& sum, const Border& part) {
  sum.length += part.length;
  sum.edge_sum += part.edge_sum;
  sum.x2_sum += part.x2_sum;
  sum.y2_sum += part.y2_sum;
}

void add_to(Border& sum, const Part& part) {
  add_to(sum, *part.border);
}

void add_to(Border& sum, const Piece& piece) {
  constexpr std::uint64_t kLow = 0xFFFFFFFF;
  sum.length += static_cast<std::int64_t>(piece.edge_and_length & kLow);
  sum.edge_sum += static_cast<std::int64_t>(piece.edge_and_length >> 32U);
  sum.x2_sum += static_cast<std::int64_t>(piece.x2_and_y2 >> 32U);
  sum.y2_sum += static_cast<std::int64_t>(piece.x2_and_y2 & kLow);
}

/// Sums parts to borders, in the order of b. `first`: where the list of each region b begins, −1 = nowhere.
/// Nothing is compared: the lists come in the order of b, and one array finds the sum for each a of a list.
template <class Addend>
ScratchList<Border> summed_up(const Scratch<std::int32_t>& first, const ScratchList<Addend>& parts,
                              const Exec& exec) {
  const std::size_t count = first.size();
  Scratch<std::int32_t> place(count, -1, exec.pool);  // in `sums`, of the border with a
  ScratchList<Border> sums(parts.size() + 1, exec.pool);
  const Addend* const part = parts.begin();
  for (std::size_t b = 0; b < count; ++b) {
    const auto begin = static_cast<std::int32_t>(sums.size());
    for (std::int32_t i = first[signed_slot(b)]; i >= 0; i = part[i].next) {
      const std::int32_t a = part[i].a;
      if (place[a] < begin) {
        place[a] = static_cast<std::int32_t>(sums.size());
        sums.push_back({a, static_cast<std::int32_t>(b), 0, 0, 0, 0});
      }
      add_to(sums.data()[place[a]], part[i]);
    }
  }
  return sums;
}

/// Sorts by (a, b) what is in the order of b: counting sorts by a. `count`: of the regions.
ScratchList<Border> sorted(const ScratchList<Border>& by_b, std::size_t count, const Exec& exec) {
  Scratch<std::int32_t> start(count + 1, 0, exec.pool);  // of those with a
  for (const Border& border : by_b) ++start[border.a + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  ScratchList<Border> borders(by_b.size() + 1, exec.pool);
  Border* const place = borders.room_for(by_b.size());
  for (const Border& border : by_b) place[start[border.a]++] = border;
  borders.grown(by_b.size());
  return borders;
}

bool comes_before(const Border& p, const Border& q) {
  return p.a < q.a || (p.a == q.a && p.b < q.b);
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
  /// In the order of b.
  [[nodiscard]] ScratchList<Border> borders(const Exec& exec) const {
    return summed_up(first_, pieces_, exec);
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

/// Per region its border of least mean edge, where that is below `limit` (ties: the first in (a, b) order);
/// −1 = there is none. `count`: of the regions.
Scratch<std::int32_t> weakest_borders(const ScratchList<Border>& list, std::size_t count, double limit,
                                      const Exec& exec) {
  struct Weakest {
    double edge;
    std::int32_t border;
  };
  const double surely_strong = (1 + 1e-9) * limit;  // however the quotient rounds
  Scratch<Weakest> weakest(count, {limit, -1}, exec.pool);
  const Border* const borders = list.begin();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Border& border = borders[i];
    if (static_cast<double>(border.edge_sum) > surely_strong * static_cast<double>(border.length)) continue;
    const double edge = border.mean_edge();
    for (const std::int32_t end : {border.a, border.b}) {
      const Weakest so_far = weakest[end];
      const bool first_of_ties =
          edge == so_far.edge && so_far.border >= 0 && comes_before(border, borders[so_far.border]);
      // Stored in any case: nothing tells which border will be the weaker one.
      const bool weaker = (edge < so_far.edge) | first_of_ties;
      weakest[end] = {weaker ? edge : so_far.edge, weaker ? static_cast<std::int32_t>(i) : so_far.border};
    }
  }
  Scratch<std::int32_t> found(count, exec.pool);
  std::transform(weakest.begin(), weakest.end(), found.begin(), [](const Weakest& w) { return w.border; });
  return found;
}

/// The borders between regions that have fused, in the order of b. `numbers`: each region's now; `count`: how
/// many there are.
ScratchList<Border> moved(const ScratchList<Border>& borders, const Scratch<std::int32_t>& numbers,
                          std::size_t count, const Exec& exec) {
  Scratch<std::int32_t> first(count, -1, exec.pool);
  ScratchList<Part> parts(borders.size(), exec.pool);
  for (const Border& border : borders) {
    const auto [a, b] = std::minmax({numbers[border.a], numbers[border.b]});
    if (a == b) continue;
    const auto i = static_cast<std::int32_t>(parts.size());
    parts.push_back({first[b], a, &border});
    first[b] = i;
  }
  return summed_up(first, parts, exec);
}

/// Some of many regions, and borders whose ends are places among them.
struct Some {
  Scratch<std::int32_t> regions;  // ascending
  ScratchList<Border> borders;
};

/// Those that have a border below `limit`, and the borders between them. Whatever fuses, no other border ever
/// gets below it: the mean edge of a sum lies between those of its parts.
Some restless(const Scratch<std::int32_t>& regions, const ScratchList<Border>& borders, double limit,
              const Exec& exec) {
  Scratch<std::int32_t> place(regions.size(), -1, exec.pool);
  for (const Border& border : borders) {
    if (border.mean_edge() < limit) place[border.a] = place[border.b] = 0;
  }
  const auto count = static_cast<std::size_t>(std::count(place.begin(), place.end(), 0));
  Some some{Scratch<std::int32_t>(count, exec.pool), ScratchList<Border>(borders.size(), exec.pool)};
  std::int32_t next = 0;
  for (std::ptrdiff_t i = 0; i < signed_slot(place.size()); ++i) {
    if (place[i] < 0) continue;
    some.regions[next] = regions[i];
    place[i] = next++;
  }
  for (Border border : borders) {
    border.a = place[border.a];
    border.b = place[border.b];
    if (border.a >= 0 && border.b >= 0) some.borders.push_back(border);
  }
  return some;
}

/// Regions that fuse, round by round: each across its weakest border, where that is below `limit`.
class Fusing {
 public:
  Fusing(const Basins& basins, View<const std::uint16_t> edges, double limit, const Exec& exec)
      : exec_(exec),
        limit_(limit),
        count_(slot(basins.count)),
        facets_(count_, exec.pool),
        borders_(Contacts(basins.labels, edges, count_, exec).borders(exec)) {
    std::iota(facets_.begin(), facets_.end(), 0);
    DisjointSets fused(count_, exec.pool);
    if (!unite_across_weakest(borders_, count_, fused)) return;
    renumber(fused);
    // Few are left that anything will happen to.
    Scratch<std::int32_t> all(count_, exec.pool);
    std::iota(all.begin(), all.end(), 0);
    DisjointSets later(count_, exec.pool);
    fuse_on(restless(all, borders_, limit, exec), later);
    renumber(later);
  }

  [[nodiscard]] int count() const { return static_cast<int>(count_); }
  /// The facet of each basin.
  [[nodiscard]] const Scratch<std::int32_t>& facets() const { return facets_; }
  [[nodiscard]] std::vector<Border> borders() const {
    const ScratchList<Border> in_order = sorted(borders_, count_, exec_);
    return {in_order.begin(), in_order.end()};
  }

 private:
  /// False where none of the `count` regions has a weak one.
  bool unite_across_weakest(const ScratchList<Border>& borders, std::size_t count, DisjointSets& sets) const {
    bool any = false;
    for (const std::int32_t i : weakest_borders(borders, count, limit_, exec_)) {
      if (i < 0) continue;
      sets.unite(borders.begin()[i].a, borders.begin()[i].b);
      any = true;
    }
    return any;
  }

  /// All rounds but the first. Sets get numbers anew each time so that all stays small; their order is kept.
  void fuse_on(Some some, DisjointSets& all) const {
    for (int round = 1; round < kRounds; ++round) {
      DisjointSets fused(some.regions.size(), exec_.pool);
      if (!unite_across_weakest(some.borders, some.regions.size(), fused)) return;
      Scratch<std::int32_t> numbers(fused.size(), exec_.pool);
      const auto count = slot(fused.number(numbers.data()));
      Scratch<std::int32_t> roots(count, exec_.pool);
      for (std::int32_t i = 0; slot(i) < numbers.size(); ++i) {
        if (fused.is_root(i)) {
          roots[numbers[i]] = some.regions[i];
        } else {
          all.unite(roots[numbers[i]], some.regions[i]);
        }
      }
      some = restless(roots, moved(some.borders, numbers, count, exec_), limit_, exec_);
    }
  }

  void renumber(const DisjointSets& fused) {
    Scratch<std::int32_t> numbers(fused.size(), exec_.pool);
    const auto count = slot(fused.number(numbers.data()));
    if (count == count_) return;
    count_ = count;
    borders_ = moved(borders_, numbers, count_, exec_);
    for (std::int32_t& facet : facets_) facet = numbers[facet];
  }

  const Exec& exec_;
  double limit_;
  std::size_t count_;
  Scratch<std::int32_t> facets_;
  ScratchList<Border> borders_;  // in the order of b
};

/// What only one edge pixel in fifty is stronger than, in 1/4 grey level.
int clear_edge(View<const std::uint16_t> edges) {
  std::uint16_t strongest = 0;
  for (int y = 0; y < edges.height(); ++y) {
    const std::uint16_t* const row = edges.row(y);
    for (int x = 0; x < edges.width(); ++x) strongest = std::max(strongest, row[x]);
  }
  // Two counters for each strength: neighbours are often alike, and one would wait for the other.
  std::vector<std::array<std::int64_t, 2>> histogram(std::size_t{strongest} + 1);
  for (int y = 0; y < edges.height(); ++y) {
    const std::uint16_t* const row = edges.row(y);
    int x = 0;
    for (; x + 2 <= edges.width(); x += 2) {
      ++histogram[row[x]][0];
      ++histogram[row[x + 1]][1];
    }
    if (x < edges.width()) ++histogram[row[x]][0];
  }
  const auto count = [&](int strength) {
    return histogram[slot(strength)][0] + histogram[slot(strength)][1];
  };
  std::int64_t stronger = 0;
  int strength = static_cast<int>(histogram.size()) - 1;
  while (strength > 0 && 50 * (stronger + count(strength)) <= edges.size().area())
    stronger += count(strength--);
  return strength;
}

}  // namespace

std::vector<Border> borders_of(View<const RegionId> labels, View<const std::uint16_t> edges) {
  std::int32_t last = -1;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) last = std::max(last, number(labels(x, y)));
  }
  const Exec exec;
  const auto count = slot(last + 1);
  const ScratchList<Border> borders = sorted(Contacts(labels, edges, count, exec).borders(exec), count, exec);
  return {borders.begin(), borders.end()};
}

Facets segment_facets(View<const Gray> gray, View<const Rgb> rgb, float noise_sigma,
                      const FacetsConfig& config, const Exec& exec) {
  const Image<std::uint16_t> edges = edge_strength(gray, rgb, config.smoothing_sigma, exec);
  Basins basins = watershed(edges, exec);
  const double limit = 4.0 * (config.edge_min + config.noise_factor * noise_sigma) +
                       0.01 * config.contrast_share * clear_edge(edges);
  const Fusing fusing(basins, edges, limit, exec);
  const Scratch<std::int32_t>& facets = fusing.facets();
  parallel_for(exec, gray.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      RegionId* const row = basins.labels.row(y);
      for (int x = 0; x < gray.width(); ++x) row[x] = RegionId{facets[number(row[x])]};
    }
  });
  const int count = fusing.count();
  return {std::move(basins.labels), count, fusing.borders()};
}

Segmentation as_segmentation(const Facets& facets, View<const Gray> gray, const Exec& exec) {
  struct Sums {
    std::int64_t sum = 0;
    std::int64_t squares = 0;
  };
  struct Whole {
    Sums sums;
    Extent extent;
    int pixels = 0;
  };
  PoolMemory memory(exec.pool);
  std::pmr::vector<Whole> wholes(slot(facets.count), &memory);
  std::vector<Sums> until(slot(gray.width()) + 1);  // of the row's first pixels
  int row = -1;
  for_each_run(facets.labels, exec, [&](const Run& run) {
    if (run.y != row) {
      row = run.y;
      for (int x = 0; x < gray.width(); ++x) {
        const int grey = gray(x, row);
        until[slot(x) + 1] = {until[slot(x)].sum + grey, until[slot(x)].squares + grey * grey};
      }
    }
    Whole& whole = wholes[index(run.label)];
    whole.sums.sum += until[slot(run.last)].sum - until[slot(run.first)].sum;
    whole.sums.squares += until[slot(run.last)].squares - until[slot(run.first)].squares;
    whole.extent.add(run);
    whole.pixels += run.length();
  });
  Segmentation result{facets.labels.clone(exec.pool), std::vector<Region>(wholes.size())};
  for (std::size_t i = 0; i < wholes.size(); ++i) {
    Region& region = result.regions[i];
    region.pixel_count = wholes[i].pixels;
    region.valid_count = region.pixel_count;
    region.box = wholes[i].extent.box();
    region.mean = static_cast<double>(wholes[i].sums.sum) / region.pixel_count;
    region.variance = std::max(
        0.0, static_cast<double>(wholes[i].sums.squares) / region.pixel_count - region.mean * region.mean);
  }
  return result;
}

std::vector<std::int32_t> flooded(std::vector<std::int32_t> labels, const std::vector<Border>& borders,
                                  std::int32_t otherwise) {
  // Between two that are decided nothing flows.
  struct Channel {
    double edge;
    std::int32_t border;
  };
  std::vector<Channel> order;
  for (std::size_t i = 0; i < borders.size(); ++i) {
    if (labels[slot(borders[i].a)] < 0 || labels[slot(borders[i].b)] < 0) {
      order.push_back({borders[i].mean_edge(), static_cast<std::int32_t>(i)});
    }
  }
  std::sort(order.begin(), order.end(), [](const Channel& p, const Channel& q) {
    return std::tie(p.edge, p.border) < std::tie(q.edge, q.border);
  });
  DisjointSets sets(labels.size());
  for (const auto& [edge, i] : order) {
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
