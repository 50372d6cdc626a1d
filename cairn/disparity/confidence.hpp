// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/matching/match.hpp>

namespace cairn {

/// What each sign of a good or bad match counts: the logarithm of the odds that a disparity is within 1 px of
/// the truth is bias + Σ weight · sign.
struct ConfidenceModel {
  float bias = 0;
  float margin = 0;  // (runner_up − cost) / mean_cost, 0 … 1; 1 without runner-up
  float cost = 0;    // cost / mean_cost, 0 … 1
  float jumps = 0;   // root of the share of pixels around that differ from a neighbour by more than 1 px
  float holes = 0;   // root of the share of pixels around without disparity
};

/// The numbers for the costs of a method, fitted to the rendered development frames by
/// benchmarks/confidence_study.cpp.
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

/// Side of the square window that jumps and holes are counted in, clipped at the image's border, px.
inline constexpr int kConfidenceWindow = 13;

/// How likely each disparity is within 1 px of the truth, 0 … 1; 0 where there is none. It is a logistic
/// function of four signs (ConfidenceModel) which the matching and the checks leave behind: no cost is
/// computed anew. A pixel is a jump where its disparity and that of the pixel to the right or below differ by
/// more than 1 px. Empty where `matches` lacks runner-up or mean (MatchMaps::full has both). (beyond the
/// paper)
Image<float> estimate_confidence(const Matches& matches, const DisparityMap& disparity,
                                 const ConfidenceModel& model, const Exec& exec);

}  // namespace cairn
