// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/disparity/evidence.hpp>
#include <cairn/objects/figure.hpp>
#include <cairn/regions/minimum_cut.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <utility>

namespace cairn {
namespace {

// Votes in twentieths of a pixel of evidence: what is seen counts double what is concluded, and a conclusion
// over too long a stretch next to nothing. In doubt, ground.
constexpr int kSeen = 20;
constexpr int kConcluded = 10;
constexpr int kCutOff = 5;
constexpr int kTooLong = 1;
constexpr int kInDoubt = 1;

constexpr int kRounds = 3;
constexpr double kUnit = 320;  // costs are whole numbers, of 1/320 pixel of evidence

// An edge of this strength weighs 1/e: once and a half what makes facets fuse.
constexpr double kEdge = 3.0;        // grey levels …
constexpr double kEdgeNoise = 4.5;   // … plus deviations of the image noise
constexpr double kSeenShare = 0.25;  // of a facet's pixels: above it the facet is figure by what is seen

struct Votes {
  std::vector<std::int64_t> figure, ground, seen_figure;  // the last is part of the first
  explicit Votes(int facets) : figure(slot(facets)), ground(figure.size()), seen_figure(figure.size()) {}
};

struct Scales {
  float margin_px;
  float agreement_px;
  int longest_bridge_px;
  int seen_at_border;  // votes
};

/// One pixel of a row that has evidence.
struct Seen {
  int x;
  float disparity_px;
  float before_background_px;
};

void vote(const RegionId* facet, int first, int last, bool figure, int weight, Votes& votes) {
  auto& side = figure ? votes.figure : votes.ground;
  for (int x = first; x < last; ++x) side[index(facet[x])] += weight;
}

void vote_between(const RegionId* facet, const Seen& left, const Seen& right, const Scales& scales,
                  Votes& votes) {
  const bool figure =
      left.before_background_px > scales.margin_px && right.before_background_px > scales.margin_px;
  int weight = kConcluded;
  if (figure && std::abs(left.disparity_px - right.disparity_px) > scales.agreement_px) weight = 0;
  if (figure && weight > 0 && right.x - left.x > scales.longest_bridge_px) weight = kTooLong;
  vote(facet, left.x + 1, right.x, figure, weight, votes);
}

void vote_to_border(const RegionId* facet, int first, int last, const Seen* end, const Scales& scales,
                    Votes& votes) {
  const bool sure = end != nullptr && !(end->before_background_px > scales.margin_px);
  vote(facet, first, last, false, sure ? kConcluded : kCutOff, votes);
}

void vote_in_row(View<const RegionId> facets, int y, const std::vector<Seen>& seen, const Scales& scales,
                 Votes& votes) {
  const RegionId* const facet = facets.row(y);
  const int width = facets.width();
  if (seen.empty()) {
    vote_to_border(facet, 0, width, nullptr, scales, votes);
    return;
  }
  vote_to_border(facet, 0, seen.front().x, &seen.front(), scales, votes);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool figure = seen[i].before_background_px > scales.margin_px;
    // The matcher gives the nearer surface's disparity to both sides of its edge, so what is seen before the
    // background next to a border may be the neighbour's.
    const int weight = figure && beside_border(facets, seen[i].x, y) ? scales.seen_at_border : kSeen;
    vote(facet, seen[i].x, seen[i].x + 1, figure, weight, votes);
    if (figure) votes.seen_figure[index(facet[seen[i].x])] += weight;
    if (i + 1 < seen.size()) vote_between(facet, seen[i], seen[i + 1], scales, votes);
  }
  vote_to_border(facet, seen.back().x + 1, width, &seen.back(), scales, votes);
}

using Colour = std::array<double, 3>;

/// Mean square difference of the channels.
double difference(const Colour& p, const Colour& q) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (p[c] - q[c]) * (p[c] - q[c]);
  return sum / 3;
}

/// A facet as the colour models see it.
struct Look {
  Colour colour{};  // mean; its grey three times where there is no colour
  Rect box;
  double pixels = 0;
  bool seen = false;  // to be figure
};

std::vector<Look> looks_of(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                           const Votes& votes) {
  std::vector<Look> looks(slot(facets.count));
  for_each_run(facets.labels, [&](const Run& run) {
    const std::array<int, 3> sum = colour_sum(gray, rgb, run);
    Look& look = looks[index(run.label)];
    for (std::size_t c = 0; c < 3; ++c) look.colour[c] += sum[c];
    look.box = united(look.box, run.box());
    look.pixels += run.length();
  });
  for (std::size_t i = 0; i < looks.size(); ++i) {
    for (double& channel : looks[i].colour) channel /= looks[i].pixels;
    looks[i].seen = static_cast<double>(votes.seen_figure[i]) > kSeenShare * kSeen * looks[i].pixels;
  }
  return looks;
}

/// What each facet counts in the models of ground and of figure, in pixels. Figure counts where it is seen to
/// be. Ground counts unless it touches figure and is no larger than a part of an object: a part that has the
/// colour of the rest of its object, but no evidence, would speak for the ground that it was taken for.
std::vector<double> counted(const std::vector<Look>& looks, const std::vector<std::int32_t>& figure,
                            const std::vector<bool>& asked, double largest_part) {
  std::vector<double> pixels(looks.size());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const double as_ground = std::max(looks[i].pixels - (asked[i] ? largest_part : 0), 0.0);
    const double as_figure = looks[i].seen ? looks[i].pixels : 0;
    pixels[i] = figure[i] != 0 ? as_figure : as_ground;
  }
  return pixels;
}

/// How common colours are in the ground and in the figure. Colours are gathered in cells of the colour cube,
/// each with its own mean.
class ColourModel {
 public:
  ColourModel(const std::vector<Look>& looks, const std::vector<std::int32_t>& figure,
              const std::vector<double>& counted) {
    std::map<int, Cell> cells;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (!(counted[i] > 0)) continue;
      int key = 0;
      for (const double channel : looks[i].colour) key = 16 * key + static_cast<int>(channel / 16);
      Cell& cell = cells[key];
      const double before = cell.pixels[0] + cell.pixels[1];
      for (std::size_t c = 0; c < 3; ++c) {
        cell.mean[c] += (looks[i].colour[c] - cell.mean[c]) * counted[i] / (before + counted[i]);
      }
      cell.pixels.at(figure[i] != 0 ? 1 : 0) += counted[i];
      total_.at(figure[i] != 0 ? 1 : 0) += counted[i];
    }
    for (const auto& [key, cell] : cells) cells_.push_back(cell);
  }

  /// Logarithm of how many times as common a colour is in the ground as in the figure, −kMost … kMost.
  [[nodiscard]] double ground_over_figure(const Colour& colour) const {
    std::array<double, 2> near{};
    for (const Cell& cell : cells_) {
      const double like = std::exp(-difference(colour, cell.mean) / (2 * kSpread * kSpread));
      for (std::size_t side = 0; side < 2; ++side) near.at(side) += like * cell.pixels.at(side);
    }
    const auto share = [&](std::size_t side) {
      return near.at(side) / std::max(total_.at(side), 1.0) + kUnknown;
    };
    return std::clamp(std::log(share(0) / share(1)), -kMost, kMost);
  }

 private:
  static constexpr double kSpread = 12;       // grey levels
  static constexpr double kUnknown = 0.0003;  // colours that nothing has are nobody's
  static constexpr double kMost = 3;
  struct Cell {
    Colour mean{};
    std::array<double, 2> pixels{};  // of ground, of figure
  };
  std::vector<Cell> cells_;
  std::array<double, 2> total_{};
};

/// Whether ground goes on beside a facet in the facet's colour.
class Continuation {
 public:
  Continuation(const std::vector<Look>& looks, int width)
      : looks_(looks),
        across_(kAcross * width),
        down_(kDown * width),
        pairs_of_(looks.size()),
        most_across_(farthest(across_)),
        most_down_(farthest(down_)) {
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (looks[i].box.height > most_down_) tall_.push_back(i);
      in_order_ = in_order_ && (i == 0 || looks[i - 1].box.y <= looks[i].box.y);
    }
  }

  /// 0 … 1: how much ground of its colour lies beside facet i, more than there is seen figure of that colour,
  /// compared with its own size.
  double operator()(std::size_t i, const std::vector<std::int32_t>& figure,
                    const std::vector<double>& counted) {
    std::array<double, 2> near{};
    for (const Pair& pair : pairs_of(i)) {
      near.at(figure[pair.other] != 0 ? 1 : 0) += pair.likeness * counted[pair.other];
    }
    const double pixels = looks_[i].pixels;
    return std::max(std::min(near[0] / pixels, 1.0) - std::min(near[1] / pixels, 1.0), 0.0);
  }

 private:
  static constexpr double kSpread = 6;     // grey levels
  static constexpr double kAcross = 0.15;  // of the width
  static constexpr double kDown = 0.03;    // of the width: floor and wall change fast along a column
  static constexpr double kFarthest = 9;   // squared deviations

  struct Pair {
    std::size_t other;
    double likeness;  // 0 … 1
  };

  static double squared(double value) { return value * value; }

  /// The most pixels that are within kFarthest for this deviation.
  static int farthest(double deviation) {
    int pixels = 0;
    while (squared((pixels + 1) / deviation) <= kFarthest) ++pixels;
    return pixels;
  }

  /// The facets that i resembles and is near to, in their order. The same in every round, so found once.
  const std::vector<Pair>& pairs_of(std::size_t i) {
    std::optional<std::vector<Pair>>& pairs = pairs_of_[i];
    if (pairs) return *pairs;
    pairs.emplace();
    const Rect& box = looks_[i].box;
    // Facets come in the order of their first row. Those that end far above are passed over, and among those
    // that begin far above only tall ones reach down.
    const auto first = in_order_ ? first_from(box.y - 2 * most_down_) : looks_.begin();
    const auto last = in_order_ ? first_from(box.y + box.height + most_down_ + 1) : looks_.end();
    const auto begin = static_cast<std::size_t>(first - looks_.begin());
    for (const std::size_t j : tall_) {
      if (j >= begin) break;
      consider(i, j, *pairs);
    }
    for (auto j = begin; j < static_cast<std::size_t>(last - looks_.begin()); ++j) consider(i, j, *pairs);
    return *pairs;
  }

  [[nodiscard]] std::vector<Look>::const_iterator first_from(int row) const {
    return std::partition_point(looks_.begin(), looks_.end(),
                                [row](const Look& look) { return look.box.y < row; });
  }

  void consider(std::size_t i, std::size_t j, std::vector<Pair>& pairs) const {
    const Look& here = looks_[i];
    const Look& there = looks_[j];
    const Size between = gap_between(here.box, there.box);
    if (between.height > most_down_ || between.width > most_across_ || i == j) return;
    const double dc = difference(here.colour, there.colour) / (kSpread * kSpread);
    if (dc > kFarthest) return;
    const double dx = between.width / across_;
    const double dy = between.height / down_;
    pairs.push_back({j, std::exp(-(dc + dx * dx + dy * dy) / 2)});
  }

  const std::vector<Look>& looks_;
  double across_;  // px
  double down_;    // px
  std::vector<std::optional<std::vector<Pair>>> pairs_of_;
  int most_across_;
  int most_down_;
  std::vector<std::size_t> tall_;
  bool in_order_ = true;
};

std::vector<Tie> ties_of(const std::vector<Border>& borders, double smoothness, double noise) {
  const double edge = 4 * (kEdge + kEdgeNoise * noise);  // borders measure in quarters
  std::vector<Tie> ties(borders.size());
  std::transform(borders.begin(), borders.end(), ties.begin(), [&](const Border& border) {
    const double cost =
        smoothness * static_cast<double>(border.length) * std::exp(-border.mean_edge() / edge);
    return Tie{border.a, border.b, std::llround(kUnit * cost)};
  });
  return ties;
}

/// Facets along the foot of a wall that hardly show evidence of figure.
std::vector<bool> skirting(const Facets& facets, const Background& background, const Votes& votes,
                           const std::vector<Look>& looks, float above_percent) {
  constexpr float kBelow = 0.2F;        // of what is above
  constexpr double kShare = 0.8;        // of a facet's pixels
  constexpr double kHardlySeen = 0.05;  // of its pixels
  std::vector<bool> result(looks.size());
  if (!background.has_floor || background.planes.size() < 2 || above_percent <= 0) return result;
  const View<const RegionId> labels = facets.labels;
  const float above = 0.01F * above_percent * static_cast<float>(labels.width());
  std::vector<std::int64_t> within(result.size());
  for (int x = 0; x < labels.width(); ++x) {
    int foot = 0;  // the first row where the floor is nearer than the walls
    const auto at_floor = [&](int y) {
      const auto u = static_cast<float>(x);
      const auto v = static_cast<float>(y);
      return background.planes.front().disparity_px(u, v) >= background.disparity_px(u, v);
    };
    while (foot < labels.height() && !at_floor(foot)) ++foot;
    const bool below_a_wall =
        foot > 0 && foot < labels.height() &&
        background.disparity_px(static_cast<float>(x), static_cast<float>(foot - 1)) > 0;
    if (!below_a_wall) continue;
    const int first = std::max(static_cast<int>(std::ceil(static_cast<float>(foot) - above)), 0);
    const int last = static_cast<int>(std::ceil(static_cast<float>(foot) + kBelow * above));
    for (int y = first; y < std::min(last, labels.height()); ++y) ++within[index(labels(x, y))];
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = static_cast<double>(within[i]) > kShare * looks[i].pixels &&
                static_cast<double>(votes.seen_figure[i]) <= kHardlySeen * kSeen * looks[i].pixels;
  }
  return result;
}

/// Figure, and what touches it: there colour is asked.
std::vector<bool> around(const std::vector<std::int32_t>& figure, const std::vector<Border>& borders) {
  std::vector<bool> near(figure.size());
  for (std::size_t i = 0; i < figure.size(); ++i) near[i] = figure[i] != 0;
  for (const Border& border : borders) {
    if (figure[slot(border.a)] != 0) near[slot(border.b)] = true;
    if (figure[slot(border.b)] != 0) near[slot(border.a)] = true;
  }
  return near;
}

Votes votes_of(const Facets& facets, View<const float> evidence_px, const Background& background,
               const FigureConfig& config) {
  const Size size = facets.labels.size();
  const auto per_mille = 0.001F * static_cast<float>(size.width);
  const Scales scales{config.margin * per_mille, config.agreement * per_mille,
                      static_cast<int>(0.01F * config.longest_bridge * static_cast<float>(size.width)),
                      static_cast<int>(std::lround(static_cast<float>(kSeen) * config.border_weight))};
  Votes votes(facets.count);
  std::vector<Seen> seen;
  for (int y = 0; y < size.height; ++y) {
    seen.clear();
    for (int x = 0; x < size.width; ++x) {
      const float d = evidence_px(x, y);
      if (std::isnan(d)) continue;
      seen.push_back({x, d, d - background.disparity_px(static_cast<float>(x), static_cast<float>(y))});
    }
    vote_in_row(facets.labels, y, seen, scales, votes);
  }
  return votes;
}

}  // namespace

std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          const FigureConfig& config, const Exec&) {
  const Votes votes = votes_of(facets, evidence_px, background, config);
  const std::vector<Look> looks = looks_of(facets, gray, rgb, votes);
  const std::vector<Tie> ties = ties_of(facets.borders, config.smoothness, noise_sigma(gray));
  const std::vector<bool> at_foot = skirting(facets, background, votes, looks, config.skirting);
  constexpr auto kVote = static_cast<std::int64_t>(kUnit) / kSeen;
  std::vector<std::int64_t> ground_costs(looks.size());
  std::vector<std::int64_t> figure_costs(looks.size());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    ground_costs[i] = kVote * (at_foot[i] ? votes.seen_figure[i] : votes.figure[i]);
    figure_costs[i] = kVote * (votes.ground[i] + kInDoubt * static_cast<std::int64_t>(looks[i].pixels));
  }
  std::vector<std::int32_t> figure = minimum_cut(ground_costs, figure_costs, ties);
  // Where no floor is known, what mirrors an object would pass for a part of it.
  const double largest_part =
      background.has_floor ? static_cast<double>(pixels_in(config.largest_part, gray.size())) : 0;
  Continuation goes_on(looks, gray.width());
  for (int round = 1; round < kRounds; ++round) {
    std::vector<std::int64_t> with_colour_ground = ground_costs;
    std::vector<std::int64_t> with_colour_figure = figure_costs;
    const std::vector<bool> asked = around(figure, facets.borders);
    const std::vector<double> pixels = counted(looks, figure, asked, largest_part);
    const ColourModel model(looks, figure, pixels);
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (!asked[i] || looks[i].seen) continue;
      const double colour = config.colour_weight * model.ground_over_figure(looks[i].colour);
      const double on = config.continuation_weight * goes_on(i, figure, pixels);
      if (!at_foot[i])
        with_colour_ground[i] += std::llround(kUnit * looks[i].pixels * std::max(-colour, 0.0));
      with_colour_figure[i] += std::llround(kUnit * looks[i].pixels * (std::max(colour, 0.0) + on));
    }
    figure = minimum_cut(with_colour_ground, with_colour_figure, ties);
  }
  return figure;
}

}  // namespace cairn
