// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/group.hpp"

#include <algorithm>
#include <cairn/regions/percent.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "reference/evidence.hpp"

namespace cairn::reference {
namespace {

constexpr double kBorderWeight = 0.1;    // of a pixel beside the facet's border
constexpr double kEvidenceWeight = 2.0;  // of a pixel with evidence, next to one without
constexpr float kLeastBefore = 0.3F;  // of the margin that figure needs: a surface may lean towards the floor
constexpr double kLeastWeight = 0.6;  // below it a facet's plane is anybody's guess
constexpr double kFlatness = 1000.0;  // px², at 320 px of width: spread below which slopes are damped
constexpr int kJoinRounds = 4;
constexpr double kEvidenceShare = 0.03;  // of a facet's pixels: with less it shows none of its own

/// Weighted moments of disparity over an area, and the plane through them.
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

  [[nodiscard]] double at(double px, double py, double flatness) const {
    const double sxx = xx + flatness;
    const double syy = yy + flatness;
    const double determinant = sxx * syy - xy * xy;
    const double a = (xd * syy - yd * xy) / determinant;
    const double b = (yd * sxx - xd * xy) / determinant;
    return d + a * (px - x) + b * (py - y);
  }
};

struct Arc {
  std::int32_t to;
  std::int32_t border;
};

/// Compact adjacency of the figure facets.
struct Neighbours {
  std::vector<std::int32_t> first;
  std::vector<Arc> arcs;
  Neighbours(const Facets& facets, const std::vector<std::int32_t>& figure) : first(slot(facets.count) + 1) {
    const auto inside = [&](const Border& b) { return figure[slot(b.a)] != 0 && figure[slot(b.b)] != 0; };
    for (const Border& b : facets.borders) {
      if (!inside(b)) continue;
      ++first[slot(b.a) + 1];
      ++first[slot(b.b) + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    arcs.resize(slot(first.back()));
    std::vector<std::int32_t> next(first.begin(), first.end() - 1);
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
  std::vector<Plane> planes;
  std::vector<std::int64_t> pixels;
  std::vector<std::int64_t> evidence;  // pixels with evidence before the background
  std::vector<Rect> boxes;
  explicit Shown(std::size_t facets) : planes(facets), pixels(facets), evidence(facets), boxes(facets) {}
};

Shown shown_by(const Facets& facets, const std::vector<std::int32_t>& figure, const DisparityMap& disparity,
               View<const float> evidence_px, const Background& background, float margin_px) {
  Shown shown(slot(facets.count));
  for (int y = 0; y < facets.labels.height(); ++y) {
    for (int x = 0; x < facets.labels.width(); ++x) {
      const std::size_t facet = index(facets.labels(x, y));
      ++shown.pixels[facet];
      shown.boxes[facet] = united(shown.boxes[facet], {x, y, 1, 1});
      if (figure[facet] == 0) continue;
      const float behind = background.disparity_px(static_cast<float>(x), static_cast<float>(y));
      if (evidence_px(x, y) - behind > margin_px) ++shown.evidence[facet];
      const float d = disparity.disparity_px(x, y);
      if (disparity.reject(x, y) != Reject::none || !(d - behind > kLeastBefore * margin_px)) continue;
      const double weight = (beside_border(facets.labels, x, y) ? kBorderWeight : 1.0) *
                            (std::isnan(evidence_px(x, y)) ? 1.0 : kEvidenceWeight);
      shown.planes[facet].add(x, y, d, weight);
    }
  }
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
  Growing(const Facets& facets, const std::vector<std::int32_t>& figure, const std::vector<Plane>& planes,
          const std::vector<bool>& gap, const Tolerance& step, const Tolerance& deviation, double flatness)
      : facets_(facets),
        planes_(planes),
        neighbours_(facets, figure),
        step_(step),
        deviation_(deviation),
        flatness_(flatness),
        group_(figure.size(), -1) {
    std::vector<std::int32_t> order;
    for (std::size_t i = 0; i < figure.size(); ++i) {
      if (figure[i] != 0 && !gap[i] && planes[i].weight >= kLeastWeight)
        order.push_back(static_cast<std::int32_t>(i));
    }
    usable_.assign(figure.size(), false);
    for (const std::int32_t i : order) usable_[slot(i)] = true;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t p, std::int32_t q) { return planes[slot(p)].d > planes[slot(q)].d; });
    for (const std::int32_t seed : order) {
      if (group_[slot(seed)] < 0) grow(seed);
    }
  }

  /// Per facet the facet that its group began with; −1 = none.
  [[nodiscard]] const std::vector<std::int32_t>& groups() const { return group_; }
  [[nodiscard]] double step_across(std::int32_t border) const {
    const Border& b = facets_.borders[slot(border)];
    return std::abs(planes_[slot(b.a)].at(b.x(), b.y(), flatness_) -
                    planes_[slot(b.b)].at(b.x(), b.y(), flatness_));
  }

 private:
  using Candidate = std::tuple<double, std::int32_t, std::int32_t>;  // step, facet, border

  void grow(std::int32_t seed) {
    Plane whole = planes_[slot(seed)];
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
    const auto offer_neighbours_of = [&](std::int32_t facet) {
      for (std::int32_t i = neighbours_.first[slot(facet)]; i < neighbours_.first[slot(facet) + 1]; ++i) {
        const Arc arc = neighbours_.arcs[slot(i)];
        if (group_[slot(arc.to)] >= 0 || !usable_[slot(arc.to)]) continue;
        const double step = step_across(arc.border);
        if (step <= step_.at(planes_[slot(arc.to)].d)) candidates.emplace(step, arc.to, arc.border);
      }
    };
    group_[slot(seed)] = seed;
    offer_neighbours_of(seed);
    while (!candidates.empty()) {
      const auto [step, facet, border] = candidates.top();
      candidates.pop();
      if (group_[slot(facet)] >= 0) continue;
      const Border& b = facets_.borders[slot(border)];
      const Plane& plane = planes_[slot(facet)];
      const double off = std::abs(whole.at(b.x(), b.y(), flatness_) - plane.at(b.x(), b.y(), flatness_));
      if (off > deviation_.at(plane.d)) continue;
      group_[slot(facet)] = seed;
      whole.join(plane);
      offer_neighbours_of(facet);
    }
  }

  const Facets& facets_;
  const std::vector<Plane>& planes_;
  Neighbours neighbours_;
  Tolerance step_;
  Tolerance deviation_;
  double flatness_;
  std::vector<bool> usable_;
  std::vector<std::int32_t> group_;
};

std::vector<std::int64_t> areas(const std::vector<std::int32_t>& groups,
                                const std::vector<std::int64_t>& pixels) {
  std::vector<std::int64_t> area(groups.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] >= 0) area[slot(groups[i])] += pixels[i];
  }
  return area;
}

/// Groups under min_area join the large neighbour to which their common border is longest and smoothest.
void join_small(std::vector<std::int32_t>& groups, const Facets& facets, const Growing& growing,
                const std::vector<std::int64_t>& pixels, std::int64_t min_area) {
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
    piece.box = united(piece.box, shown.boxes[i]);
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

/// The groups as regions, with what is known of their disparities. `groups`: per facet, 0 = background.
Segmentation regions_of(const std::vector<std::int32_t>& groups, const Facets& facets,
                        const DisparityMap& disparity) {
  std::map<std::int32_t, std::int32_t> renumbered{{0, 0}};
  Segmentation result{Image<RegionId>(facets.labels.size()), std::vector<Region>(1)};
  result.regions[0].is_background = true;
  for (int y = 0; y < facets.labels.height(); ++y) {
    for (int x = 0; x < facets.labels.width(); ++x) {
      const auto next = static_cast<std::int32_t>(renumbered.size());
      const auto [known, is_new] = renumbered.try_emplace(groups[index(facets.labels(x, y))], next);
      if (is_new) result.regions.emplace_back();
      result.labels(x, y) = RegionId{known->second};
      Region& region = result.regions[slot(known->second)];
      ++region.pixel_count;
      region.box = united(region.box, {x, y, 1, 1});
      if (disparity.reject(x, y) != Reject::none) continue;
      const double d = disparity.disparity_px(x, y);
      ++region.valid_count;
      const double delta = d - region.mean;
      region.mean += delta / region.valid_count;
      region.variance += delta * (d - region.mean);
    }
  }
  for (Region& region : result.regions) region.variance /= std::max(region.valid_count, 1);
  return result;
}

}  // namespace

Segmentation group_facets(const Facets& facets, const std::vector<std::int32_t>& figure,
                          const DisparityMap& disparity, View<const float> evidence_px,
                          const Background& background, const std::optional<StereoRig>& rig,
                          const FigureConfig& figure_config, const GroupConfig& config) {
  const Size size = facets.labels.size();
  const float per_mille = 0.001F * static_cast<float>(size.width);
  const double scale = static_cast<double>(size.width) / 320.0;
  const double doffs = rig ? rig->doffs_px : 0.0F;
  const Tolerance step{config.step * per_mille, 0.01 * config.step_share, doffs};
  const Tolerance deviation{config.deviation * per_mille, 0.01 * config.deviation_share, doffs};
  const Shown shown =
      shown_by(facets, figure, disparity, evidence_px, background, figure_config.margin * per_mille);
  const std::vector<bool> gap = gaps(facets, figure, shown, 0.01 * config.gap_share);
  const Growing growing(facets, figure, shown.planes, gap, step, deviation, kFlatness * scale * scale);
  std::vector<std::int32_t> groups = growing.groups();
  join_small(groups, facets, growing, shown.pixels, pixels_in(config.min_area, size));

  // 0 = background; groups from 1; figure without disparity follows its weakest border.
  for (std::size_t i = 0; i < groups.size(); ++i)
    groups[i] = figure[i] == 0 ? 0 : groups[i] < 0 ? -1 : groups[i] + 1;
  groups = reference::flooded(std::move(groups), facets.borders, 0);
  if (config.occluded_gap > 0) {
    unite_occluded(groups, facets, shown, step, 0.01 * config.occluded_gap * size.width);
  }
  return regions_of(groups, facets, disparity);
}

}  // namespace cairn::reference
