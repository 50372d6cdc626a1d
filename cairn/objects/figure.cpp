// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/evidence.hpp>
#include <cairn/objects/colour_model.hpp>
#include <cairn/objects/figure.hpp>
#include <cairn/objects/like_facets.hpp>
#include <cairn/regions/minimum_cut.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
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
constexpr int kGrain = 64;     // facets
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

/// Those of `pixels` that count on one side.
std::vector<double> on_side(const std::vector<double>& pixels, const std::vector<std::int32_t>& figure,
                            bool of_figure) {
  std::vector<double> counted(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if ((figure[i] != 0) == of_figure) counted[i] = pixels[i];
  }
  return counted;
}

/// Whether ground goes on beside a facet in the facet's colour.
class Continuation {
 public:
  Continuation(const std::vector<Look>& looks, const std::vector<double>& counted,
               const std::vector<std::int32_t>& figure, const Likeness& likeness, const Exec& exec)
      : looks_(looks),
        ground_(looks, on_side(counted, figure, false), likeness, exec),
        figure_(looks, on_side(counted, figure, true), likeness, exec) {}

  struct Work {
    explicit Work(const Continuation& of) : ground(of.ground_), figure(of.figure_) {}
    LikeFacets::Work ground;
    LikeFacets::Work figure;
  };

  /// 0 … 1: how much ground of its colour lies beside facet i, more than there is seen figure of that colour,
  /// compared with its own size.
  double operator()(std::size_t i, Work& work) const {
    const double pixels = looks_[i].pixels;
    const double near_figure = figure_.pixels_like(i, pixels, work.figure);
    if (near_figure >= pixels) return 0;
    const double near_ground = ground_.pixels_like(i, pixels, work.ground);
    return std::max(std::min(near_ground / pixels, 1.0) - near_figure / pixels, 0.0);
  }

 private:
  const std::vector<Look>& looks_;
  LikeFacets ground_;
  LikeFacets figure_;
};

/// What a facet's colour, and ground that goes on beside it, cost.
struct ColourCosts {
  std::int64_t ground = 0;
  std::int64_t figure = 0;
  friend bool operator==(const ColourCosts&, const ColourCosts&) = default;
};
ColourCosts costs_of(double pixels, double ground_over_figure, double goes_on, const FigureConfig& config) {
  const double colour = config.colour_weight * ground_over_figure;
  const double on = config.continuation_weight * goes_on;
  return {std::llround(kUnit * pixels * std::max(-colour, 0.0)),
          std::llround(kUnit * pixels * (std::max(colour, 0.0) + on))};
}

/// Costs are whole numbers: nearly always rough bounds of the logarithm come to the same.
ColourCosts colour_costs(const Look& look, const ColourModel& model, double goes_on,
                         const FigureConfig& config, std::vector<double>& work) {
  const ColourModel::Bounds about = model.rough_ground_over_figure(look.colour);
  const ColourCosts low = costs_of(look.pixels, about.low, goes_on, config);
  if (low == costs_of(look.pixels, about.high, goes_on, config)) return low;
  return costs_of(look.pixels, model.ground_over_figure(look.colour, work), goes_on, config);
}

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
                                          const FigureConfig& config, const Exec& exec) {
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
  const Likeness likeness(gray.width());
  for (int round = 1; round < kRounds; ++round) {
    std::vector<std::int64_t> with_colour_ground = ground_costs;
    std::vector<std::int64_t> with_colour_figure = figure_costs;
    const std::vector<bool> asked = around(figure, facets.borders);
    const std::vector<double> pixels = counted(looks, figure, asked, largest_part);
    const ColourModel model(looks, figure, pixels, exec);
    const Continuation goes_on(looks, pixels, figure, likeness, exec);
    parallel_for(exec, facets.count, kGrain, [&](int first, int last) {
      Continuation::Work near(goes_on);
      std::vector<double> work;
      for (auto i = slot(first); i < slot(last); ++i) {
        if (!asked[i] || looks[i].seen) continue;
        const ColourCosts costs = colour_costs(looks[i], model, goes_on(i, near), config, work);
        if (!at_foot[i]) with_colour_ground[i] += costs.ground;
        with_colour_figure[i] += costs.figure;
      }
    });
    figure = minimum_cut(with_colour_ground, with_colour_figure, ties);
  }
  return figure;
}

}  // namespace cairn
