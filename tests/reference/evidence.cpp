// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace cairn::reference {
namespace {

std::size_t slot(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

template <class T>
T clamped_at(View<const T> image, int x, int y) {
  return image(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1));
}

/// (1 6 1; 6 36 6; 1 6 1): 64 times the smoothed grey.
int lightly_smoothed(View<const Gray> image, int x, int y) {
  int sum = 0;
  for (int v = -1; v <= 1; ++v) {
    for (int u = -1; u <= 1; ++u) {
      sum += (u == 0 ? 6 : 1) * (v == 0 ? 6 : 1) * clamped_at(image, x + u, y + v);
    }
  }
  return sum;
}

/// One value of the image, smoothed by g⊗g in 1/16: `value` gives each pixel's.
template <class Value>
int smoothed16(int x, int y, float sigma, Value value) {
  const int reach = sigma > 0 ? std::min(static_cast<int>(std::ceil(3.0 * sigma)), 15) : 0;
  const auto bell = [&](int i) { return i == 0 ? 1.0 : std::exp(-0.5 * i * i / (double{sigma} * sigma)); };
  double total = 0;
  for (int i = -reach; i <= reach; ++i) total += bell(i);
  std::vector<int> weights{256};
  for (int i = 1; i <= reach; ++i) {
    weights.push_back(static_cast<int>(std::lround(256 * bell(i) / total)));
    weights[0] -= 2 * weights.back();
  }
  int sum = 0;
  for (int v = -reach; v <= reach; ++v) {
    for (int u = -reach; u <= reach; ++u) {
      sum += weights[slot(std::abs(u))] * weights[slot(std::abs(v))] * value(x + u, y + v);
    }
  }
  return (sum + 2048) / 4096;
}

/// The next pixel of the row with evidence from x on in steps of `step`.
std::optional<int> next_seen(View<const float> evidence_px, int x, int y, int step) {
  for (; x >= 0 && x < evidence_px.width(); x += step) {
    if (!std::isnan(evidence_px(x, y))) return x;
  }
  return std::nullopt;
}

// The numbers of cairn/grouping/figure.cpp.
constexpr int kSeen = 20;
constexpr int kConcluded = 10;
constexpr int kCutOff = 5;
constexpr int kTooLong = 1;
constexpr int kInDoubt = 1;
constexpr int kRounds = 3;
constexpr double kUnit = 320;
constexpr double kEdge = 3.0;
constexpr double kEdgeNoise = 4.5;
constexpr double kSeenShare = 0.25;
constexpr int kCell = 16;
constexpr double kModelSpread = 12;
constexpr double kUnknown = 0.0003;
constexpr double kMost = 3;
constexpr double kOnSpread = 6;
constexpr double kAcross = 0.15;
constexpr double kDown = 0.03;
constexpr double kFarthest = 9;
constexpr float kBelow = 0.2F;
constexpr double kFootShare = 0.8;
constexpr double kHardlySeen = 0.05;

/// Does the facet of this pixel end in a row or column beside it?
bool is_at_border(View<const RegionId> labels, int x, int y) {
  for (const int v : {y - 1, y, y + 1}) {
    for (const int u : {x - 1, x, x + 1}) {
      const bool inside = u >= 0 && u < labels.width() && v >= 0 && v < labels.height();
      if (inside && labels(u, v) != labels(x, y)) return true;
    }
  }
  return false;
}

/// What one pixel says: positive is figure, negative ground, in twentieths of a pixel of evidence.
int vote(View<const RegionId> labels, View<const float> evidence_px, const Background& background,
         const FigureConfig& config, int x, int y) {
  const auto per_mille = 0.001F * static_cast<float>(evidence_px.width());
  const auto longest =
      static_cast<int>(0.01F * config.longest_bridge * static_cast<float>(evidence_px.width()));
  const auto stands_before = [&](int u) {
    const float before =
        evidence_px(u, y) - background.disparity_px(static_cast<float>(u), static_cast<float>(y));
    return before > config.margin * per_mille;
  };
  const std::optional<int> l = next_seen(evidence_px, x, y, -1);
  const std::optional<int> r = next_seen(evidence_px, x, y, 1);
  if (l == x && !stands_before(x)) return -kSeen;
  if (l == x) {
    const float weight = is_at_border(labels, x, y) ? config.border_weight : 1.0F;
    return static_cast<int>(std::lround(kSeen * weight));
  }
  if (!l && !r) return -kCutOff;
  if (!l || !r) return stands_before(l ? *l : *r) ? -kCutOff : -kConcluded;
  if (!stands_before(*l) || !stands_before(*r)) return -kConcluded;
  if (std::abs(evidence_px(*l, y) - evidence_px(*r, y)) > config.agreement * per_mille) return 0;
  return *r - *l > longest ? kTooLong : kConcluded;
}

/// Is this pixel at the foot of a wall: about the first row of its column where the floor is the background?
bool is_at_foot(const Background& background, Size size, const FigureConfig& config, int x, int y) {
  if (!background.has_floor || background.planes.size() < 2 || config.skirting <= 0) return false;
  const auto is_floor = [&](int v) {
    const auto column = static_cast<float>(x);
    const auto row = static_cast<float>(v);
    return background.planes[0].disparity_px(column, row) >= background.disparity_px(column, row);
  };
  int foot = 0;
  while (foot < size.height && !is_floor(foot)) ++foot;
  const float above = 0.01F * config.skirting * static_cast<float>(size.width);
  const bool below_a_wall = foot > 0 && foot < size.height &&
                            background.disparity_px(static_cast<float>(x), static_cast<float>(foot - 1)) > 0;
  return below_a_wall && static_cast<float>(y) >= static_cast<float>(foot) - above &&
         static_cast<float>(y) < static_cast<float>(foot) + kBelow * above;
}

/// All that is known of one facet.
struct Patch {
  std::int64_t for_figure = 0, for_ground = 0, seen_figure = 0, at_foot = 0;
  double pixels = 0;
  std::array<double, 3> colour{};  // mean
  int left = std::numeric_limits<int>::max(), right = -1, top = std::numeric_limits<int>::max(), bottom = -1;
  [[nodiscard]] bool is_seen() const {
    return static_cast<double>(seen_figure) > kSeen * kSeenShare * pixels;
  }
  [[nodiscard]] bool is_skirting() const {
    return static_cast<double>(at_foot) > kFootShare * pixels &&
           static_cast<double>(seen_figure) <= kSeen * kHardlySeen * pixels;
  }
  [[nodiscard]] std::array<int, 3> cell() const {
    const auto of = [](double channel) { return static_cast<int>(channel / kCell); };
    return {of(colour[0]), of(colour[1]), of(colour[2])};
  }
};

std::vector<Patch> patches_of(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                              View<const float> evidence_px, const Background& background,
                              const FigureConfig& config) {
  std::vector<Patch> patches(slot(facets.count));
  for (int y = 0; y < gray.height(); ++y) {
    for (int x = 0; x < gray.width(); ++x) {
      Patch& p = patches[index(facets.labels(x, y))];
      const int said = vote(facets.labels, evidence_px, background, config, x, y);
      p.for_figure += std::max(said, 0);
      p.for_ground += std::max(-said, 0);
      p.seen_figure += std::isnan(evidence_px(x, y)) ? 0 : std::max(said, 0);
      p.at_foot += is_at_foot(background, gray.size(), config, x, y) ? 1 : 0;
      p.pixels += 1;
      const Rgb colour = rgb.empty() ? Rgb{gray(x, y), gray(x, y), gray(x, y)} : rgb(x, y);
      p.colour = {p.colour[0] + colour.r, p.colour[1] + colour.g, p.colour[2] + colour.b};
      p.left = std::min(p.left, x);
      p.right = std::max(p.right, x);
      p.top = std::min(p.top, y);
      p.bottom = std::max(p.bottom, y);
    }
  }
  for (Patch& p : patches) {
    for (double& channel : p.colour) channel /= p.pixels;
  }
  return patches;
}

double difference(const std::array<double, 3>& p, const std::array<double, 3>& q) {
  return ((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2])) / 3;
}

/// Is facet i figure, or does it touch figure?
bool is_at_figure(std::int32_t i, const std::vector<std::int32_t>& figure,
                  const std::vector<Border>& borders) {
  const auto touches = [&](const Border& b) {
    return (b.a == i && figure[slot(b.b)] != 0) || (b.b == i && figure[slot(b.a)] != 0);
  };
  return figure[slot(i)] != 0 || std::any_of(borders.begin(), borders.end(), touches);
}

/// What the patches count in the models of ground and of figure, in pixels: figure where it is seen to be,
/// ground with all, but at figure only with what it is larger than a part of an object.
std::vector<double> counted(const std::vector<Patch>& patches, const std::vector<std::int32_t>& figure,
                            const std::vector<Border>& borders, double largest_part) {
  std::vector<double> counts;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const bool at_figure = is_at_figure(static_cast<std::int32_t>(i), figure, borders);
    const double as_ground = patches[i].pixels - (at_figure ? largest_part : 0);
    const double as_figure = patches[i].is_seen() ? patches[i].pixels : 0;
    counts.push_back(figure[i] != 0 ? as_figure : std::max(as_ground, 0.0));
  }
  return counts;
}

/// The sides that the cut before left, and what each patch counts on its side.
struct Sides {
  const std::vector<std::int32_t>& figure;
  std::vector<double> counts;
};

/// What counts of ground and of figure, each patch as far as `weight` says.
template <class Weight>
std::array<double, 2> ground_and_figure(const Sides& sides, Weight weight) {
  std::array<double, 2> sums{};
  for (std::size_t i = 0; i < sides.counts.size(); ++i) {
    if (sides.counts[i] > 0) sums.at(sides.figure[i] != 0 ? 1 : 0) += sides.counts[i] * weight(i);
  }
  return sums;
}

/// Logarithm of how many times as common a colour is in the ground as in the figure; each patch stands for
/// its cell of the colour cube with the mean colour of all that counts in that cell.
double ground_over_figure(const Patch& patch, const std::vector<Patch>& patches, const Sides& sides) {
  const auto like = [&](std::size_t i) {
    std::array<double, 3> mean{};
    double pixels = 0;
    for (std::size_t j = 0; j < patches.size(); ++j) {
      if (patches[j].cell() != patches[i].cell()) continue;
      for (std::size_t c = 0; c < 3; ++c) mean.at(c) += patches[j].colour.at(c) * sides.counts[j];
      pixels += sides.counts[j];
    }
    for (double& channel : mean) channel /= pixels;
    return std::exp(-difference(patch.colour, mean) / (2 * kModelSpread * kModelSpread));
  };
  const auto near = ground_and_figure(sides, like);
  const auto all = ground_and_figure(sides, [](std::size_t) { return 1.0; });
  const auto share = [&](std::size_t side) { return near.at(side) / std::max(all.at(side), 1.0) + kUnknown; };
  return std::clamp(std::log(share(0) / share(1)), -kMost, kMost);
}

/// How much more ground than figure of its colour lies beside patch i, in its own sizes, 0 … 1.
double goes_on(std::size_t i, const std::vector<Patch>& patches, const Sides& sides, int width) {
  const Patch& here = patches[i];
  const auto beside = [&](std::size_t j) {
    const Patch& there = patches[j];
    const int apart_x = std::max({here.left - there.right - 1, there.left - here.right - 1, 0});
    const int apart_y = std::max({here.top - there.bottom - 1, there.top - here.bottom - 1, 0});
    const double dx = apart_x / (kAcross * width);
    const double dy = apart_y / (kDown * width);
    const double dc = difference(here.colour, there.colour) / (kOnSpread * kOnSpread);
    const bool far = dx * dx > kFarthest || dy * dy > kFarthest || dc > kFarthest;
    return i == j || far ? 0.0 : std::exp(-(dc + dx * dx + dy * dy) / 2);
  };
  const auto near = ground_and_figure(sides, beside);
  return std::max(std::min(near[0] / here.pixels, 1.0) - std::min(near[1] / here.pixels, 1.0), 0.0);
}

}  // namespace

float noise_sigma(View<const Gray> image) {
  std::vector<int> responses;
  for (int y = 1; y + 1 < image.height(); ++y) {
    for (int x = 1; x + 1 < image.width(); ++x) {
      int sum = 0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u) sum += (u == 0 ? -2 : 1) * (v == 0 ? -2 : 1) * image(x + u, y + v);
      }
      responses.push_back(std::abs(sum));
    }
  }
  if (responses.empty()) return 0;
  std::sort(responses.begin(), responses.end());
  const int median = responses[(responses.size() - 1) / 2];
  const auto [first, last] = std::equal_range(responses.begin(), responses.end(), median);
  const double half = static_cast<double>(responses.size()) / 2;
  const double share =
      (half - static_cast<double>(first - responses.begin())) / static_cast<double>(last - first);
  return static_cast<float>((median + share - 0.5) / (6 * 0.6745));
}

Image<float> find_evidence(View<const Gray> left, const DisparityMap& disparity,
                           const EvidenceConfig& config) {
  const float least = config.noise_factor * reference::noise_sigma(left) + config.gradient_min;
  const auto s = [&](int x, int y) {
    return lightly_smoothed(left, std::clamp(x, 0, left.width() - 1), std::clamp(y, 0, left.height() - 1));
  };
  const auto textured = [&](int x, int y) {
    const int gx = std::abs(s(x + 1, y) - s(x - 1, y));
    const int gy = std::abs(s(x, y + 1) - s(x, y - 1));
    return disparity.reject(x, y) == Reject::none && gx > static_cast<int>(std::floor(least * 128.0F)) &&
           2 * gx > gy;
  };
  const float agreement = config.agreement * 0.001F * static_cast<float>(left.width());
  Image<float> evidence(left.size());
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      const float d = disparity.disparity_px(x, y);
      int friends = 0;
      for (int v = std::max(y - 2, 0); v <= std::min(y + 2, left.height() - 1); ++v) {
        for (int u = std::max(x - 2, 0); u <= std::min(x + 2, left.width() - 1); ++u) {
          if (u == x && v == y) continue;
          friends += textured(u, v) && std::abs(disparity.disparity_px(u, v) - d) <= agreement ? 1 : 0;
        }
      }
      evidence(x, y) = textured(x, y) && friends >= 3 ? d : std::numeric_limits<float>::quiet_NaN();
    }
  }
  return evidence;
}

Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma) {
  Image<std::uint16_t> strength(gray.size());
  const auto magnitude = [&](int x, int y, const auto& value) {
    const auto s = [&](int u, int v) {
      return smoothed16(std::clamp(u, 0, gray.width() - 1), std::clamp(v, 0, gray.height() - 1),
                        smoothing_sigma, value);
    };
    const int gx = s(x + 1, y) - s(x - 1, y);
    const int gy = s(x, y + 1) - s(x, y - 1);
    return static_cast<int>(std::sqrt(static_cast<float>(gx * gx + gy * gy)) / 8 + 0.5F);
  };
  for (int y = 0; y < gray.height(); ++y) {
    for (int x = 0; x < gray.width(); ++x) {
      int strongest = 0;
      if (rgb.empty()) {
        strongest = magnitude(x, y, [&](int u, int v) { return int{clamped_at(gray, u, v)}; });
      } else {
        for (const auto channel : {&Rgb::r, &Rgb::g, &Rgb::b}) {
          const auto value = [&](int u, int v) { return int{clamped_at(rgb, u, v).*channel}; };
          strongest = std::max(strongest, magnitude(x, y, value));
        }
      }
      strength(x, y) = static_cast<std::uint16_t>(strongest);
    }
  }
  return strength;
}

std::vector<Border> borders_of(View<const RegionId> labels, View<const std::uint16_t> edges) {
  std::map<std::pair<std::int32_t, std::int32_t>, Border> borders;
  const auto meet = [&](int x, int y, int u, int v) {
    if (u >= labels.width() || v >= labels.height() || labels(x, y) == labels(u, v)) return;
    const auto ends = std::minmax({number(labels(x, y)), number(labels(u, v))});
    Border& border = borders[ends];
    border.a = ends.first;
    border.b = ends.second;
    border.length += 1;
    border.edge_sum += std::max(edges(x, y), edges(u, v));
    border.x2_sum += x + u;
    border.y2_sum += y + v;
  };
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      meet(x, y, x + 1, y);
      meet(x, y, x, y + 1);
    }
  }
  std::vector<Border> sorted;
  sorted.reserve(borders.size());
  for (const auto& [ends, border] : borders) sorted.push_back(border);
  return sorted;
}

std::vector<std::int32_t> flooded(std::vector<std::int32_t> labels, const std::vector<Border>& borders,
                                  std::int32_t otherwise) {
  // The flood takes one facet after the other, always across the weakest border that it stands before.
  for (;;) {
    const Border* weakest = nullptr;
    for (const Border& border : borders) {
      const bool at_the_edge = (labels[slot(border.a)] < 0) != (labels[slot(border.b)] < 0);
      if (at_the_edge && (weakest == nullptr || border.mean_edge() < weakest->mean_edge())) weakest = &border;
    }
    if (weakest == nullptr) break;
    const std::int32_t label = std::max(labels[slot(weakest->a)], labels[slot(weakest->b)]);
    labels[slot(weakest->a)] = labels[slot(weakest->b)] = label;
  }
  for (std::int32_t& label : labels) label = label < 0 ? otherwise : label;
  return labels;
}

std::vector<std::int32_t> minimum_cut(const std::vector<std::int64_t>& cost_0,
                                      const std::vector<std::int64_t>& cost_1, const std::vector<Tie>& ties) {
  const std::size_t source = cost_0.size();
  const std::size_t sink = source + 1;
  std::vector<std::vector<std::int64_t>> left(sink + 1, std::vector<std::int64_t>(sink + 1));
  for (std::size_t i = 0; i < source; ++i) {
    left[source][i] = cost_0[i];
    left[i][sink] = cost_1[i];
  }
  for (const Tie& tie : ties) {
    left[slot(tie.a)][slot(tie.b)] += tie.cost;
    left[slot(tie.b)][slot(tie.a)] += tie.cost;
  }
  // Edmonds and Karp: along a shortest path as much as it takes, until there is none.
  for (;;) {
    std::vector<std::optional<std::size_t>> from(sink + 1);
    from[source] = source;
    std::vector<std::size_t> queue{source};
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (std::size_t to = 0; to <= sink; ++to) {
        if (from[to] || left[queue[head]][to] <= 0) continue;
        from[to] = queue[head];
        queue.push_back(to);
      }
    }
    std::vector<std::int32_t> reached;
    for (std::size_t i = 0; i < source; ++i) reached.push_back(from[i] ? 1 : 0);
    if (!from[sink]) return reached;
    std::int64_t amount = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = sink; i != source; i = *from[i]) amount = std::min(amount, left[*from[i]][i]);
    for (std::size_t i = sink; i != source; i = *from[i]) {
      left[*from[i]][i] -= amount;
      left[i][*from[i]] += amount;
    }
  }
}

std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          const FigureConfig& config) {
  const std::vector<Patch> patches = patches_of(facets, gray, rgb, evidence_px, background, config);
  const double edge = 4 * (kEdge + kEdgeNoise * reference::noise_sigma(gray));
  std::vector<Tie> ties;
  for (const Border& b : facets.borders) {
    const double cost = config.smoothness * static_cast<double>(b.length) * std::exp(-b.mean_edge() / edge);
    ties.push_back({b.a, b.b, std::llround(kUnit * cost)});
  }
  const double largest_part =
      background.has_floor
          ? std::ceil(double{config.largest_part} * static_cast<double>(gray.size().area()) / 100)
          : 0;
  std::vector<std::int32_t> figure(patches.size());
  for (int round = 0; round < kRounds; ++round) {
    const Sides sides{figure, counted(patches, figure, facets.borders, largest_part)};
    std::vector<std::int64_t> cost_0;
    std::vector<std::int64_t> cost_1;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const Patch& p = patches[i];
      const auto pixels = static_cast<std::int64_t>(p.pixels);
      const std::int64_t for_figure = p.is_skirting() ? p.seen_figure : p.for_figure;
      cost_0.push_back(static_cast<std::int64_t>(kUnit) / kSeen * for_figure);
      cost_1.push_back(static_cast<std::int64_t>(kUnit) / kSeen * (p.for_ground + kInDoubt * pixels));
      const bool asked = is_at_figure(static_cast<std::int32_t>(i), figure, facets.borders) && !p.is_seen();
      if (round == 0 || !asked) continue;
      const double colour = config.colour_weight * ground_over_figure(p, patches, sides);
      const double on = config.continuation_weight * goes_on(i, patches, sides, gray.width());
      if (!p.is_skirting()) cost_0.back() += std::llround(kUnit * p.pixels * std::max(-colour, 0.0));
      cost_1.back() += std::llround(kUnit * p.pixels * (std::max(colour, 0.0) + on));
    }
    figure = reference::minimum_cut(cost_0, cost_1, ties);
  }
  return figure;
}

}  // namespace cairn::reference
