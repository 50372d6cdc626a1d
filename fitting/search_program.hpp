// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "option_search.hpp"
#include "scored_frames.hpp"

/// What the programs share that choose a method's numbers on the fit set: frames, score, command line.
namespace cairn::report {

struct FrameSet {
  std::string name;
  std::vector<TrueFrame> frames;
};
/// Frames to choose on: dev, every third room of train, rc_tabletop.
std::vector<FrameSet> fit_sets(const std::filesystem::path& data);
/// Frames to report only.
std::vector<FrameSet> validation_sets(const std::filesystem::path& data);

struct SearchProgram {
  std::string name;
  std::vector<Knob> knobs;
  Values start;
  std::function<Score(const TrueFrame& frame, const Values& values, const Exec& exec)> score;
};

/// Arguments: DATA [--threads N] [--draws N] [--rounds N] [--report] [OPTION=VALUE]...; --draws: so many settings drawn
/// at random first, and the search goes on from the best, which may be the start; --report only measures the start,
/// on both groups of frames. The score is the source's own measure, the mean of E over the objects of all frames
/// (200 % at most), less a penalty where less than a third of the objects found are right: E alone ignores what is
/// found besides. Prints each setting tried (of those drawn, only the ones better than all before), their number,
/// and the values kept. Throws Error.
void run_search(const SearchProgram& program, const std::vector<std::string>& arguments);

}  // namespace cairn::report
