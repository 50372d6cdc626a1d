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
  /// Options apart by blanks, as --set takes them; "input=grey": without colour; "preset=paper", which must
  /// be first: of that preset.
  std::string_view settings;
  std::string_view meaning;
};

/// The preset `paper` with neither floor label nor threshold of a gradient: the printed text has none of
/// them.
inline constexpr Ablation kAsPrinted{
    "preset=paper ground.label_floor=false intensity.gradient_threshold=0 disparity.gradient_threshold=0",
    "as printed"};

/// To add a row, add a line. What the presets disagree on comes by itself: see all_ablations().
inline constexpr std::array kAblations{
    Ablation{"match.method=window", "paper: matching of windows"},
    Ablation{"semi_global.penalty_edge=0", "a step costs the same at intensity edges"},
    Ablation{"subpixel.method=parabola", "paper: the parabola through three costs"},
    Ablation{"subpixel.enabled=false", "whole pixels"},
    Ablation{"left_right.max_diff=1", "paper: 1 px"},
    Ablation{"left_right.max_diff=-1", "no left-right check"},
    Ablation{"left_right.method=vote", "OpenCV's left-right check"},
    Ablation{"uniqueness.ratio=10", "paper: the check is on"},
    Ablation{"flatness.threshold=0.1", "paper: the check is on"},
    Ablation{"texture.threshold=2", "paper: the check is on"},
    Ablation{"ground.source=off", "no ground: reflections stay, the floor is an ordinary surface"},
    Ablation{"ground.label_floor=false", "as printed: no floor label"},
    Ablation{"speckle.size=-1", "paper: speckles stay"},
    Ablation{"evidence.gradient_min=0", "only the noise decides which disparities are textured"},
    Ablation{"background.max_walls=0", "the floor is the only background"},
    Ablation{"input=grey", "images without colour"},
    Ablation{"superpixels.count=125", "half as many superpixels"},
    Ablation{"superpixels.count=500", "twice as many superpixels"},
    Ablation{"fusion.method=overlap", "paper: the two segmentations and their overlap"},
    Ablation{"objects.min_confidence=0", "paper: every remaining region is an object"},
    Ablation{"objects.min_area=0.5", "paper"},
};

/// The preset with an ablation's options set, and whether its input keeps its colour.
struct AblatedConfig {
  Config config;
  bool grey = false;
};

/// Throws Error as set() does.
inline AblatedConfig ablated(std::string_view settings) {
  AblatedConfig result;
  std::istringstream words{std::string(settings)};
  for (std::string word; words >> word;) {
    if (word == "preset=paper") {
      result.config = Config::paper();
      continue;
    }
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
    if (ours[i].value == paper[i].value || !ours[i].active ||
        named.find(" " + name + "=") != std::string::npos)
      continue;
    all.emplace_back(name + "=" + paper[i].value, "paper");
  }
  return all;
}

}  // namespace cairn::report
