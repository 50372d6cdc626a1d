// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/pipeline/config.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cairn::report {

/// One row of the accuracy table: the preset `default` with one thing undone.
struct Ablation {
  std::string_view settings;  // options apart by blanks, as --set takes them; "input=grey": without colour
  std::string_view meaning;
};

/// To add a row, add a line. What the presets disagree on comes by itself: see all_ablations().
inline constexpr std::array kAblations{
    Ablation{"match.method=window", "paper: each pixel's window decides alone"},
    Ablation{"semi_global.penalty_edge=0", "a step costs the same at intensity edges"},
    Ablation{"subpixel.method=parabola", "paper: the parabola through three costs"},
    Ablation{"subpixel.enabled=false", "whole pixels"},
    Ablation{"left_right.max_diff=1", "paper: 1 px"},
    Ablation{"left_right.max_diff=-1", "no left-right check"},
    Ablation{"left_right.method=vote", "OpenCV's left-right check"},
    Ablation{"uniqueness.ratio=5", "paper: the check is on"},
    Ablation{"flatness.threshold=0.1", "paper: the check is on"},
    Ablation{"texture.threshold=1", "paper: the check is on"},
    Ablation{"ground.source=off", "no ground: reflections stay, the floor is a surface like others"},
    Ablation{"ground.label_floor=false", "paper: no floor label"},
    Ablation{"speckle.size=-1", "paper: speckles stay"},
    Ablation{"evidence.noise_factor=0 evidence.gradient_min=0", "every pixel counts as evidence"},
    Ablation{"evidence.agreement=100", "evidence need not agree with its neighbours"},
    Ablation{"background.max_walls=0", "the floor is the only background"},
    Ablation{"background.min_share_square=100", "walls are not looked for by squareness"},
    Ablation{"background.max_behind=100", "walls may have as much behind them as on them"},
    Ablation{"input=grey", "pictures without their colour"},
    Ablation{"facets.noise_factor=0", "edges are not measured against the noise"},
    Ablation{"facets.contrast_share=0", "the limit does not follow the picture's contrast"},
    Ablation{"facets.edge_min=0", "only the noise says what an edge is"},
    Ablation{"figure.margin=0", "figure need not stand clear of the background"},
    Ablation{"figure.agreement=0", "plain stretches are bridged by nothing"},
    Ablation{"figure.longest_bridge=100", "bridges of any length"},
    Ablation{"figure.border_weight=1", "what is seen beside a border counts as much as any"},
    Ablation{"figure.skirting=0", "stretches are bridged along the foot of a wall, too"},
    Ablation{"figure.smoothness=0", "each facet decides alone"},
    Ablation{"figure.colour_weight=0", "colour says nothing"},
    Ablation{"figure.continuation_weight=0", "ground that goes on beside says nothing"},
    Ablation{"figure.largest_part=0", "parts of an object that pass for ground speak for their colour"},
    Ablation{"group.step=1000", "steps of disparity part no objects"},
    Ablation{"group.deviation=1000", "planes part no objects"},
    Ablation{"group.step_share=0 group.deviation_share=0", "the same tolerance near and far"},
    Ablation{"group.gap_share=100", "facets without evidence connect, too"},
    Ablation{"group.occluded_gap=0", "what a nearer object parts stays apart"},
    Ablation{"group.min_area=0", "small groups stay by themselves"},
    Ablation{"fusion.method=overlap", "paper: the two segmentations and their overlap"},
    Ablation{"objects.min_confidence=0", "paper: whatever is left is an object"},
    Ablation{"objects.min_area=0.1", "paper: smaller objects, too"},
};

/// The preset `default` with an ablation's options set, and whether its input keeps its colour.
struct AblatedConfig {
  Config config;
  bool grey = false;
};

/// Throws Error as set() does.
inline AblatedConfig ablated(std::string_view settings) {
  AblatedConfig result;
  std::istringstream words{std::string(settings)};
  for (std::string word; words >> word;) {
    if (word == "input=grey") {
      result.grey = true;
      continue;
    }
    const std::size_t equals = std::min(word.find('='), word.size());
    set(result.config, std::string_view(word).substr(0, equals),
        std::string_view(word).substr(std::min(equals + 1, word.size())));
  }
  return result;
}

/// Settings and meaning of kAblations and, behind them, of every option on which the presets disagree and
/// that no row of it sets.
inline std::vector<std::pair<std::string, std::string>> all_ablations() {
  std::vector<std::pair<std::string, std::string>> all;
  std::string named = " ";
  for (const Ablation& row : kAblations) {
    all.emplace_back(row.settings, row.meaning);
    named += std::string(row.settings) + " ";
  }
  const auto ours = options(Config{});
  const auto paper = options(Config::paper());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const std::string& name = ours[i].name;
    // `default` runs neither of the paper's two segmentations: nothing of theirs would show.
    const bool runs = !name.starts_with("intensity.") && !name.starts_with("disparity.");
    if (ours[i].value == paper[i].value || !runs || named.find(" " + name + "=") != std::string::npos)
      continue;
    all.emplace_back(name + "=" + paper[i].value, "paper");
  }
  return all;
}

}  // namespace cairn::report
