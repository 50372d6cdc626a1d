// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "grouping.hpp"

#include <algorithm>
#include <cairn/regions/object_hints.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "regions.hpp"
#include "textured.hpp"

namespace cairn::reference {
namespace {

/// Calls look(p, q) for each pixel and its right neighbour, then the lower one.
template <class Look>
void for_each_pair(Size size, Look look) {
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (x + 1 < size.width) look(Point{x, y}, Point{x + 1, y});
      if (y + 1 < size.height) look(Point{x, y}, Point{x, y + 1});
    }
  }
}

// ---- superpixels ----

/// Calls look(p, q) row by row: for each pixel and its right neighbour, then for each and the lower one.
template <class Look>
void for_each_pair_by_rows(Size size, Look look) {
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x + 1 < size.width; ++x) look(Point{x, y}, Point{x + 1, y});
    if (y + 1 == size.height) break;
    for (int x = 0; x < size.width; ++x) look(Point{x, y}, Point{x, y + 1});
  }
}

/// Where pixel i of n lies among `cells`: the cells around it, and how far it is from the first one's centre, in
/// 1/256, rounded down.
struct Place {
  int first = 0;
  int next = 0;
  std::int64_t part = 0;
};

Place place_of(int i, int n, int cells) {
  // Cell c has its centre at (c + 1/2) · n / cells, pixel i at i + 1/2.
  const double at = (2.0 * i + 1) * cells / (2.0 * n) - 0.5;
  const int before = static_cast<int>(std::floor(at));
  // In whole numbers, as the rest may lie between two of them.
  const std::int64_t rest = (2 * std::int64_t{i} + 1) * cells - n - 2 * std::int64_t{n} * before;
  return {std::clamp(before, 0, cells - 1), std::clamp(before + 1, 0, cells - 1), rest * 256 / (2 * n)};
}

Image<std::uint16_t> with_outlines(View<const std::uint16_t> edges, View<const ObjectHint> hints) {
  Image<std::uint16_t> stronger(edges.size());
  for (int y = 0; y < edges.height(); ++y) {
    for (int x = 0; x < edges.width(); ++x) {
      std::int64_t share = 0;
      if (!hints.empty()) {
        const Place across = place_of(x, edges.width(), hints.width());
        const Place down = place_of(y, edges.height(), hints.height());
        const auto of_column = [&](int c) {
          return outline_share(hints(c, down.first).outline) * (256 - down.part) +
                 outline_share(hints(c, down.next).outline) * down.part;
        };
        share =
            (of_column(across.first) * (256 - across.part) + of_column(across.next) * across.part) / 65536;
      }
      const std::int64_t edge = edges(x, y) + (3 * edges(x, y) + 32) * share / 256;
      stronger(x, y) = static_cast<std::uint16_t>(std::min<std::int64_t>(edge, 65000));
    }
  }
  return stronger;
}

Image<std::uint16_t> with_depth(View<const std::uint16_t> edges, View<const float> disparity_px,
                                float noise_sigma) {
  Image<std::uint16_t> sum(edges.size());
  for (int y = 0; y < edges.height(); ++y) {
    for (int x = 0; x < edges.width(); ++x) {
      double step = 0;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (!edges.contains(x + dx, y + dy)) continue;
        const double to = std::abs(double{disparity_px(x + dx, y + dy)} - double{disparity_px(x, y)});
        if (!std::isnan(to)) step = std::max(step, to);
      }
      const double grey_levels = std::min(2 * step, 8.0);
      const double edge = edges(x, y) + std::floor(4 * grey_levels + 0.5);
      const bool is_one = edge / 4 >= std::floor(4 * (1 + double{noise_sigma})) / 4;
      sum(x, y) = static_cast<std::uint16_t>(is_one ? edge : 0);
    }
  }
  return sum;
}

struct Seam {
  std::pair<std::int32_t, std::int32_t> between;
  int length = 0;
  double edges = 0;  // grey levels
};

/// In order of first occurrence, row by row.
std::vector<Seam> seams_of(View<const RegionId> labels, View<const std::uint16_t> edges) {
  std::vector<Seam> seams;
  for_each_pair_by_rows(labels.size(), [&](Point p, Point q) {
    const std::pair<std::int32_t, std::int32_t> between =
        std::minmax(number(labels(p.x, p.y)), number(labels(q.x, q.y)));
    if (between.first == between.second) return;
    auto known =
        std::find_if(seams.begin(), seams.end(), [&](const Seam& s) { return s.between == between; });
    if (known == seams.end()) known = seams.insert(known, {between});
    known->length += 1;
    known->edges += std::max(edges(p.x, p.y), edges(q.x, q.y)) / 4.0;
  });
  return seams;
}

int area_of(View<const RegionId> labels, std::int32_t region) {
  int area = 0;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) area += number(labels(x, y)) == region ? 1 : 0;
  }
  return area;
}

/// The two superpixels to fuse next.
std::optional<std::pair<std::int32_t, std::int32_t>> next_two(View<const RegionId> labels,
                                                              View<const std::uint16_t> edges) {
  std::optional<std::pair<std::int32_t, std::int32_t>> two;
  double least = 0;
  std::map<std::int32_t, int> areas;
  for (const Seam& seam : seams_of(labels, edges)) {
    for (const std::int32_t region : {seam.between.first, seam.between.second}) {
      if (!areas.contains(region)) areas[region] = area_of(labels, region);
    }
    const int smaller = std::min(areas[seam.between.first], areas[seam.between.second]);
    const double cost = (seam.edges / seam.length + 0.5) * std::sqrt(static_cast<double>(smaller));
    if (two && cost >= least) continue;
    two = seam.between;
    least = cost;
  }
  return two;
}

Image<std::uint16_t> half_of(View<const std::uint16_t> edges) {
  Image<std::uint16_t> half({(edges.width() + 1) / 2, (edges.height() + 1) / 2});
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      double sum = 0;
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
        sum += edges(std::min(2 * x + dx, edges.width() - 1), std::min(2 * y + dy, edges.height() - 1));
      half(x, y) = static_cast<std::uint16_t>(std::floor(sum / 4 + 0.5));
    }
  }
  return half;
}

void rename(Image<RegionId>& labels, RegionId from, RegionId to) {
  for (int y = 0; y < labels.height(); ++y)
    std::replace(labels.row(y), labels.row(y) + labels.width(), from, to);
}

void number_in_raster_order(Image<RegionId>& labels) {
  std::map<RegionId, RegionId> numbers;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const RegionId next{static_cast<std::int32_t>(numbers.size())};
      labels(x, y) = numbers.try_emplace(labels(x, y), next).first->second;
    }
  }
}

/// Basins of fewer than `least` pixels join the neighbour across their lowest pass, all at once.
void join_small_basins(Basins& basins, View<const std::uint16_t> edges, std::int64_t least) {
  struct Pass {
    int edge;
    std::int32_t to;
  };
  std::map<std::int32_t, Pass> lowest;
  for_each_pair_by_rows(edges.size(), [&](Point p, Point q) {
    const std::int32_t a = number(basins.labels(p.x, p.y));
    const std::int32_t b = number(basins.labels(q.x, q.y));
    if (a == b) return;
    const int edge = std::max(edges(p.x, p.y), edges(q.x, q.y));
    for (const auto& [from, to] : {std::pair{a, b}, {b, a}}) {
      const auto known = lowest.try_emplace(from, Pass{edge, to}).first;
      if (edge < known->second.edge) known->second = {edge, to};
    }
  });
  std::vector<int> areas;
  for (std::int32_t basin = 0; basin < basins.count; ++basin) areas.push_back(area_of(basins.labels, basin));
  std::vector<RegionId> now;  // the label of each basin's pixels
  for (std::int32_t basin = 0; basin < basins.count; ++basin) now.push_back(RegionId{basin});
  for (const auto& [basin, pass] : lowest) {
    if (areas[slot(basin)] >= least) continue;
    const RegionId from = now[slot(basin)];
    const RegionId to = now[slot(pass.to)];
    rename(basins.labels, from, to);
    std::replace(now.begin(), now.end(), from, to);
  }
  number_in_raster_order(basins.labels);
  basins.count = 0;
  for (int y = 0; y < edges.height(); ++y) {
    for (int x = 0; x < edges.width(); ++x)
      basins.count = std::max(basins.count, number(basins.labels(x, y)) + 1);
  }
}

/// A move of an outline by one pixel.
struct Move {
  int rise = 0;  // from it and the pixel ahead to the pixel behind it, if positive
  RegionId to{-1};
};

/// The best of at most two; vertically before across.
Move move_of(View<const RegionId> labels, View<const std::uint16_t> edges, Point p) {
  Move best;
  for (const auto& [dx, dy] : {std::pair{0, 1}, {1, 0}}) {
    for (const int sign : {1, -1}) {
      const Point ahead{p.x + sign * dx, p.y + sign * dy};
      if (!edges.contains(ahead.x, ahead.y) || labels(ahead.x, ahead.y) == labels(p.x, p.y)) continue;
      const Point behind{p.x - sign * dx, p.y - sign * dy};
      if (!edges.contains(behind.x, behind.y) || labels(behind.x, behind.y) != labels(p.x, p.y)) continue;
      const int rise = edges(behind.x, behind.y) - std::max(edges(p.x, p.y), edges(ahead.x, ahead.y));
      if (rise > best.rise) best = {rise, labels(ahead.x, ahead.y)};
    }
  }
  return best;
}

/// Whether the region's pixels among the eight neighbours that are connected with one of the four nearest are all
/// connected with each other, without p.
bool can_leave(View<const RegionId> labels, Point p) {
  const auto is_member = [&](Point q) {
    return labels.contains(q.x, q.y) && labels(q.x, q.y) == labels(p.x, p.y) && !(q == p) &&
           std::abs(q.x - p.x) <= 1 && std::abs(q.y - p.y) <= 1;
  };
  std::vector<Point> seen;
  int pieces = 0;
  for (const auto& [dx, dy] : {std::pair{0, -1}, {1, 0}, {0, 1}, {-1, 0}}) {
    std::vector<Point> at{{p.x + dx, p.y + dy}};
    if (!is_member(at.front()) || std::find(seen.begin(), seen.end(), at.front()) != seen.end()) continue;
    ++pieces;
    while (!at.empty()) {
      const Point q = at.back();
      at.pop_back();
      if (!is_member(q) || std::find(seen.begin(), seen.end(), q) != seen.end()) continue;
      seen.push_back(q);
      for (const auto& [ex, ey] : {std::pair{0, -1}, {1, 0}, {0, 1}, {-1, 0}})
        at.push_back({q.x + ex, q.y + ey});
    }
  }
  return pieces == 1;
}

/// Twice the size, with outlines moved twice by at most one pixel.
Image<RegionId> refined(View<const RegionId> coarse, View<const std::uint16_t> edges) {
  Image<RegionId> labels(edges.size());
  for (int y = 0; y < edges.height(); ++y) {
    for (int x = 0; x < edges.width(); ++x) labels(x, y) = coarse(x / 2, y / 2);
  }
  for (int pass = 0; pass < 2; ++pass) {
    const Image<RegionId> before = labels.clone();
    for (int y = 0; y < edges.height(); ++y) {
      for (int x = 0; x < edges.width(); ++x) {
        if (move_of(before, edges, {x, y}).rise == 0) continue;
        const Move move = move_of(labels, edges, {x, y});
        if (move.rise > 0 && can_leave(labels, {x, y})) labels(x, y) = move.to;
      }
    }
  }
  return labels;
}

// ---- cues ----

bool is_in(const Members& members, View<const RegionId> labels, Point p) {
  return labels.contains(p.x, p.y) && members.contains(number(labels(p.x, p.y)));
}

std::optional<int> steps_of(float px) {
  if (std::isnan(px)) return std::nullopt;
  return static_cast<int>(std::floor(double{px} * 64 + 0.5));
}

/// Sums over one kind of disparity.
struct Depth {
  PlaneMoments plane;
  Heights above_ground;
  Heights before_background;
};

void count(Heights& heights, int height) {
  const int h = std::min(std::max(height, -8 * 64), 24 * 64);
  heights.n += 1;
  heights.sum += h;
  heights.squares += h * h;
  if (h < -64) heights.behind += 1;
  if (h >= -64 && h <= 64) heights.on += 1;
}

void count(Depth& depth, float px, Point p, Point centre, const Cues& cues) {
  const std::optional<int> d = steps_of(px);
  if (!d) return;
  const std::int64_t x = p.x - centre.x;
  const std::int64_t y = p.y - centre.y;
  const PlaneMoments one{1, x, y, x * x, x * y, y * y, *d, x * *d, y * *d, std::int64_t{*d} * *d};
  depth.plane.add(one);
  const auto fx = static_cast<float>(p.x);
  const auto fy = static_cast<float>(p.y);
  if (cues.ground.plane && cues.ground.plane->disparity_px(fx, fy) > 0)
    count(depth.above_ground, *d - steps_of(cues.ground.plane->disparity_px(fx, fy)).value());
  if (!cues.background.planes.empty())
    count(depth.before_background, *d - steps_of(cues.background.disparity_px(fx, fy)).value());
}

std::array<int, 3> colour_at(Point p, const Cues& cues) {
  if (cues.left.rgb.empty()) return {cues.left.gray(p.x, p.y), 0, 0};
  const Rgb c = cues.left.rgb(p.x, p.y);
  return {(c.r + 2 * c.g + c.b) / 4, c.b - c.g, c.r - c.g};
}

/// The hint cell of a pixel.
ObjectHint hint_at(Point p, const Cues& cues) {
  return cues.hints(p.x * cues.hints.width() / cues.left.gray.width(),
                    p.y * cues.hints.height() / cues.left.gray.height());
}

void count(HintSums& sums, Point p, const Cues& cues) {
  if (cues.hints.empty()) return;
  const ObjectHint hint = hint_at(p, cues);
  const Point middle{
      8 * (p.x * cues.hints.width() / cues.left.gray.width() - cues.hints.width() / 2) + hint.to_x,
      8 * (p.y * cues.hints.height() / cues.left.gray.height() - cues.hints.height() / 2) + hint.to_y};
  const std::int64_t votes = std::min(std::max(hint.object + 32, 0), 64);
  sums.object += hint.object;
  sums.outline += hint.outline;
  sums.weight += votes;
  sums.x += votes * middle.x;
  sums.y += votes * middle.y;
  sums.xx += votes * middle.x * middle.x;
  sums.yy += votes * middle.y * middle.y;
  sums.size += votes * hint.size;
}

/// The farthest pixel, at most three away, on a straight line from p inside its superpixel.
Point up_to_three_away(Point p, Point to, View<const RegionId> labels) {
  Point farthest = p;
  for (const int i : {1, 2, 3}) {
    const Point q{p.x + i * to.x, p.y + i * to.y};
    if (!labels.contains(q.x, q.y) || labels(q.x, q.y) != labels(p.x, p.y)) break;
    farthest = q;
  }
  return farthest;
}

// ---- the tree ----

/// One region of all superpixels with is_kind(superpixel).
template <class Kind>
RegionCues together(const Superpixels& superpixels, const Cues& cues, Kind is_kind) {
  Members members;
  for (std::int32_t i = 0; i < superpixels.count; ++i) {
    if (is_kind(cues_of({i}, superpixels, cues))) members.insert(i);
  }
  return cues_of(members, superpixels, cues);
}

double mean_disparity_px(const PlaneMoments& m) {
  return m.n == 0 ? 0 : static_cast<double>(m.d) / static_cast<double>(m.n) / 64;
}

FrameCues frame_cues(const Superpixels& superpixels, const Cues& cues) {
  const auto seen = together(superpixels, cues, [](const RegionCues&) { return true; });
  const auto floor =
      together(superpixels, cues, [](const RegionCues& r) { return 2 * r.above_ground.on > r.area; });
  const auto background = together(superpixels, cues, [](const RegionCues& r) {
    return 2 * (r.before_background.on + r.before_background.behind) > r.area;
  });
  double nearest_px = 1;
  for (std::int32_t i = 0; i < superpixels.count; ++i)
    nearest_px = std::max(nearest_px, mean_disparity_px(cues_of({i}, superpixels, cues).matched));
  const auto share = [&](const PlaneMoments& m) {
    return static_cast<float>(m.n) / static_cast<float>(seen.area);
  };
  return {.width = cues.left.gray.width(),
          .height = cues.left.gray.height(),
          .has_colour = !cues.left.rgb.empty(),
          .has_ground = cues.ground.plane.has_value(),
          .has_hints = !cues.hints.empty(),
          .cells_per_px = static_cast<double>(cues.hints.size().area()) /
                          static_cast<double>(cues.left.gray.size().area()),
          .cells_across = cues.hints.width(),
          .cells_down = cues.hints.height(),
          .walls_and_floor = static_cast<int>(cues.background.planes.size()),
          .noise_sigma = cues.left.noise_sigma,
          .matched_share = share(seen.matched),
          .evidence_share = share(seen.textured),
          .nearest_px = nearest_px,
          .floor = {floor.area, floor.histogram},
          .background = {background.area, background.histogram}};
}

/// Regions and their contacts, without any index for speed.
class RegionGrower {
 public:
  RegionGrower(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing)
      : superpixels_(superpixels),
        cues_(cues),
        same_thing_(same_thing),
        frame_(frame_cues(superpixels, cues)) {
    tree_.superpixels = superpixels.count;
    tree_.nodes.resize(slot(superpixels.count));
    for (std::int32_t i = 0; i < superpixels.count; ++i) regions_[i] = {{i}, {}, {}};
    for (auto& [node, region] : regions_) count_anew(region);
    for_each_pair(superpixels.labels.size(), [&](Point p, Point q) {
      const auto [a, b] =
          std::minmax({number(superpixels.labels(p.x, p.y)), number(superpixels.labels(q.x, q.y))});
      if (a != b && between(a, b) == contacts_.end()) contacts_.push_back({a, b, {}, 0, false});
    });
    for (Contact& contact : contacts_) judge(contact);
    for (std::int32_t i = 0; i < superpixels.count; ++i) describe(i, {20, 20, 1});
  }

  MergeTree run() {
    while (!contacts_.empty()) {
      auto likeliest = contacts_.begin();
      for (auto c = contacts_.begin(); c != contacts_.end(); ++c) {
        if (c->score > likeliest->score) likeliest = c;
      }
      if (likeliest->is_stale) {
        judge(*likeliest);
      } else {
        fuse(*likeliest);
      }
    }
    return std::move(tree_);
  }

 private:
  struct Known {
    Members members;
    RegionCues cues;
    RegionFits fits;
  };
  struct Contact {
    std::int32_t a;  // nodes
    std::int32_t b;
    ContactCues cues;
    float score;
    bool is_stale;  // one of the two has grown since
    [[nodiscard]] bool has(std::int32_t node) const { return a == node || b == node; }
  };

  std::vector<Contact>::iterator between(std::int32_t p, std::int32_t q) {
    return std::find_if(contacts_.begin(), contacts_.end(),
                        [&](const Contact& c) { return c.has(p) && c.has(q); });
  }
  [[nodiscard]] std::int64_t neighbours_of(std::int32_t node) const {
    return std::count_if(contacts_.begin(), contacts_.end(), [&](const Contact& c) { return c.has(node); });
  }

  void count_anew(Known& region) const {
    region.cues = cues_of(region.members, superpixels_, cues_);
    region.fits = fit_region(region.cues, frame_);
  }
  [[nodiscard]] RegionSide side(std::int32_t node) const {
    return {regions_.at(node).cues, regions_.at(node).fits};
  }
  void judge(Contact& c) const {
    c.cues = contact_of(regions_.at(c.a).members, regions_.at(c.b).members, superpixels_, cues_);
    c.score = same_thing_(merge_features(side(c.a), side(c.b), c.cues, frame_));
    c.is_stale = false;
  }

  void describe(std::int32_t node, const Origin& origin) {
    std::vector<Neighbour> neighbours;
    for (const Contact& c : contacts_) {
      if (c.has(node)) neighbours.push_back({side(c.a == node ? c.b : c.a), c.cues, c.b == node, c.score});
    }
    MergeNode& described = tree_.nodes[slot(node)];
    described.area = regions_.at(node).cues.area;
    described.origin = origin;
    described.features = object_features(side(node), neighbours, origin, frame_);
  }

  void fuse(const Contact& across) {
    const float score = across.score;
    const bool a_stays = neighbours_of(across.a) >= neighbours_of(across.b);
    const std::int32_t stays = a_stays ? across.a : across.b;
    const std::int32_t goes = a_stays ? across.b : across.a;
    contacts_.erase(between(stays, goes));
    const auto node = static_cast<std::int32_t>(tree_.nodes.size());
    tree_.nodes.push_back({.part_a = stays, .part_b = goes});

    Known whole{regions_.at(stays).members, {}, {}};
    whole.members.insert(regions_.at(goes).members.begin(), regions_.at(goes).members.end());
    count_anew(whole);
    const auto area = static_cast<float>(whole.cues.area);
    Origin origin{score, score, 0};
    for (const std::int32_t part : {stays, goes}) {
      MergeNode& of = tree_.nodes[slot(part)];
      of.whole = node;
      const float share = static_cast<float>(of.area) / area;
      report_end(of.features, share, score);
      origin.larger_part = std::max(origin.larger_part, share);
      origin.least_same_thing = std::min(origin.least_same_thing, of.origin.least_same_thing);
    }
    const auto [small, large] = std::minmax(tree_.nodes[slot(stays)].area, tree_.nodes[slot(goes)].area);
    const bool judge_all = small * 8 > large;

    std::vector<Contact> kept;
    std::set<std::int32_t> changed;  // neighbours to judge again
    for (const Contact& c : contacts_) {
      if (c.has(goes)) changed.insert(c.a == goes ? c.b : c.a);
    }
    for (const Contact& c : contacts_) {
      // Of two contacts with a common neighbour, the one seen first remains, in the orientation of its own
      // region.
      const std::int32_t other = c.a == stays || c.a == goes ? c.b : c.a;
      const bool is_ours = c.has(stays) || c.has(goes);
      const auto twin = is_ours ? between(other, c.has(stays) ? goes : stays) : contacts_.end();
      const bool is_second = is_ours && std::any_of(kept.begin(), kept.end(), [&](const Contact& k) {
                               return k.has(node) && k.has(other);
                             });
      if (is_second) continue;
      Contact result = is_ours && c.has(goes) && twin != contacts_.end() ? *twin : c;
      if (result.a == stays || result.a == goes) result.a = node;
      if (result.b == stays || result.b == goes) result.b = node;
      if (is_ours) result.is_stale = true;
      kept.push_back(result);
    }
    contacts_ = std::move(kept);
    regions_.erase(stays);
    regions_.erase(goes);
    regions_[node] = std::move(whole);
    for (Contact& c : contacts_) {
      if (c.has(node) && (judge_all || changed.contains(c.a == node ? c.b : c.a))) judge(c);
    }
    describe(node, origin);
  }

  const Superpixels& superpixels_;
  const Cues& cues_;
  const FittedTrees& same_thing_;
  FrameCues frame_;
  std::map<std::int32_t, Known> regions_;  // by node
  std::vector<Contact> contacts_;          // in order of first occurrence in raster order
  MergeTree tree_;
};

}  // namespace

Superpixels cut_superpixels(View<const Gray> gray, View<const Rgb> rgb, View<const ObjectHint> hints,
                            View<const float> disparity_px, float noise_sigma, int count) {
  Superpixels result;
  result.edges = reference::edge_strength(gray, rgb, 0.7F);
  std::vector<Image<std::uint16_t>> levels;
  const Image<std::uint16_t> stronger = with_outlines(result.edges, hints);
  levels.push_back(with_depth(stronger, disparity_px, noise_sigma));
  while (levels.back().size().area() >= 1600 * std::int64_t{count}) levels.push_back(half_of(levels.back()));
  const Image<std::uint16_t>& edges = levels.back();
  Basins basins = reference::watershed(edges);
  join_small_basins(basins, edges, edges.size().area() / count / 40);
  for (; basins.count > count; --basins.count) {
    const auto two = next_two(basins.labels, edges);
    if (!two) break;
    rename(basins.labels, RegionId{two->second}, RegionId{two->first});
  }
  number_in_raster_order(basins.labels);
  result.count = basins.count;
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    basins.labels = refined(basins.labels, levels[level]);
  result.labels = std::move(basins.labels);
  return result;
}

RegionCues cues_of(const Members& members, const Superpixels& superpixels, const Cues& cues) {
  const Size size = superpixels.labels.size();
  const Point centre{size.width / 2, size.height / 2};
  RegionCues region;
  Depth matched;
  Depth textured;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Point p{x, y};
      if (!is_in(members, superpixels.labels, p)) continue;
      const std::int64_t u = x - centre.x;
      const std::int64_t v = y - centre.y;
      region.area += 1;
      region.x += u;
      region.y += v;
      region.xx += u * u;
      region.xy += u * v;
      region.yy += v * v;
      region.left = std::min(region.left, x);
      region.right = std::max(region.right, x);
      region.top = std::min(region.top, y);
      region.bottom = std::max(region.bottom, y);
      const std::array at_border{x == 0, x + 1 == size.width, y == 0, y + 1 == size.height};
      const std::array<int, 3> colour = colour_at(p, cues);
      for (std::size_t i = 0; i < 4; ++i) region.at_image_border.at(i) += at_border.at(i) ? 1 : 0;
      for (std::size_t i = 0; i < 3; ++i) {
        region.colour.at(i) += colour.at(i);
        region.colour_squares.at(i) += colour.at(i) * colour.at(i);
        const double steps = i == 0 ? colour.at(i) / 16.0 : (colour.at(i) + 96) / 12.0;
        const auto bin = static_cast<std::size_t>(std::clamp(std::floor(steps), 0.0, 15.0));
        region.histogram.at(i * 16 + bin) += 1;
      }
      region.texture += superpixels.edges(x, y);
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const bool ends = superpixels.labels.view().contains(x + dx, y + dy) &&
                          !is_in(members, superpixels.labels, {x + dx, y + dy});
        region.perimeter += ends ? 1 : 0;
      }
      count(region.hints, p, cues);
      count(matched, cues.disparity_px(x, y), p, centre, cues);
      count(textured, cues.textured_px(x, y), p, centre, cues);
    }
  }
  region.matched = matched.plane;
  region.above_ground = matched.above_ground;
  region.before_background = matched.before_background;
  region.textured = textured.plane;
  region.textured_above_ground = textured.above_ground;
  region.textured_before_background = textured.before_background;
  return region;
}

ContactCues contact_of(const Members& a, const Members& b, const Superpixels& superpixels, const Cues& cues) {
  const View<const RegionId> labels = superpixels.labels;
  const Point centre{labels.width() / 2, labels.height() / 2};
  ContactCues contact;
  for_each_pair(labels.size(), [&](Point p, Point q) {
    if (is_in(b, labels, p) && is_in(a, labels, q)) std::swap(p, q);
    if (!is_in(a, labels, p) || !is_in(b, labels, q)) return;
    const int edge = std::max(superpixels.edges(p.x, p.y), superpixels.edges(q.x, q.y));
    contact.length += 1;
    contact.edge_sum += edge;
    if (!cues.hints.empty()) contact.outline += std::max(hint_at(p, cues).outline, hint_at(q, cues).outline);
    if (static_cast<float>(edge) < 4 * (1.5F + 0.8F * cues.left.noise_sigma)) contact.weak += 1;
    contact.x2 += p.x + q.x - 2 * centre.x;
    contact.y2 += p.y + q.y - 2 * centre.y;
    const auto disparity = [&](Point at) { return steps_of(cues.disparity_px(at.x, at.y)); };
    if (disparity(p) && disparity(q)) {
      const int step = *disparity(p) - *disparity(q);
      contact.near_n += 1;
      contact.near_sum += step;
      contact.near_abs += std::abs(step);
    }
    const Point far_p = up_to_three_away(p, {p.x - q.x, p.y - q.y}, labels);
    const Point far_q = up_to_three_away(q, {q.x - p.x, q.y - p.y}, labels);
    if (disparity(far_p) && disparity(far_q)) {
      const int step = *disparity(far_p) - *disparity(far_q);
      contact.far_n += 1;
      contact.far_sum += step;
      contact.far_abs += std::abs(step);
      (step > 64 ? contact.nearer : step < -64 ? contact.farther : contact.level) += 1;
    }
  });
  return contact;
}

MergeTree grow_merge_tree(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing) {
  return RegionGrower(superpixels, cues, same_thing).run();
}

ChosenObjects choose_objects(const MergeTree& tree, const FittedTrees& whole_object,
                             const ChoiceLimits& limits) {
  const std::size_t count = tree.nodes.size();
  std::vector<float> scores;
  for (const MergeNode& node : tree.nodes) {
    const double likelihood = 1 / (1 + std::exp(-double{whole_object(node.features)}));
    scores.push_back(static_cast<float>(std::floor(likelihood * 4096 + 0.5) / 4096));
  }
  const auto lies_in = [&](std::size_t node, std::size_t other) {
    auto at = static_cast<std::int32_t>(node);
    while (at >= 0 && slot(at) != other) at = tree.nodes[slot(at)].whole;
    return at >= 0;
  };
  // Each set of disjoint nodes; of sets with equal gain, the one with fewer and then later nodes.
  std::vector<std::size_t> best;
  auto best_rank = std::tuple(0.0, 0, 0);
  for (std::uint32_t set = 0; set < 1U << count; ++set) {
    std::vector<std::size_t> nodes;
    for (std::size_t i = count; i-- > 0;) {
      if ((set >> i & 1U) != 0) nodes.push_back(i);
    }
    bool allowed = true;
    double gain = 0;
    int numbers = 0;
    for (const std::size_t i : nodes) {
      gain += double{scores[i]} - limits.min_score;
      numbers += static_cast<int>(i);
      allowed = allowed && scores[i] > limits.min_score && tree.nodes[i].area >= limits.min_area;
      for (const std::size_t j : nodes) allowed = allowed && (i == j || !lies_in(i, j));
    }
    const auto rank = std::tuple(gain, -static_cast<int>(nodes.size()), numbers);
    if (!allowed || rank <= best_rank) continue;
    best = nodes;
    best_rank = rank;
  }
  ChosenObjects chosen{std::vector<std::int32_t>(slot(tree.superpixels), 0),
                       {0.0F},
                       std::vector<float>(slot(tree.superpixels), 0.0F)};
  for (std::size_t s = 0; s < chosen.likeliest.size(); ++s) {
    for (std::size_t i = 0; i < count; ++i) {
      if (lies_in(s, i) && tree.nodes[i].area >= limits.min_area)
        chosen.likeliest[s] = std::max(chosen.likeliest[s], scores[i]);
    }
  }
  for (const std::size_t i : best) {
    for (std::size_t s = 0; s < chosen.object_of.size(); ++s) {
      if (lies_in(s, i)) chosen.object_of[s] = static_cast<std::int32_t>(chosen.scores.size());
    }
    chosen.scores.push_back(scores[i]);
  }
  return chosen;
}

}  // namespace cairn::reference
