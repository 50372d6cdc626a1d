// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/objects/figure.hpp>
#include <cmath>
#include <cstdlib>

namespace cairn {
namespace {

// Votes in tenths: what is seen counts double what is concluded, and a conclusion over too long a stretch
// next to nothing.
constexpr int kSeen = 20;
constexpr int kConcluded = 10;
constexpr int kCutOff = 5;
constexpr int kTooLong = 1;

struct Votes {
  std::vector<std::int64_t> figure, ground, pixels, seen_figure;
  explicit Votes(int facets)
      : figure(static_cast<std::size_t>(facets)),
        ground(figure.size()),
        pixels(figure.size()),
        seen_figure(figure.size()) {}
};

struct Scales {
  float margin_px;
  float agreement_px;
  int longest_bridge_px;
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

void vote_in_row(const RegionId* facet, int width, const std::vector<Seen>& seen, const Scales& scales,
                 Votes& votes) {
  if (seen.empty()) {
    vote_to_border(facet, 0, width, nullptr, scales, votes);
    return;
  }
  vote_to_border(facet, 0, seen.front().x, &seen.front(), scales, votes);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const bool figure = seen[i].before_background_px > scales.margin_px;
    vote(facet, seen[i].x, seen[i].x + 1, figure, kSeen, votes);
    votes.seen_figure[index(facet[seen[i].x])] += figure ? 1 : 0;
    if (i + 1 < seen.size()) vote_between(facet, seen[i], seen[i + 1], scales, votes);
  }
  vote_to_border(facet, seen.back().x + 1, width, &seen.back(), scales, votes);
}

/// The mean colour of a facet; its grey three times where there is no colour. Sums of large facets need a
/// double.
struct Colour {
  double r = 0, g = 0, b = 0;
  [[nodiscard]] bool like(const Colour& o, float reach) const {
    return std::abs(r - o.r) <= reach && std::abs(g - o.g) <= reach && std::abs(b - o.b) <= reach;
  }
};

std::vector<Colour> mean_colours(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                 const std::vector<std::int64_t>& pixels) {
  std::vector<Colour> colours(pixels.size());
  for (int y = 0; y < gray.height(); ++y) {
    for (int x = 0; x < gray.width(); ++x) {
      Colour& sum = colours[index(facets.labels(x, y))];
      const Rgb colour = rgb.empty() ? Rgb{gray(x, y), gray(x, y), gray(x, y)} : rgb(x, y);
      sum.r += colour.r;
      sum.g += colour.g;
      sum.b += colour.b;
    }
  }
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const auto count = static_cast<double>(pixels[i]);
    colours[i] = {colours[i].r / count, colours[i].g / count, colours[i].b / count};
  }
  return colours;
}

constexpr double kSeenShare = 0.15;  // of a facet's pixels: above it the facet is figure by what is seen
constexpr double kCommonShare =
    0.02;  // of the ground's pixels: a colour that makes up so much of it is the ground's
constexpr double kRatherGround = 3.0;  // times more common in the ground than in the seen figure

/// Turns bridges between objects that have the ground's colour into ground.
void open_gaps(std::vector<std::int32_t>& labels, const Votes& votes, const std::vector<Colour>& colours,
               float reach) {
  const auto is_seen = [&](std::size_t i) {
    return static_cast<double>(votes.seen_figure[i]) > kSeenShare * static_cast<double>(votes.pixels[i]);
  };
  double ground = 0;
  double figure = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == 0) ground += static_cast<double>(votes.pixels[i]);
    if (labels[i] == 1 && is_seen(i)) figure += static_cast<double>(votes.pixels[i]);
  }
  std::vector<std::size_t> gaps;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] != 1 || is_seen(i)) continue;
    double in_ground = 0;
    double in_figure = 0;
    for (std::size_t j = 0; j < labels.size(); ++j) {
      if (labels[j] < 0 || j == i || !colours[i].like(colours[j], reach)) continue;
      if (labels[j] == 0) in_ground += static_cast<double>(votes.pixels[j]);
      if (labels[j] == 1 && is_seen(j)) in_figure += static_cast<double>(votes.pixels[j]);
    }
    const double common = in_ground / std::max(ground, 1.0);
    if (common > kCommonShare && common > kRatherGround * in_figure / std::max(figure, 1.0))
      gaps.push_back(i);
  }
  for (const std::size_t i : gaps) labels[i] = 0;
}

}  // namespace

std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          const FigureConfig& config, const Exec&) {
  const Size size = facets.labels.size();
  const auto per_mille = 0.001F * static_cast<float>(size.width);
  const Scales scales{config.margin * per_mille, config.agreement * per_mille,
                      static_cast<int>(0.01F * config.longest_bridge * static_cast<float>(size.width))};
  Votes votes(facets.count);
  std::vector<Seen> seen;
  for (int y = 0; y < size.height; ++y) {
    seen.clear();
    for (int x = 0; x < size.width; ++x) {
      const float d = evidence_px(x, y);
      if (std::isnan(d)) continue;
      seen.push_back({x, d, d - background.disparity_px(static_cast<float>(x), static_cast<float>(y))});
    }
    vote_in_row(facets.labels.row(y), size.width, seen, scales, votes);
    for (int x = 0; x < size.width; ++x) ++votes.pixels[index(facets.labels(x, y))];
  }

  std::vector<std::int32_t> labels(votes.pixels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto known = static_cast<double>(votes.figure[i] + votes.ground[i]);
    const bool enough = known > 0.01 * config.least_known * kConcluded * static_cast<double>(votes.pixels[i]);
    labels[i] = enough ? static_cast<std::int32_t>(votes.figure[i] > votes.ground[i]) : -1;
  }
  if (config.colour_reach >= 0) {
    open_gaps(labels, votes, mean_colours(facets, gray, rgb, votes.pixels), config.colour_reach);
  }
  return flooded(std::move(labels), facets.borders, 0);
}

}  // namespace cairn
