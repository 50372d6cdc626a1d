// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cairn/stereo/match.hpp>

namespace cairn {

/// The weights of a logistic model: the log-odds that a disparity is within 1 px of the truth are bias + Σ
/// weight · feature.
struct ConfidenceModel {
  float bias = 0;
  float margin = 0;  // (runner_up − cost) / mean_cost, 0 … 1; 1 without runner-up
  float cost = 0;    // cost / mean_cost, 0 … 1
  float jumps = 0;   // root of the share of pixels in the window that differ from a neighbour by > 1 px
  float holes = 0;   // root of the share of pixels in the window without disparity
};

/// The model for the costs of a method, fitted to the rendered development frames by
/// `lab/studies.py confidence`.
constexpr ConfidenceModel confidence_model(MatchMethod method) {
  return method == MatchMethod::semi_global
             ? ConfidenceModel{.bias = 4.55F,
                               .margin = 0.82F,
                               .cost = -2.58F,
                               .jumps = -6.16F,
                               .holes = -3.89F}
             : ConfidenceModel{
                   .bias = 4.94F, .margin = 0.04F, .cost = 1.51F, .jumps = -9.82F, .holes = -5.72F};
}

/// Side of the square window for jumps and holes, clipped at the border of the image, px.
inline constexpr int kConfidenceWindow = 13;

/// The probability of each disparity to be within 1 px of the truth, 0 … 1; 0 in holes. A logistic function
/// of four features (ConfidenceModel) that matching and checks have already computed: no cost is computed
/// again. A pixel is a jump if its disparity differs by more than 1 px from that of the pixel to the right or
/// below. Empty if `matches` lacks runner-up or mean (MatchMaps::full has both). (beyond the paper)
Image<float> estimate_confidence(const Matches& matches, const DisparityMap& disparity,
                                 const ConfidenceModel& model, const Exec& exec);

/// The same, 0 where a disparity was rejected since. `confidence` may be empty.
Image<float> without_holes(Image<float> confidence, View<const Reject> reject);

}  // namespace cairn
