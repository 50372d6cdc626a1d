// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/evidence.hpp"

#include <algorithm>
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

/// What one pixel says: positive is figure, negative ground, in tenths of a vote; 0 = nothing.
int vote(View<const float> evidence_px, const Background& background, const FigureConfig& config, int x,
         int y) {
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
  if (l == x) return stands_before(x) ? 20 : -20;
  if (!l && !r) return -5;
  if (!l || !r) return stands_before(l ? *l : *r) ? -5 : -10;
  if (!stands_before(*l) || !stands_before(*r)) return -10;
  if (std::abs(evidence_px(*l, y) - evidence_px(*r, y)) > config.agreement * per_mille) return 0;
  return *r - *l > longest ? 1 : 10;
}

/// What is known of one facet; r, g, b are sums over its pixels.
struct Tally {
  std::int64_t sum = 0, known = 0, seen_figure = 0, pixels = 0;
  double r = 0, g = 0, b = 0;
  [[nodiscard]] bool is_seen() const {
    return static_cast<double>(seen_figure) > 0.15 * static_cast<double>(pixels);
  }
  [[nodiscard]] bool like(const Tally& o, float reach) const {
    const auto n = static_cast<double>(pixels);
    const auto m = static_cast<double>(o.pixels);
    return std::max({std::abs(r / n - o.r / m), std::abs(g / n - o.g / m), std::abs(b / n - o.b / m)}) <=
           reach;
  }
};

/// Is figure facet i, concluded but not seen, of a colour that is the ground's rather than the figure's?
bool is_gap(std::size_t i, const std::vector<Tally>& tally, const std::vector<std::int32_t>& figure,
            float reach) {
  if (reach < 0 || figure[i] != 1 || tally[i].is_seen()) return false;
  double ground = 0, ground_alike = 0, seen = 0, seen_alike = 0;
  for (std::size_t j = 0; j < tally.size(); ++j) {
    const double alike = tally[i].like(tally[j], reach) ? static_cast<double>(tally[j].pixels) : 0.0;
    if (figure[j] == 0) {
      ground += static_cast<double>(tally[j].pixels);
      ground_alike += alike;
    } else if (figure[j] == 1 && tally[j].is_seen()) {
      seen += static_cast<double>(tally[j].pixels);
      seen_alike += alike;
    }
  }
  const double common = ground_alike / std::max(ground, 1.0);
  return common > 0.02 && common > 3 * seen_alike / std::max(seen, 1.0);
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

std::vector<std::int32_t> separate_figure(const Facets& facets, View<const Gray> gray, View<const Rgb> rgb,
                                          View<const float> evidence_px, const Background& background,
                                          const FigureConfig& config) {
  std::vector<Tally> tally(slot(facets.count));
  for (int y = 0; y < gray.height(); ++y) {
    for (int x = 0; x < gray.width(); ++x) {
      const int said = vote(evidence_px, background, config, x, y);
      Tally& t = tally[index(facets.labels(x, y))];
      t.sum += said;
      t.known += std::abs(said);
      t.seen_figure += said == 20 ? 1 : 0;
      t.pixels += 1;
      const Rgb colour = rgb.empty() ? Rgb{gray(x, y), gray(x, y), gray(x, y)} : rgb(x, y);
      t.r += colour.r;
      t.g += colour.g;
      t.b += colour.b;
    }
  }
  std::vector<std::int32_t> figure;
  for (const Tally& t : tally) {
    const bool enough =
        static_cast<double>(t.known) > 0.01 * config.least_known * 10 * static_cast<double>(t.pixels);
    figure.push_back(!enough ? -1 : t.sum > 0 ? 1 : 0);
  }
  std::vector<std::int32_t> opened = figure;
  for (std::size_t i = 0; i < figure.size(); ++i) {
    if (is_gap(i, tally, figure, config.colour_reach)) opened[i] = 0;
  }
  return reference::flooded(std::move(opened), facets.borders, 0);
}

}  // namespace cairn::reference
