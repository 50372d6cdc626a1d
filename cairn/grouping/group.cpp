// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/core/pool_memory.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/grouping/group.hpp>
#include <cairn/grouping/look_kernels.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <memory_resource>
#include <numeric>
#include <tuple>
#include <utility>

namespace cairn {
namespace {

constexpr double kBorderWeight = 0.1;    // of a pixel beside the facet's border
constexpr double kEvidenceWeight = 2.0;  // of a pixel with evidence, next to one without
constexpr float kLeastBefore = 0.3F;  // of the margin that figure needs: a surface may lean towards the floor
constexpr double kLeastWeight = 0.6;  // below it a facet's plane is anybody's guess
constexpr double kFlatness = 1000.0;  // px², at 320 px of width: spread below which slopes are damped
constexpr int kJoinRounds = 4;
constexpr double kEvidenceShare = 0.03;  // of a facet's pixels: with less it shows none of its own

/// Weighted moments of disparity over an area.
struct Plane {
  double weight = 0, x = 0, y = 0, d = 0;         // means
  double xx = 0, yy = 0, xy = 0, xd = 0, yd = 0;  // central sums

  /// Welford's update: one pass, no cancellation.
  void add(double px, double py, double pd, double w) { join({w, px, py, pd, 0, 0, 0, 0, 0}); }

  void join(const Plane& o) {
    const double total = weight + o.weight;
    if (!(total > 0)) return;
    const double dx = o.x - x;
    const double dy = o.y - y;
    const double dd = o.d - d;
    const double both = weight * o.weight / total;
    xx += o.xx + both * dx * dx;
    yy += o.yy + both * dy * dy;
    xy += o.xy + both * dx * dy;
    xd += o.xd + both * dx * dd;
    yd += o.yd + both * dy * dd;
    const double share = o.weight / total;
    x += share * dx;
    y += share * dy;
    d += share * dd;
    weight = total;
  }
};

/// The plane through such moments.
class Slope {
 public:
  Slope() = default;
  Slope(const Plane& p, double flatness) : x_(p.x), y_(p.y), d_(p.d) {
    const double sxx = p.xx + flatness;
    const double syy = p.yy + flatness;
    const double determinant = sxx * syy - p.xy * p.xy;
    a_ = (p.xd * syy - p.yd * p.xy) / determinant;
    b_ = (p.yd * sxx - p.xd * p.xy) / determinant;
  }
  [[nodiscard]] double at(double x, double y) const { return d_ + a_ * (x - x_) + b_ * (y - y_); }

 private:
  double x_ = 0, y_ = 0, d_ = 0;
  double a_ = 0, b_ = 0;
};

struct Arc {
  std::int32_t to;
  std::int32_t border;
};

/// Compact adjacency of the facets that are `usable`.
struct Neighbours {
  std::pmr::vector<std::int32_t> first;
  std::pmr::vector<Arc> arcs;
  Neighbours(const Facets& facets, const std::vector<std::uint8_t>& usable, std::pmr::memory_resource* memory)
      : first(slot(facets.count) + 1, memory), arcs(memory) {
    const auto inside = [&](const Border& b) { return (usable[slot(b.a)] & usable[slot(b.b)]) != 0; };
    for (const Border& b : facets.borders) {
      if (!inside(b)) continue;
      ++first[slot(b.a) + 1];
      ++first[slot(b.b) + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    arcs.resize(slot(first.back()));
    std::pmr::vector<std::int32_t> next(first.begin(), first.end() - 1, first.get_allocator());
    for (std::size_t i = 0; i < facets.borders.size(); ++i) {
      const Border& b = facets.borders[i];
      if (!inside(b)) continue;
      arcs[slot(next[slot(b.a)]++)] = {b.b, static_cast<std::int32_t>(i)};
      arcs[slot(next[slot(b.b)]++)] = {b.a, static_cast<std::int32_t>(i)};
    }
  }
};

/// What the facets show of themselves.
struct Shown {
  std::pmr::vector<Plane> planes;
  std::pmr::vector<std::int64_t> pixels;
  std::pmr::vector<std::int64_t> evidence;  // pixels with evidence before the background
  std::pmr::vector<Extent> extents;
  std::pmr::vector<std::int64_t> first;  // pixel, counted row by row
  Shown(std::size_t facets, std::pmr::memory_resource* memory)
      : planes(facets, memory),
        pixels(facets, memory),
        evidence(facets, memory),
        extents(facets, memory),
        first(facets, memory) {}
};

/// What the pixels of a row are judged by.
class RowJudge {
 public:
  RowJudge(const Facets& facets, const DisparityMap& disparity, View<const float> evidence_px,
           const Background& background, float margin_px, const Exec& exec)
      : run_(kernels::look_kernels(exec)),
        labels_(facets.labels),
        disparity_(disparity),
        evidence_px_(evidence_px),
        planes_(background.planes),
        margin_px_(margin_px),
        behind_px_(slot(labels_.width())),
        at_border_(slot(labels_.width())),
        taken_(slot(labels_.width())),
        before_(slot(labels_.width())),
        before_until_(slot(labels_.width()) + 1) {}

  void look_at(int y) {
    const int width = labels_.width();
    run_.find_behind(planes_.data(), static_cast<int>(planes_.size()), y, width, behind_px_.data());
    run_.mark_borders(labels_.row(std::max(y - 1, 0)), labels_.row(y),
                      labels_.row(std::min(y + 1, labels_.height() - 1)), width, at_border_.data());
    run_.judge({disparity_.reject.row(y), disparity_.disparity_px.row(y), evidence_px_.row(y),
                behind_px_.data(), at_border_.data()},
               width, kLeastBefore * margin_px_, margin_px_, taken_.data(), before_.data());
    for (std::size_t x = 0; x < before_.size(); ++x) before_until_[x + 1] = before_until_[x] + before_[x];
  }
  /// How many of the run's pixels have evidence before the background.
  [[nodiscard]] std::int32_t evidence_in(const Run& run) const {
    return before_until_[slot(run.last)] - before_until_[slot(run.first)];
  }
  /// What the pixel weighs in its facet's plane; 0 = nothing.
  [[nodiscard]] double weight(int x) const { return kWeights[static_cast<std::size_t>(taken_[slot(x)])]; }

 private:
  static constexpr std::array<double, 5> kWeights{0, kBorderWeight, kBorderWeight* kEvidenceWeight, 1,
                                                  kEvidenceWeight};
  const kernels::LookKernels& run_;
  View<const RegionId> labels_;
  const DisparityMap& disparity_;
  View<const float> evidence_px_;
  const std::vector<GroundPlane>& planes_;
  float margin_px_;
  std::vector<float> behind_px_;
  std::vector<std::uint8_t> at_border_;
  std::vector<kernels::Taken> taken_;
  std::vector<std::uint8_t> before_;
  std::vector<std::int32_t> before_until_;
};

Shown shown_by(const Facets& facets, const std::vector<std::int32_t>& figure, const DisparityMap& disparity,
               View<const float> evidence_px, const Background& background, float margin_px, const Exec& exec,
               std::pmr::memory_resource* memory) {
  Shown shown(slot(facets.count), memory);
  // Each thread has facets of its own, for their pixels must be taken in one order. What begins higher up in
  // the picture has the smaller number, so that most rows are one thread's alone.
  const int facets_each = (facets.count + exec.threads() - 1) / exec.threads();
  parallel_for(exec, facets.count, facets_each, [&](int first, int last) {
    RowJudge judge(facets, disparity, evidence_px, background, margin_px, exec);
    int row = -1;
    for_each_run(facets.labels, exec, [&](const Run& run) {
      if (number(run.label) < first || number(run.label) >= last) return;
      const std::size_t facet = index(run.label);
      if (shown.pixels[facet] == 0)
        shown.first[facet] = std::int64_t{run.y} * facets.labels.width() + run.first;
      shown.pixels[facet] += run.length();
      shown.extents[facet].add(run);
      if (figure[facet] == 0) return;
      if (run.y != row) judge.look_at(row = run.y);
      shown.evidence[facet] += judge.evidence_in(run);
      const float* const disparity_px = disparity.disparity_px.row(run.y);
      Plane plane = shown.planes[facet];  // where the compiler keeps it in registers
      for (int x = run.first; x < run.last; ++x) {
        const double weight = judge.weight(x);
        if (weight > 0) plane.add(x, run.y, disparity_px[x], weight);
      }
      shown.planes[facet] = plane;
    });
  });
  return shown;
}

/// Facets that may be nothing but what is seen between two objects.
std::vector<bool> gaps(const Facets& facets, const std::vector<std::int32_t>& figure, const Shown& shown,
                       double share) {
  std::vector<std::int64_t> around(figure.size());
  std::vector<std::int64_t> at_ground(figure.size());
  for (const Border& border : facets.borders) {
    for (const auto& [here, there] : {std::pair{border.a, border.b}, std::pair{border.b, border.a}}) {
      around[slot(here)] += border.length;
      if (figure[slot(there)] == 0) at_ground[slot(here)] += border.length;
    }
  }
  std::vector<bool> gap(figure.size());
  for (std::size_t i = 0; i < figure.size(); ++i) {
    const bool has_evidence =
        shown.evidence[i] >= 2 &&
        static_cast<double>(shown.evidence[i]) >= kEvidenceShare * static_cast<double>(shown.pixels[i]);
    gap[i] = !has_evidence && static_cast<double>(at_ground[i]) > share * static_cast<double>(around[i]);
  }
  return gap;
}

/// How far two disparities may differ within one surface at disparity d.
struct Tolerance {
  double least_px = 0;
  double share = 0;
  double doffs_px = 0;
  [[nodiscard]] double at(double d) const { return std::max(least_px, share * (d + doffs_px)); }
};

/// Grows groups from near to far.
class Growing {
 public:
  Growing(const Facets& facets, const std::vector<std::int32_t>& figure,
          const std::pmr::vector<Plane>& planes, const std::vector<bool>& gap, const Tolerance& step,
          const Tolerance& deviation, double flatness, std::pmr::memory_resource* memory)
      : facets_(facets),
        planes_(planes),
        usable_(usable(figure, planes, gap)),
        neighbours_(facets, usable_, memory),
        step_(step),
        deviation_(deviation),
        flatness_(flatness),
        slopes_(planes.size(), memory),
        steps_(facets.borders.size(), memory),
        group_(figure.size(), -1) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (usable_[i] != 0) slopes_[i] = Slope(planes[i], flatness);
    }
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const Border& b = facets.borders[i];
      if ((usable_[slot(b.a)] & usable_[slot(b.b)]) == 0) continue;
      steps_[i] = std::abs(slopes_[slot(b.a)].at(b.x(), b.y()) - slopes_[slot(b.b)].at(b.x(), b.y()));
    }
    for (const Seed& seed : nearest_first()) {
      if (group_[slot(seed.facet)] < 0) grow(seed.facet);
    }
  }

  /// Per facet the facet that its group began with; −1 = none.
  [[nodiscard]] const std::vector<std::int32_t>& groups() const { return group_; }
  /// Between two facets in groups.
  [[nodiscard]] double step_across(std::int32_t border) const { return steps_[slot(border)]; }

 private:
  struct Seed {
    double d;
    std::int32_t facet;
  };
  struct Candidate {
    double step;
    std::int32_t facet;
    std::int32_t border;
    friend bool operator>(const Candidate& p, const Candidate& q) {
      if (p.step != q.step) return p.step > q.step;
      return p.facet > q.facet || (p.facet == q.facet && p.border > q.border);
    }
  };

  static std::vector<std::uint8_t> usable(const std::vector<std::int32_t>& figure,
                                          const std::pmr::vector<Plane>& planes,
                                          const std::vector<bool>& gap) {
    std::vector<std::uint8_t> result(figure.size());
    for (std::size_t i = 0; i < figure.size(); ++i) {
      result[i] = figure[i] != 0 && !gap[i] && planes[i].weight >= kLeastWeight ? 1 : 0;
    }
    return result;
  }

  [[nodiscard]] std::pmr::vector<Seed> nearest_first() const {
    std::pmr::vector<Seed> seeds(slopes_.get_allocator());
    seeds.reserve(planes_.size());
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      if (usable_[i] != 0) seeds.push_back({planes_[i].d, static_cast<std::int32_t>(i)});
    }
    std::sort(seeds.begin(), seeds.end(),
              [](const Seed& p, const Seed& q) { return p.d > q.d || (p.d == q.d && p.facet < q.facet); });
    return seeds;
  }

  void offer_neighbours_of(std::int32_t facet) {
    for (std::int32_t i = neighbours_.first[slot(facet)]; i < neighbours_.first[slot(facet) + 1]; ++i) {
      const Arc arc = neighbours_.arcs[slot(i)];
      if (group_[slot(arc.to)] >= 0) continue;
      const double step = steps_[slot(arc.border)];
      if (!(step <= step_.at(planes_[slot(arc.to)].d))) continue;
      candidates_.push_back({step, arc.to, arc.border});
      std::push_heap(candidates_.begin(), candidates_.end(), std::greater<>());
    }
  }

  void grow(std::int32_t seed) {
    Plane whole = planes_[slot(seed)];
    Slope slope = slopes_[slot(seed)];
    group_[slot(seed)] = seed;
    candidates_.clear();
    offer_neighbours_of(seed);
    while (!candidates_.empty()) {
      const auto [step, facet, border] = candidates_.front();
      std::pop_heap(candidates_.begin(), candidates_.end(), std::greater<>());
      candidates_.pop_back();
      if (group_[slot(facet)] >= 0) continue;
      const Border& b = facets_.borders[slot(border)];
      const double off = std::abs(slope.at(b.x(), b.y()) - slopes_[slot(facet)].at(b.x(), b.y()));
      if (off > deviation_.at(planes_[slot(facet)].d)) continue;
      group_[slot(facet)] = seed;
      whole.join(planes_[slot(facet)]);
      slope = Slope(whole, flatness_);
      offer_neighbours_of(facet);
    }
  }

  const Facets& facets_;
  const std::pmr::vector<Plane>& planes_;
  std::vector<std::uint8_t> usable_;
  Neighbours neighbours_;
  Tolerance step_;
  Tolerance deviation_;
  double flatness_;
  std::pmr::vector<Slope> slopes_;
  std::pmr::vector<double> steps_;  // across each border
  std::vector<std::int32_t> group_;
  std::vector<Candidate> candidates_;  // a heap
};

std::vector<std::int64_t> areas(const std::vector<std::int32_t>& groups,
                                const std::pmr::vector<std::int64_t>& pixels) {
  std::vector<std::int64_t> area(groups.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] >= 0) area[slot(groups[i])] += pixels[i];
  }
  return area;
}

/// Groups under min_area join the large neighbour to which their common border is longest and smoothest.
void join_small(std::vector<std::int32_t>& groups, const Facets& facets, const Growing& growing,
                const std::pmr::vector<std::int64_t>& pixels, std::int64_t min_area) {
  for (int round = 0; round < kJoinRounds; ++round) {
    const std::vector<std::int64_t> area = areas(groups, pixels);
    const auto small = [&](std::int32_t g) { return area[slot(g)] < min_area; };
    std::vector<std::tuple<std::int32_t, std::int32_t, double>> contacts;  // small, large, strength
    for (std::size_t i = 0; i < facets.borders.size(); ++i) {
      const std::int32_t p = groups[slot(facets.borders[i].a)];
      const std::int32_t q = groups[slot(facets.borders[i].b)];
      if (p < 0 || q < 0 || p == q || small(p) == small(q)) continue;
      const double strength = static_cast<double>(facets.borders[i].length) /
                              (1.0 + growing.step_across(static_cast<std::int32_t>(i)));
      contacts.emplace_back(small(p) ? p : q, small(p) ? q : p, strength);
    }
    if (contacts.empty()) return;
    std::stable_sort(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) {
      return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
    });
    std::vector<std::int32_t> joins(groups.size(), -1);
    std::vector<double> best(groups.size(), 0.0);
    for (std::size_t i = 0; i < contacts.size();) {
      const auto [from, to, unused] = contacts[i];
      double sum = 0;
      for (; i < contacts.size() && std::get<0>(contacts[i]) == from && std::get<1>(contacts[i]) == to; ++i) {
        sum += std::get<2>(contacts[i]);
      }
      if (sum > best[slot(from)]) {
        best[slot(from)] = sum;
        joins[slot(from)] = to;
      }
    }
    for (std::int32_t& g : groups) {
      if (g >= 0 && joins[slot(g)] >= 0) g = joins[slot(g)];
    }
  }
}

/// A group as its occluded other half sees it.
struct Piece {
  Plane plane;
  Rect box;
  std::vector<std::int32_t> touches;  // sorted
};

/// Unites groups of one depth that do not touch, but both touch one that is nearer, and are close: the halves
/// of what that one parts. `groups`: per facet, 0 = background.
void unite_occluded(std::vector<std::int32_t>& groups, const Facets& facets, const Shown& shown,
                    const Tolerance& tolerance, double gap_px) {
  std::map<std::int32_t, Piece> pieces;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] == 0) continue;
    Piece& piece = pieces[groups[i]];
    piece.plane.join(shown.planes[i]);
    piece.box = united(piece.box, shown.extents[i].box());
  }
  for (const Border& border : facets.borders) {
    const std::int32_t p = groups[slot(border.a)];
    const std::int32_t q = groups[slot(border.b)];
    if (p == 0 || q == 0 || p == q) continue;
    pieces[p].touches.push_back(q);
    pieces[q].touches.push_back(p);
  }
  for (auto& [id, piece] : pieces) {
    std::sort(piece.touches.begin(), piece.touches.end());
    piece.touches.erase(std::unique(piece.touches.begin(), piece.touches.end()), piece.touches.end());
  }
  const auto nearer_between = [&](const Piece& p, const Piece& q, double slack) {
    return std::any_of(p.touches.begin(), p.touches.end(), [&](std::int32_t id) {
      return pieces[id].plane.d > std::max(p.plane.d, q.plane.d) + slack &&
             std::binary_search(q.touches.begin(), q.touches.end(), id);
    });
  };
  std::map<std::int32_t, std::int32_t> now;
  for (const auto& [id, piece] : pieces) now[id] = id;
  for (const auto& [p_id, p] : pieces) {
    for (const auto& [q_id, q] : pieces) {
      if (q_id <= p_id || std::binary_search(p.touches.begin(), p.touches.end(), q_id)) continue;
      const double slack = tolerance.at(std::max(p.plane.d, q.plane.d));
      const Size apart = gap_between(p.box, q.box);
      if (std::abs(p.plane.d - q.plane.d) > slack) continue;
      if (std::hypot(apart.width, apart.height) >= gap_px) continue;
      if (!nearer_between(p, q, slack)) continue;
      const std::int32_t kept = std::min(now[p_id], now[q_id]);
      const std::int32_t given_up = std::max(now[p_id], now[q_id]);
      for (auto& [id, whole] : now) whole = whole == given_up ? kept : whole;
    }
  }
  for (std::int32_t& group : groups) group = group == 0 ? 0 : now[group];
}

/// A list of disparities, and the mean and the squared deviations of those taken in so far (Welford's
/// update).
struct Spread {
  const float* next = nullptr;
  int left = 0;
  double count = 0;
  double mean = 0;
  double squares = 0;

  void take_in_next() {
    const double d = *next++;
    --left;
    ++count;
    const double delta = d - mean;
    mean += delta / count;
    squares += delta * (d - mean);
  }
};

/// Takes in all of some lists, several side by side: in each one every value waits for the division of the
/// one before.
void take_in_all(std::vector<Spread>& spreads) {
  constexpr std::size_t kLanes = 4;
  std::vector<Spread*> waiting;
  waiting.reserve(spreads.size());
  for (Spread& spread : spreads) waiting.push_back(&spread);
  std::sort(waiting.begin(), waiting.end(), [](auto* p, auto* q) { return p->left < q->left; });
  std::vector<Spread*> lanes;
  for (;;) {
    std::erase_if(lanes, [](const Spread* lane) { return lane->left == 0; });
    while (lanes.size() < kLanes && !waiting.empty() && waiting.back()->left > 0) {
      lanes.push_back(waiting.back());  // the longest first: it is what the others are done beside
      waiting.pop_back();
    }
    if (lanes.empty()) return;
    const int steps = (*std::min_element(lanes.begin(), lanes.end(), [](auto* p, auto* q) {
                        return p->left < q->left;
                      }))->left;
    // Where fewer are left, one is taken in several times.
    std::array<Spread, kLanes> at;
    for (std::size_t k = 0; k < kLanes; ++k) at.at(k) = *lanes[std::min(k, lanes.size() - 1)];
    for (int i = 0; i < steps; ++i) {
      for (Spread& spread : at) spread.take_in_next();
    }
    for (std::size_t k = 0; k < lanes.size(); ++k) *lanes[k] = at.at(k);
  }
}

/// Numbers groups in raster order of their first pixels; the background stays 0. `groups`: per facet, where
/// that has pixels.
std::int32_t renumber(std::vector<std::int32_t>& groups, const Shown& shown) {
  std::vector<std::int32_t> order(groups.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](std::int32_t p, std::int32_t q) {
    return shown.first[slot(p)] < shown.first[slot(q)];
  };
  if (!std::is_sorted(order.begin(), order.end(), before)) std::sort(order.begin(), order.end(), before);
  std::vector<std::int32_t> renumbered(groups.size() + 1, -1);
  renumbered[0] = 0;
  std::int32_t count = 1;
  for (const std::int32_t facet : order) {
    if (shown.pixels[slot(facet)] == 0) continue;
    std::int32_t& id = renumbered[slot(groups[slot(facet)])];
    if (id < 0) id = count++;
    groups[slot(facet)] = id;
  }
  return count;
}

/// The groups as regions. `groups`: per facet, 0 = background.
Segmentation as_regions(std::vector<std::int32_t> groups, const Facets& facets, const Shown& shown,
                        const Exec& exec) {
  const std::int32_t count = renumber(groups, shown);
  Segmentation result{Image<RegionId>(facets.labels.size(), exec.pool), std::vector<Region>(slot(count))};
  for (int y = 0; y < facets.labels.height(); ++y) {
    const RegionId* const facet = facets.labels.row(y);
    RegionId* const group = result.labels.row(y);
    for (int x = 0; x < facets.labels.width(); ++x) group[x] = RegionId{groups[index(facet[x])]};
  }
  result.regions[0].is_background = true;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (shown.pixels[i] == 0) continue;
    Region& region = result.regions[slot(groups[i])];
    region.pixel_count += static_cast<int>(shown.pixels[i]);
    region.box = united(region.box, shown.extents[i].box());
  }
  return result;
}

/// Adds what is known of their disparities.
Segmentation measured(Segmentation segmentation, const DisparityMap& disparity, const Exec& exec) {
  std::vector<Region>& regions = segmentation.regions;
  // The disparities of each region in raster order, one region after the other, each with room for one more:
  // every value is written, and the next one over it where it does not count.
  Scratch<float> values(static_cast<std::size_t>(segmentation.labels.size().area()) + regions.size(),
                        exec.pool);
  std::vector<float*> ends;
  float* first = values.begin();
  for (const Region& region : regions) {
    ends.push_back(first);
    first += region.pixel_count + 1;
  }
  for_each_run(segmentation.labels, exec, [&](const Run& run) {
    const Reject* const reject = disparity.reject.row(run.y);
    const float* const disparity_px = disparity.disparity_px.row(run.y);
    float* end = ends[index(run.label)];
    for (int x = run.first; x < run.last; ++x) {
      *end = disparity_px[x];
      end += reject[x] == Reject::none ? 1 : 0;
    }
    ends[index(run.label)] = end;
  });
  std::vector<Spread> spreads(regions.size());
  first = values.begin();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    spreads[i].next = first;
    spreads[i].left = static_cast<int>(ends[i] - first);
    regions[i].valid_count = spreads[i].left;
    first += regions[i].pixel_count + 1;
  }
  take_in_all(spreads);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    regions[i].mean = spreads[i].mean;
    regions[i].variance = spreads[i].squares / std::max(regions[i].valid_count, 1);
  }
  return segmentation;
}

}  // namespace

Segmentation group_facets(const Facets& facets, const std::vector<std::int32_t>& figure,
                          const DisparityMap& disparity, View<const float> evidence_px,
                          const Background& background, const std::optional<StereoRig>& rig,
                          const FigureConfig& figure_config, const GroupConfig& config, const Exec& exec) {
  const Size size = facets.labels.size();
  const float per_mille = 0.001F * static_cast<float>(size.width);
  const double scale = static_cast<double>(size.width) / 320.0;
  const double doffs = rig ? rig->doffs_px : 0.0F;
  const Tolerance step{config.step * per_mille, 0.01 * config.step_share, doffs};
  const Tolerance deviation{config.deviation * per_mille, 0.01 * config.deviation_share, doffs};
  PoolMemory memory(exec.pool);
  const Shown shown = shown_by(facets, figure, disparity, evidence_px, background,
                               figure_config.margin * per_mille, exec, &memory);
  const std::vector<bool> gap = gaps(facets, figure, shown, 0.01 * config.gap_share);
  const Growing growing(facets, figure, shown.planes, gap, step, deviation, kFlatness * scale * scale,
                        &memory);
  std::vector<std::int32_t> groups = growing.groups();
  join_small(groups, facets, growing, shown.pixels, pixels_in(config.min_area, size));

  // 0 = background; groups from 1; figure without disparity follows its weakest border.
  for (std::size_t i = 0; i < groups.size(); ++i)
    groups[i] = figure[i] == 0 ? 0 : groups[i] < 0 ? -1 : groups[i] + 1;
  groups = flooded(std::move(groups), facets.borders, 0);
  if (config.occluded_gap > 0) {
    unite_occluded(groups, facets, shown, step, 0.01 * config.occluded_gap * size.width);
  }
  return measured(as_regions(std::move(groups), facets, shown, exec), disparity, exec);
}

}  // namespace cairn
