// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/tuning/tune.hpp>
#include <cstdint>
#include <string>
#include <vector>

/// What `cairn tune --json` writes (docs/formats.md); Python has the same.
namespace cairn::output {

using Measures = std::vector<FrameMeasure>;

/// "mean E", "bad disparities", "contradictions".
std::string goal_word(TuningGoal goal);

/// One number of many frames.
struct TuningFigure {
  std::string key;   // in JSON
  std::string name;  // on the terminal
  double value = 0;
  bool is_share = true;
};
/// The loss first; none without frames.
std::vector<TuningFigure> tuning_figures(const Measures& measures, TuningGoal goal);

/// An object of all that was found. `names`: of the frames.
std::string tuning_json(const Tuning& tuned, const std::vector<std::string>& names, std::uint32_t seed);

}  // namespace cairn::output
