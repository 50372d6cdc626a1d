// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/tuning/measure_frames.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cairn {

struct TuneConfig {
  std::vector<std::string> options{};  // patterns as tunables() takes them; none: a sensible choice
  double budget_s = 60;                // the start is measured to its end all the same
  int evaluations = 0;                 // at most; 0 = as many as the budget allows
  double holdout = 0;                  // 0 … 0.9: share of the frames that only judge the result
  std::uint32_t seed = 1;              // which frames these are, and in which order options are tried
};

/// How far a search has come.
struct TuneProgress {
  TuningGoal goal = TuningGoal::objects;
  int evaluations = 0;  // that are done
  double seconds = 0;
  double share = 0;                // 0 … 1: of the budget, or of the evaluations
  std::optional<double> before{};  // the mean loss of the start; known after the first evaluation
  std::optional<double> best{};    // of the best so far
};

struct TuneHooks {
  /// Whether to end and keep the best so far; asked between frames, on any thread, the calling one among
  /// them.
  std::function<bool()> stop{};
  /// Told before each evaluation, on the calling thread.
  std::function<void(const TuneProgress&)> progress{};
};

enum class TuneEnd : std::uint8_t {
  converged,    // nothing near the best is better
  evaluations,  // as many as asked for
  time,         // the budget is used up
  interrupted   // TuneHooks::stop said so
};

/// What a search found, measured on the frames that it was tuned on and on those held out (none without).
struct Tuning {
  TuningGoal goal = TuningGoal::objects;
  bool sequence = false;                // most frames follow each other: the end of them is held out
  std::vector<bool> held_out;           // by frame
  std::vector<Tunable> tunables;        // what was searched
  std::vector<std::string> not_judged;  // asked for, but they change nothing that can be judged
  SearchResult search;
  std::vector<FrameMeasure> before;  // of the start; empty where it was interrupted before that was known
  std::vector<FrameMeasure> after;   // of the best
  std::vector<FrameMeasure> held_out_before;
  std::vector<FrameMeasure> held_out_after;
  double seconds = 0;
  TuneEnd end = TuneEnd::converged;
  std::string kept_because;  // why the start is kept; empty where it is not

  /// What to use: the best, or the start where that is kept.
  [[nodiscard]] const std::vector<Setting>& settings() const;
};

/// Searches the options that do best on these frames, from the configuration that they have in common on
/// (what a calibration says of a frame stays the frame's). The start is kept unless the best is better by 1 %
/// of the loss and by more than chance, and no worse on the frames held out. The same number of evaluations
/// gives the same result, whatever the threads. Throws Error: no frames, a frame that its configuration does
/// not fit, options that nothing here judges, one frame to be shared out, nothing that can be scored.
/// (docs/tune.md)
Tuning tune(const std::vector<TuningFrame>& frames, const TuneConfig& config, const Exec& exec,
            const TuneHooks& hooks = {});

}  // namespace cairn
