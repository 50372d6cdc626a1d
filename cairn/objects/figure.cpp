// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/evidence.hpp>
#include <cairn/objects/figure.hpp>
#include <cairn/objects/look_kernels.hpp>
#include <cairn/regions/minimum_cut.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
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

/// What each facet counts as ground, and what as figure: one of both is 0.
struct Counted {
  std::vector<double> ground;
  std::vector<double> figure;
};
Counted parted(const std::vector<double>& counted, const std::vector<std::int32_t>& figure) {
  Counted parts{counted, counted};
  for (std::size_t i = 0; i < figure.size(); ++i) (figure[i] != 0 ? parts.ground : parts.figure)[i] = 0;
  return parts;
}

/// How common colours are in the ground and in the figure. Colours are gathered in cells of the colour cube,
/// each with its own mean.
class ColourModel {
 public:
  ColourModel(const std::vector<Look>& looks, const std::vector<std::int32_t>& figure,
              const std::vector<double>& counted, const Exec& exec)
      : run_(kernels::look_kernels(exec)) {
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
    for (const auto& [key, cell] : cells) {
      for (std::size_t c = 0; c < 3; ++c) mean_[c].push_back(cell.mean[c]);
      for (std::size_t side = 0; side < 2; ++side) pixels_.at(side).push_back(cell.pixels.at(side));
    }
  }

  /// Logarithm of how many times as common a colour is in the ground as in the figure, −kMost … kMost.
  /// `work`: working memory.
  [[nodiscard]] double ground_over_figure(const Colour& colour, std::vector<double>& work) const {
    work.resize(mean_[0].size());
    const kernels::NearPixels near =
        run_.pixels_like({mean_[0].data(), mean_[1].data(), mean_[2].data(), pixels_[0].data(),
                          pixels_[1].data(), static_cast<int>(work.size())},
                         colour.data(), 2 * kSpread * kSpread, work.data());
    const auto share = [&](double pixels, double total) { return pixels / std::max(total, 1.0) + kUnknown; };
    return std::clamp(std::log(share(near.ground, total_[0]) / share(near.figure, total_[1])), -kMost, kMost);
  }

 private:
  static constexpr double kSpread = 12;       // grey levels
  static constexpr double kUnknown = 0.0003;  // colours that nothing has are nobody's
  static constexpr double kMost = 3;
  struct Cell {
    Colour mean{};
    std::array<double, 2> pixels{};  // of ground, of figure
  };
  const kernels::LookKernels& run_;
  std::array<std::vector<double>, 3> mean_;  // of the cells, one list per channel
  std::array<std::vector<double>, 2> pixels_;
  std::array<double, 2> total_{};
};

/// Whether ground goes on beside a facet in the facet's colour.
class Continuation {
 public:
  Continuation(const std::vector<Look>& looks, int width, const Exec& exec)
      : run_(kernels::look_kernels(exec)),
        looks_(looks),
        across_(kAcross * width),
        down_(kDown * width),
        squares_across_(squares(across_)),
        squares_down_(squares(down_)) {
    const std::size_t length = looks.size() + kernels::kLookSlack;
    for (auto& side : sides_) side.resize(length);
    for (auto& channel : channels_) channel.resize(length);
    facet_.resize(length);
    sort_by_grey();
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (looks[i].box.height > most_down()) tall_.push_back(static_cast<std::int32_t>(i));
      in_order_ = in_order_ && (i == 0 || looks[i - 1].box.y <= looks[i].box.y);
    }
  }

  /// Lists of the facets that one facet resembles and is near to; working memory.
  struct Like {
    explicit Like(const Continuation& of)
        : found(of.facet_.size()), others(found.size()), likeness(found.size()) {}
    std::vector<std::int32_t> found;
    std::vector<std::int32_t> others;
    std::vector<double> likeness;  // at first its logarithm
    std::size_t count = 0;
  };

  /// 0 … 1: how much ground of its colour lies beside facet i, more than there is seen figure of that colour,
  /// compared with its own size.
  double operator()(std::size_t i, const Counted& counted, Like& like) const {
    find_like(i, like);
    double near_ground = 0;
    double near_figure = 0;
    for (std::size_t k = 0; k < like.count; ++k) {
      const std::size_t other = slot(like.others[k]);
      near_ground += like.likeness[k] * counted.ground[other];
      near_figure += like.likeness[k] * counted.figure[other];
    }
    const double pixels = looks_[i].pixels;
    return std::max(std::min(near_ground / pixels, 1.0) - std::min(near_figure / pixels, 1.0), 0.0);
  }

 private:
  static constexpr double kSpread = 6;     // grey levels
  static constexpr double kAcross = 0.15;  // of the width
  static constexpr double kDown = 0.03;    // of the width: floor and wall change fast along a column
  static constexpr double kFarthest = 9;   // squared deviations

  static constexpr int kBins = 16;
  static constexpr int kBinWidth = 256 / kBins;  // grey levels

  /// The squares of the pixels in deviations, for so many as are within kFarthest.
  static std::vector<double> squares(double deviation) {
    std::vector<double> result;
    const auto square = [&](std::size_t pixels) {
      const double in_deviations = static_cast<double>(pixels) / deviation;
      return in_deviations * in_deviations;
    };
    while (square(result.size()) <= kFarthest) result.push_back(square(result.size()));
    return result;
  }
  /// The most pixels that are within kFarthest.
  [[nodiscard]] int most_across() const { return static_cast<int>(squares_across_.size()) - 1; }
  [[nodiscard]] int most_down() const { return static_cast<int>(squares_down_.size()) - 1; }

  static double grey_of(const Look& look) { return (look.colour[0] + look.colour[1] + look.colour[2]) / 3; }
  static int bin_of(double grey) { return std::clamp(static_cast<int>(grey) / kBinWidth, 0, kBins - 1); }

  /// Only facets of like grey can be of like colour: those of a bin stand together, in their order.
  void sort_by_grey() {
    for (const Look& look : looks_) ++bin_end_[static_cast<std::size_t>(bin_of(grey_of(look))) + 1];
    std::partial_sum(bin_end_.begin(), bin_end_.end(), bin_end_.begin());
    std::array<std::int32_t, kBins + 1> next = bin_end_;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      const std::size_t at = slot(next[static_cast<std::size_t>(bin_of(grey_of(looks_[i])))]++);
      const Rect& box = looks_[i].box;
      facet_[at] = static_cast<std::int32_t>(i);
      sides_[0][at] = box.x;
      sides_[1][at] = box.x + box.width;
      sides_[2][at] = box.y;
      sides_[3][at] = box.y + box.height;
      for (std::size_t c = 0; c < 3; ++c) channels_[c][at] = static_cast<float>(looks_[i].colour[c]);
    }
  }

  /// The facets that i resembles and is near to, and how much each does, 0 … 1. Always in the same order.
  void find_like(std::size_t i, Like& like) const {
    // Facets come in the order of their first row. Those that end far above are passed over, and among those
    // that begin far above only tall ones reach down.
    const Rect& box = looks_[i].box;
    const int above = box.y - 2 * most_down();
    like.count = 0;
    for (const std::int32_t j : tall_) {
      if (in_order_ && looks_[slot(j)].box.y < above) add_like(i, slot(j), like);
    }
    constexpr double kMostGrey = 1.001 * kSpread * 3;  // √kFarthest deviations
    const double grey = grey_of(looks_[i]);
    for (int bin = bin_of(grey - kMostGrey); bin <= bin_of(grey + kMostGrey); ++bin) {
      const auto first = bin_end_[static_cast<std::size_t>(bin)];
      const auto last = bin_end_[static_cast<std::size_t>(bin) + 1];
      const int found =
          run_.within(arrays(), window_about(looks_[i]), in_order_ ? first_from(above, first, last) : first,
                      in_order_ ? first_from(box.y + box.height + most_down() + 1, first, last) : last,
                      like.found.data());
      for (int k = 0; k < found; ++k) add_like(i, slot(facet_[slot(like.found[slot(k)])]), like);
    }
    run_.exponentials(like.likeness.data(), static_cast<int>(like.count));
  }

  /// The first of the facets first … last − 1 of a bin that does not begin above the row.
  [[nodiscard]] std::int32_t first_from(int row, std::int32_t first, std::int32_t last) const {
    const auto top = sides_[2].begin();
    return static_cast<std::int32_t>(std::lower_bound(top + first, top + last, row) - top);
  }
  [[nodiscard]] kernels::LookArrays arrays() const {
    return {sides_[0].data(),    sides_[1].data(),    sides_[2].data(),   sides_[3].data(),
            channels_[0].data(), channels_[1].data(), channels_[2].data()};
  }
  /// Where those that a facet may resemble are sure to be.
  [[nodiscard]] kernels::LookWindow window_about(const Look& look) const {
    constexpr auto kMostSquares = static_cast<float>(1.001 * 3 * kSpread * kSpread * kFarthest);
    const auto channel = [&](std::size_t c) { return static_cast<float>(look.colour[c]); };
    const Rect& box = look.box;
    return {box.x - most_across(),
            box.x + box.width + most_across(),
            box.y - most_down(),
            box.y + box.height + most_down(),
            channel(0),
            channel(1),
            channel(2),
            kMostSquares};
  }

  /// Appends facet j with the logarithm of its likeness, if it resembles i and is near to it.
  void add_like(std::size_t i, std::size_t j, Like& like) const {
    const Look& here = looks_[i];
    const Look& there = looks_[j];
    const Size between = gap_between(here.box, there.box);
    if (between.height > most_down() || between.width > most_across() || i == j) return;
    const double dc = difference(here.colour, there.colour) / (kSpread * kSpread);
    if (dc > kFarthest) return;
    like.others[like.count] = static_cast<std::int32_t>(j);
    like.likeness[like.count++] =
        -(dc + squares_across_[slot(between.width)] + squares_down_[slot(between.height)]) / 2;
  }

  const kernels::LookKernels& run_;
  const std::vector<Look>& looks_;
  double across_;  // px
  double down_;    // px
  std::vector<double> squares_across_;
  std::vector<double> squares_down_;
  std::vector<std::int32_t> tall_;
  bool in_order_ = true;
  // The same facets sorted by grey, one list per quantity.
  std::array<std::int32_t, kBins + 1> bin_end_{};
  std::vector<std::int32_t> facet_;
  std::array<std::vector<std::int32_t>, 4> sides_;
  std::array<std::vector<float>, 3> channels_;
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
  const Continuation goes_on(looks, gray.width(), exec);
  for (int round = 1; round < kRounds; ++round) {
    std::vector<std::int64_t> with_colour_ground = ground_costs;
    std::vector<std::int64_t> with_colour_figure = figure_costs;
    const std::vector<bool> asked = around(figure, facets.borders);
    const std::vector<double> pixels = counted(looks, figure, asked, largest_part);
    const ColourModel model(looks, figure, pixels, exec);
    const Counted pixels_of = parted(pixels, figure);
    parallel_for(exec, facets.count, kGrain, [&](int first, int last) {
      Continuation::Like like(goes_on);
      std::vector<double> work;
      for (auto i = slot(first); i < slot(last); ++i) {
        if (!asked[i] || looks[i].seen) continue;
        const double colour = config.colour_weight * model.ground_over_figure(looks[i].colour, work);
        const double on = config.continuation_weight * goes_on(i, pixels_of, like);
        if (!at_foot[i])
          with_colour_ground[i] += std::llround(kUnit * looks[i].pixels * std::max(-colour, 0.0));
        with_colour_figure[i] += std::llround(kUnit * looks[i].pixels * (std::max(colour, 0.0) + on));
      }
    });
    figure = minimum_cut(with_colour_ground, with_colour_figure, ties);
  }
  return figure;
}

}  // namespace cairn
