// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "confidence.hpp"

#include <algorithm>
#include <cmath>

namespace cairn::reference {

std::array<double, 4> confidence_signs(const Matches& matches, View<const float> disparity_px, int x, int y) {
  const double mean = std::max(double{matches.mean_cost(x, y)}, 1e-6);
  const double cost = matches.cost(x, y);
  const double margin = std::min((double{matches.runner_up(x, y)} - cost) / mean, 1.0);
  double area = 0;
  double jumps = 0;
  double holes = 0;
  const auto differs = [&](int u, int v, int other_u, int other_v) {
    return disparity_px.contains(other_u, other_v) &&
           std::abs(disparity_px(u, v) - disparity_px(other_u, other_v)) > 1;
  };
  for (int v = y - kConfidenceWindow / 2; v <= y + kConfidenceWindow / 2; ++v) {
    for (int u = x - kConfidenceWindow / 2; u <= x + kConfidenceWindow / 2; ++u) {
      if (!disparity_px.contains(u, v)) continue;
      area += 1;
      holes += std::isnan(disparity_px(u, v)) ? 1 : 0;
      jumps += differs(u, v, u + 1, v) || differs(u, v, u, v + 1) ? 1 : 0;
    }
  }
  return {margin, std::min(cost / mean, 1.0), std::sqrt(jumps / area), std::sqrt(holes / area)};
}

Image<float> estimate_confidence(const Matches& matches, const DisparityMap& disparity,
                                 const ConfidenceModel& model) {
  Image<float> confidence(disparity.disparity_px.size(), 0.0F, {});
  for (int y = 0; y < confidence.height(); ++y) {
    for (int x = 0; x < confidence.width(); ++x) {
      if (std::isnan(disparity.disparity_px(x, y))) continue;
      const auto [margin, cost, jumps, holes] = confidence_signs(matches, disparity.disparity_px, x, y);
      const double log_odds = double{model.bias} + double{model.margin} * margin + double{model.cost} * cost +
                              double{model.jumps} * jumps + double{model.holes} * holes;
      confidence(x, y) = static_cast<float>(1 / (1 + std::exp(-log_odds)));
    }
  }
  return confidence;
}

}  // namespace cairn::reference
