// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/random.hpp>
#include <cairn/scene/plane_fit.hpp>
#include <cairn/scene/plane_through_pairs.hpp>
#include <cmath>
#include <cstddef>
#include <utility>

namespace cairn {
namespace {

double disparity(const PointPair& pair) {
  return double{pair.x_left} - pair.x_right;
}

std::optional<GroundPlane> least_squares(std::span<const PointPair> pairs) {
  if (pairs.empty()) return std::nullopt;
  PlaneFit fit(pairs[0].x_left, pairs[0].y_left);
  for (const auto& pair : pairs) fit.add(pair.x_left, pair.y_left, disparity(pair));
  return fit.solve();
}

double distance(const GroundPlane& plane, const PointPair& pair) {
  return std::hypot(disparity(pair) - plane.disparity_px(pair.x_left, pair.y_left),
                    double{pair.y_left} - pair.y_right);
}

std::vector<PointPair> agreeing(const GroundPlane& plane, std::span<const PointPair> pairs) {
  std::vector<PointPair> found;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(found),
               [&](const PointPair& pair) { return distance(plane, pair) <= kPairTolerance; });
  return found;
}

double mean_square(const PairsPlane& found) {
  double sum = 0;
  for (const auto& pair : found.pairs) sum += std::pow(distance(found.plane, pair), 2);
  return sum / static_cast<double>(found.pairs.size());
}

using Triple = std::array<std::size_t, 3>;

/// All triples of n items, or a fixed sample of them if there are many.
std::vector<Triple> triples(std::size_t n) {
  std::vector<Triple> chosen;
  if (n <= 12) {  // 220 triples
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) {
        for (std::size_t k = j + 1; k < n; ++k) chosen.push_back({i, j, k});
      }
    }
    return chosen;
  }
  constexpr std::size_t kTrials = 300;  // if half of the pairs are wrong, one triple in eight is correct
  Random random;
  while (chosen.size() < kTrials) {
    const Triple t{random.below(n), random.below(n), random.below(n)};
    if (t[0] != t[1] && t[0] != t[2] && t[1] != t[2]) chosen.push_back(t);
  }
  return chosen;
}

}  // namespace

std::optional<PairsPlane> plane_through(std::span<const PointPair> pairs) {
  if (pairs.size() <= 4) {
    const auto plane = least_squares(pairs);
    if (!plane) return std::nullopt;
    return PairsPlane{*plane, {pairs.begin(), pairs.end()}};
  }
  std::optional<PairsPlane> best;
  for (const auto& [i, j, k] : triples(pairs.size())) {
    const std::array sample{pairs[i], pairs[j], pairs[k]};
    const auto through = least_squares(sample);
    if (!through) continue;
    auto agree = agreeing(*through, pairs);
    if (agree.size() < 3 || (best && agree.size() < best->pairs.size())) continue;
    const auto plane = least_squares(agree);
    if (!plane) continue;
    PairsPlane found{*plane, std::move(agree)};
    if (best && found.pairs.size() == best->pairs.size() && mean_square(found) >= mean_square(*best))
      continue;
    best = std::move(found);
  }
  return best;
}

}  // namespace cairn
