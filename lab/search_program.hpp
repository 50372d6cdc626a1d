// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "option_search.hpp"
#include "scored_frames.hpp"

/// Shared by programs that choose parameters on the fit set: frames, score, command line.
namespace cairn::lab {

struct FrameSet {
  std::string name;
  std::vector<TrueFrame> frames;
};
/// The fit set: dev, every third room of train, rc_tabletop.
std::vector<FrameSet> fit_sets(const std::filesystem::path& data);
/// Frames for reporting only.
std::vector<FrameSet> validation_sets(const std::filesystem::path& data);
/// The yardstick, unless `yardstick` is empty, and the validation sets of kinds of things that no fit has.
std::vector<FrameSet> hard_sets(const std::filesystem::path& data, const std::filesystem::path& yardstick);

struct SearchProgram {
  std::string name;
  std::vector<Knob> knobs;
  Values start;
  std::function<Score(const TrueFrame& frame, const Values& values, const Exec& exec)> score;
};

/// Arguments: DATA [--threads N] [--draws N] [--rounds N] [--report] [OPTION=VALUE]...; --draws: number of
/// random settings to try first, after which the search continues from the best one, which may be the start;
/// --report only measures the start, on both groups of frames. The score is the paper's measure, the mean of
/// E over the objects of all frames (200 % at most), with a penalty if less than a third of the objects found
/// are right, since E alone ignores false objects. Prints each setting tried (random ones only if better than
/// all before), their number, and the values kept. Throws Error.
void run_search(const SearchProgram& program, const std::vector<std::string>& arguments);

}  // namespace cairn::lab
