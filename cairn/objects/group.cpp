// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/objects/group.hpp>
#include <cairn/regions/percent.hpp>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>

namespace cairn {
namespace {

constexpr double kBorderWeight = 0.1;    // of a pixel beside the facet's border
constexpr double kEvidenceWeight = 2.0;  // of a pixel with evidence, next to one without
constexpr double kLeastWeight = 0.6;     // below it a facet's plane is anybody's guess
constexpr double kFlatness = 1000.0;     // px², at 320 px of width: spread below which slopes are damped
constexpr int kJoinRounds = 4;

std::size_t slot(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

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

bool beside_border(View<const RegionId> labels, int x, int y) {
  const RegionId here = labels(x, y);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, labels.height() - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, labels.width() - 1); ++u) {
      if (labels(u, v) != here) return true;
    }
  }
  return false;
}

std::vector<Plane> facet_planes(const Facets& facets, const std::vector<std::int32_t>& figure,
                                const DisparityMap& disparity, View<const float> evidence_px,
                                const Background& background, float least_before_px) {
  std::vector<Plane> planes(slot(facets.count));
  const View<const RegionId> labels = facets.labels;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      if (figure[index(labels(x, y))] == 0 || disparity.reject(x, y) != Reject::none) continue;
      const float d = disparity.disparity_px(x, y);
      const float behind = background.disparity_px(static_cast<float>(x), static_cast<float>(y));
      if (!(d - behind > least_before_px)) continue;
      const double weight = (beside_border(labels, x, y) ? kBorderWeight : 1.0) *
                            (std::isnan(evidence_px(x, y)) ? 1.0 : kEvidenceWeight);
      planes[index(labels(x, y))].add(x, y, d, weight);
    }
  }
  return planes;
}

/// Grows groups from near to far.
class Growing {
 public:
  Growing(const Facets& facets, const std::vector<std::int32_t>& figure, const std::vector<Plane>& planes,
          double step, double deviation, double flatness)
      : facets_(facets),
        planes_(planes),
        neighbours_(facets, figure),
        step_(step),
        deviation_(deviation),
        flatness_(flatness),
        group_(figure.size(), -1) {
    std::vector<std::int32_t> order;
    for (std::size_t i = 0; i < figure.size(); ++i) {
      if (figure[i] != 0 && planes[i].weight >= kLeastWeight) order.push_back(static_cast<std::int32_t>(i));
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
        if (step <= step_) candidates.emplace(step, arc.to, arc.border);
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
      if (std::abs(whole.at(b.x(), b.y(), flatness_) - plane.at(b.x(), b.y(), flatness_)) > deviation_)
        continue;
      group_[slot(facet)] = seed;
      whole.join(plane);
      offer_neighbours_of(facet);
    }
  }

  const Facets& facets_;
  const std::vector<Plane>& planes_;
  Neighbours neighbours_;
  double step_;
  double deviation_;
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

}  // namespace

Segmentation group_facets(const Facets& facets, const std::vector<std::int32_t>& figure,
                          const DisparityMap& disparity, View<const float> evidence_px,
                          const Background& background, const FigureConfig& figure_config,
                          const GroupConfig& config, const Exec& exec) {
  const Size size = facets.labels.size();
  const float per_mille = 0.001F * static_cast<float>(size.width);
  const double scale = static_cast<double>(size.width) / 320.0;
  const std::vector<Plane> planes = facet_planes(facets, figure, disparity, evidence_px, background,
                                                 0.3F * figure_config.margin * per_mille);
  const Growing growing(facets, figure, planes, config.step * per_mille, config.deviation * per_mille,
                        kFlatness * scale * scale);

  std::vector<std::int64_t> pixels(slot(facets.count));
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) ++pixels[index(facets.labels(x, y))];
  }
  std::vector<std::int32_t> groups = growing.groups();
  join_small(groups, facets, growing, pixels, pixels_in(config.min_area, size));

  // 0 = background; groups from 1; figure without disparity follows its weakest border.
  for (std::size_t i = 0; i < groups.size(); ++i)
    groups[i] = figure[i] == 0 ? 0 : groups[i] < 0 ? -1 : groups[i] + 1;
  groups = flooded(std::move(groups), facets.borders, 0);
  std::vector<std::int32_t> renumbered(groups.size() + 1, -1);
  renumbered[0] = 0;
  std::int32_t count = 1;
  Segmentation result{Image<RegionId>(size, exec.pool), {}};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      std::int32_t& id = renumbered[slot(groups[index(facets.labels(x, y))])];
      if (id < 0) id = count++;
      result.labels(x, y) = RegionId{id};
    }
  }
  result.regions.resize(slot(count));
  result.regions[0].is_floor = true;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      Region& region = result.regions[index(result.labels(x, y))];
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

}  // namespace cairn
