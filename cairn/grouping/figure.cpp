// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/core/pool_memory.hpp>
#include <cairn/grouping/colour_model.hpp>
#include <cairn/grouping/figure.hpp>
#include <cairn/grouping/like_facets.hpp>
#include <cairn/grouping/minimum_cut.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/runs.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory_resource>
#include <mutex>
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

/// What speaks for a facet's labels.
struct Votes {
  std::array<std::int64_t, 2> sides{};  // ground and figure
  std::int64_t seen_figure = 0;         // part of those for figure
  friend Votes operator+(const Votes& p, const Votes& q) {
    return {{p.sides[0] + q.sides[0], p.sides[1] + q.sides[1]}, p.seen_figure + q.seen_figure};
  }
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
  bool figure;  // more than the margin before the background
};

/// Votes along one row.
class RowVotes {
 public:
  RowVotes(View<const RegionId> facets, const Scales& scales, std::vector<Votes>& votes, const Exec& exec)
      : run_(kernels::look_kernels(exec)),
        facets_(facets),
        scales_(scales),
        votes_(votes),
        behind_px_(slot(facets.width())),
        at_border_(slot(facets.width())),
        seen_(slot(facets.width()) + 1) {}

  void add(int y, View<const float> evidence_px, const std::vector<GroundPlane>& background) {
    const int width = facets_.width();
    run_.find_behind(background.data(), static_cast<int>(background.size()), y, width, behind_px_.data());
    run_.mark_borders(facets_.row(std::max(y - 1, 0)), facets_.row(y),
                      facets_.row(std::min(y + 1, facets_.height() - 1)), width, at_border_.data());
    facet_ = facets_.row(y);
    const std::size_t count = find_seen(evidence_px.row(y));
    if (count == 0) return vote_to_border(0, width, nullptr);
    const Seen* const last = &seen_[count - 1];
    vote_to_border(0, seen_.front().x, seen_.data());
    for (const Seen* seen = seen_.data(); seen <= last; ++seen) {
      vote_at(*seen);
      if (seen < last && seen[1].x > seen->x + 1) vote_between(seen[0], seen[1]);
    }
    vote_to_border(last->x + 1, width, last);
  }

 private:
  std::size_t find_seen(const float* evidence_px) {
    std::size_t count = 0;
    for (int x = 0; x < facets_.width(); ++x) {
      const float d = evidence_px[x];
      seen_[count] = {x, d, d - behind_px_[slot(x)] > scales_.margin_px};
      count += std::isnan(d) ? 0 : 1;
    }
    return count;
  }

  void vote(int first, int last, bool figure, int weight) {
    for (int x = first; x < last; ++x) votes_[index(facet_[x])].sides[figure ? 1 : 0] += weight;
  }

  void vote_at(const Seen& seen) {
    // The matcher gives the nearer surface's disparity to both sides of its edge, so what is seen before the
    // background next to a border may be the neighbour's.
    const int of_figure = at_border_[slot(seen.x)] != 0 ? scales_.seen_at_border : kSeen;
    Votes& votes = votes_[index(facet_[seen.x])];
    votes.sides[seen.figure ? 1 : 0] += seen.figure ? of_figure : kSeen;
    votes.seen_figure += seen.figure ? of_figure : 0;
  }

  void vote_between(const Seen& left, const Seen& right) {
    const bool figure = left.figure && right.figure;
    int weight = kConcluded;
    if (figure && std::abs(left.disparity_px - right.disparity_px) > scales_.agreement_px) weight = 0;
    if (figure && weight > 0 && right.x - left.x > scales_.longest_bridge_px) weight = kTooLong;
    vote(left.x + 1, right.x, figure, weight);
  }

  void vote_to_border(int first, int last, const Seen* end) {
    const bool sure = end != nullptr && !end->figure;
    vote(first, last, false, sure ? kConcluded : kCutOff);
  }

  const kernels::LookKernels& run_;
  View<const RegionId> facets_;
  Scales scales_;
  std::vector<Votes>& votes_;
  const RegionId* facet_ = nullptr;
  std::vector<float> behind_px_;
  std::vector<std::uint8_t> at_border_;
  std::vector<Seen> seen_;
};

std::pmr::vector<Look> looks_of(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                const std::pmr::vector<Votes>& votes, const Exec& exec,
                                std::pmr::memory_resource* memory) {
  struct Sums {
    std::array<std::int64_t, 3> colour{};
    Extent extent;
    int pixels = 0;
  };
  std::pmr::vector<Sums> sums(slot(facets.count), memory);
  ColourSums until(gray, rgb);
  for_each_run(facets.labels, exec, [&](const Run& run) {
    const std::array<int, 3> colour = until.of(run);
    Sums& sum = sums[index(run.label)];
    for (std::size_t c = 0; c < 3; ++c) sum.colour[c] += colour[c];
    sum.extent.add(run);
    sum.pixels += run.length();
  });
  std::pmr::vector<Look> looks(sums.size(), memory);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    Look& look = looks[i];
    look.box = sums[i].extent.box();
    look.pixels = sums[i].pixels;
    for (std::size_t c = 0; c < 3; ++c) look.colour[c] = static_cast<double>(sums[i].colour[c]) / look.pixels;
    look.seen = static_cast<double>(votes[i].seen_figure) > kSeenShare * kSeen * look.pixels;
  }
  return looks;
}

/// What each facet counts in the models of ground and of figure, in pixels. Figure counts where it is seen to
/// be. Ground counts unless it touches figure and is no larger than a part of an object: a part that has the
/// colour of the rest of its object, but no evidence, would speak for the ground that it was taken for.
std::pmr::vector<double> counted(const std::pmr::vector<Look>& looks, const std::vector<std::int32_t>& figure,
                                 const std::vector<bool>& asked, double largest_part,
                                 std::pmr::memory_resource* memory) {
  std::pmr::vector<double> pixels(looks.size(), memory);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const double as_ground = std::max(looks[i].pixels - (asked[i] ? largest_part : 0), 0.0);
    const double as_figure = looks[i].seen ? looks[i].pixels : 0;
    pixels[i] = figure[i] != 0 ? as_figure : as_ground;
  }
  return pixels;
}

/// Those of `pixels` that count on one side.
std::pmr::vector<double> on_side(const std::pmr::vector<double>& pixels,
                                 const std::vector<std::int32_t>& figure, bool of_figure) {
  std::pmr::vector<double> counted(pixels.size(), pixels.get_allocator());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if ((figure[i] != 0) == of_figure) counted[i] = pixels[i];
  }
  return counted;
}

/// Whether ground goes on beside a facet in the facet's colour.
class Continuation {
 public:
  Continuation(const std::pmr::vector<Look>& looks, const std::pmr::vector<double>& counted,
               const std::vector<std::int32_t>& figure, const Likeness& likeness, const Exec& exec,
               std::pmr::memory_resource* memory)
      : looks_(looks),
        ground_(looks, on_side(counted, figure, false), likeness, exec, memory),
        figure_(looks, on_side(counted, figure, true), likeness, exec, memory) {}

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
  const std::pmr::vector<Look>& looks_;
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

std::pmr::vector<Tie> ties_of(const std::vector<Border>& borders, double smoothness, double noise,
                              std::pmr::memory_resource* memory) {
  const double edge = 4 * (kEdge + kEdgeNoise * noise);  // borders measure in quarters
  std::pmr::vector<Tie> ties(borders.size(), memory);
  std::transform(borders.begin(), borders.end(), ties.begin(), [&](const Border& border) {
    const double cost =
        smoothness * static_cast<double>(border.length) * std::exp(-border.mean_edge() / edge);
    return Tie{border.a, border.b, std::llround(kUnit * cost)};
  });
  return ties;
}

/// Per column the first row where the floor is nearer than the walls, where a wall is seen above it; −1 =
/// nowhere.
std::vector<int> feet(Size size, const Background& background, const Exec& exec) {
  const kernels::LookKernels& run = kernels::look_kernels(exec);
  const auto planes = static_cast<int>(background.planes.size());
  std::vector<float> behind_px(slot(size.width));
  std::vector<std::uint8_t> wall_above(behind_px.size());
  std::vector<int> foot(behind_px.size(), -1);
  std::vector<int> columns(behind_px.size());  // where none is found yet
  std::iota(columns.begin(), columns.end(), 0);
  for (int y = 0; y < size.height && !columns.empty(); ++y) {
    run.find_behind(background.planes.data(), planes, y, size.width, behind_px.data());
    std::size_t left = 0;
    for (const int x : columns) {
      const float floor =
          background.planes.front().disparity_px(static_cast<float>(x), static_cast<float>(y));
      const bool at_floor = floor >= behind_px[slot(x)];
      if (at_floor && wall_above[slot(x)] != 0) foot[slot(x)] = y;
      wall_above[slot(x)] = behind_px[slot(x)] > 0 ? 1 : 0;
      columns[left] = x;
      left += at_floor ? 0 : 1;
    }
    columns.resize(left);
  }
  return foot;
}

/// Facets along the foot of a wall that hardly show evidence of figure.
std::vector<bool> skirting(const Facets& facets, const Background& background,
                           const std::pmr::vector<Votes>& votes, const std::pmr::vector<Look>& looks,
                           float above_percent, const Exec& exec) {
  constexpr float kBelow = 0.2F;        // of what is above
  constexpr double kShare = 0.8;        // of a facet's pixels
  constexpr double kHardlySeen = 0.05;  // of its pixels
  std::vector<bool> result(looks.size());
  if (!background.has_floor || background.planes.size() < 2 || above_percent <= 0) return result;
  const View<const RegionId> labels = facets.labels;
  const float above = 0.01F * above_percent * static_cast<float>(labels.width());
  std::vector<std::int64_t> within(result.size());
  const std::vector<int> foot = feet(labels.size(), background, exec);
  for (int x = 0; x < labels.width(); ++x) {
    if (foot[slot(x)] < 0) continue;
    const auto at = static_cast<float>(foot[slot(x)]);
    const int first = std::max(static_cast<int>(std::ceil(at - above)), 0);
    const int last = static_cast<int>(std::ceil(at + kBelow * above));
    for (int y = first; y < std::min(last, labels.height()); ++y) ++within[index(labels(x, y))];
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = static_cast<double>(within[i]) > kShare * looks[i].pixels &&
                static_cast<double>(votes[i].seen_figure) <= kHardlySeen * kSeen * looks[i].pixels;
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

std::pmr::vector<Votes> votes_of(const Facets& facets, View<const float> evidence_px,
                                 const Background& background, const FigureConfig& config, const Exec& exec,
                                 std::pmr::memory_resource* memory) {
  const Size size = facets.labels.size();
  const auto per_mille = 0.001F * static_cast<float>(size.width);
  const Scales scales{config.margin * per_mille, config.agreement * per_mille,
                      static_cast<int>(0.01F * config.longest_bridge * static_cast<float>(size.width)),
                      static_cast<int>(std::lround(static_cast<float>(kSeen) * config.border_weight))};
  std::pmr::vector<Votes> votes(slot(facets.count), memory);
  std::mutex adding_up;
  const int rows_each = (size.height + exec.threads() - 1) / exec.threads();
  parallel_for(exec, size.height, rows_each, [&](int first, int last) {
    std::vector<Votes> of_rows(votes.size());
    RowVotes row(facets.labels, scales, of_rows, exec);
    for (int y = first; y < last; ++y) row.add(y, evidence_px, background.planes);
    const std::lock_guard lock(adding_up);
    std::transform(votes.begin(), votes.end(), of_rows.begin(), votes.begin(), std::plus<>());
  });
  return votes;
}

}  // namespace

std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          float noise_sigma, const FigureConfig& config, const Exec& exec) {
  PoolMemory memory(exec.pool);
  const std::pmr::vector<Votes> votes = votes_of(facets, evidence_px, background, config, exec, &memory);
  const std::pmr::vector<Look> looks = looks_of(facets, gray, rgb, votes, exec, &memory);
  const std::vector<bool> at_foot = skirting(facets, background, votes, looks, config.skirting, exec);
  constexpr auto kVote = static_cast<std::int64_t>(kUnit) / kSeen;
  std::pmr::vector<std::int64_t> ground_costs(looks.size(), &memory);
  std::pmr::vector<std::int64_t> figure_costs(looks.size(), &memory);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    ground_costs[i] = kVote * (at_foot[i] ? votes[i].seen_figure : votes[i].sides[1]);
    figure_costs[i] = kVote * (votes[i].sides[0] + kInDoubt * static_cast<std::int64_t>(looks[i].pixels));
  }
  MinimumCuts cuts(looks.size(), ties_of(facets.borders, config.smoothness, noise_sigma, &memory), exec.pool);
  std::vector<std::int32_t> figure = cuts.cut(ground_costs, figure_costs);
  // Where no floor is known, what mirrors an object would pass for a part of it.
  const double largest_part =
      background.has_floor ? static_cast<double>(pixels_in(config.largest_part, gray.size())) : 0;
  const Likeness likeness(gray.width());
  for (int round = 1; round < kRounds; ++round) {
    std::pmr::vector<std::int64_t> with_colour_ground(ground_costs, &memory);
    std::pmr::vector<std::int64_t> with_colour_figure(figure_costs, &memory);
    const std::vector<bool> asked = around(figure, facets.borders);
    const std::pmr::vector<double> pixels = counted(looks, figure, asked, largest_part, &memory);
    const ColourModel model(looks, figure, pixels, exec, &memory);
    const Continuation goes_on(looks, pixels, figure, likeness, exec, &memory);
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
    figure = cuts.cut(with_colour_ground, with_colour_figure);
  }
  return figure;
}

}  // namespace cairn
