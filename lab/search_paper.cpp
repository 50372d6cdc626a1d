// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Searches the thresholds of the preset `paper` (Config::paper()) on the fit set.
//   search_paper DATA [--threads N] [--draws N] [--rounds N] [--report] [OPTION=VALUE]...
// The search and its score: search_program.hpp. The method remains the published one: no semi-global
// matching, no walls, no colour, no filter by confidence.
#include <cairn/cairn.hpp>
#include <cstdio>
#include <exception>

#include "search_program.hpp"

namespace cairn::lab {
namespace {

std::vector<Knob> knobs() {
  return {
      {"intensity.gradient_threshold", {"0", "1", "2", "3", "4", "6"}},
      {"disparity.mean_difference_max", {"0.5", "0.75", "1", "1.5", "2"}},
      {"disparity.deviation_max", {"0.5", "0.75", "1", "1.5"}},
      {"objects.min_area", {"0.1", "0.3", "0.5", "1"}},
      {"disparity.gradient_threshold", {"0", "0.125", "0.25", "0.5", "1"}},
      {"texture.threshold", {"1", "2", "3", "5"}},
      {"uniqueness.ratio", {"-1", "2", "5", "10"}},
      {"ground.margin", {"0.75", "1", "1.5"}},
      {"intensity.mean_difference_max", {"2", "3", "5", "8"}},
      {"match.window_size", {"7", "9", "11", "13"}},
      {"left_right.max_diff", {"1", "2"}},
      {"flatness.threshold", {"-1", "0.05", "0.1", "0.2"}},
      {"intensity.deviation_max", {"0.5", "1", "1.5"}},
  };
}

std::string value_of(const Config& config, const std::string& option) {
  for (const OptionInfo& info : options(config)) {
    if (info.name == option) return info.value;
  }
  return {};
}

SearchProgram search_paper() {
  SearchProgram program{"search_paper", knobs(), {}, {}};
  for (const Knob& knob : program.knobs) program.start.push_back(value_of(Config::paper(), knob.option));
  program.score = [knobs = program.knobs](const TrueFrame& frame, const Values& values, const Exec& exec) {
    Config config = Config::paper();
    for (std::size_t i = 0; i < knobs.size(); ++i) set(config, knobs[i].option, values[i]);
    return score(frame, config, true, exec);
  };
  return program;
}

}  // namespace
}  // namespace cairn::lab

int main(int count, char** arguments) try {
  cairn::lab::run_search(cairn::lab::search_paper(), {arguments + 1, arguments + count});
} catch (const std::exception& error) {
  std::fprintf(stderr, "search_paper: %s\n", error.what());
  return 2;
}
