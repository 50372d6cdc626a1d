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
  std::vector<std::string> options{};  // patterns for tunables(); none: usual_tunables()
  double budget_s = 60;                // the start is measured in any case
  int evaluations = 0;                 // at most; 0 = limited by the budget only
  double holdout = 0;                  // 0 … 0.9: share of the frames used for validation only
  std::uint32_t seed = 1;              // selects these frames and the order of the options
};

/// The progress of a search.
struct TuneProgress {
  TuningGoal goal = TuningGoal::objects;
  int evaluations = 0;  // completed
  double seconds = 0;
  double share = 0;                // 0 … 1: used share of the budget, or of the evaluations
  std::optional<double> before{};  // mean loss of the start; known after the first evaluation
  std::optional<double> best{};    // mean loss of the best so far
};

struct TuneHooks {
  /// Returns true to end the search and keep the best so far; called between frames, on any thread, including
  /// the calling one.
  std::function<bool()> stop{};
  /// Called before each evaluation, on the calling thread.
  std::function<void(const TuneProgress&)> progress{};
};

enum class TuneEnd : std::uint8_t {
  converged,    // no neighbour of the best is better
  evaluations,  // the limit is reached
  time,         // the budget is exhausted
  interrupted   // by TuneHooks::stop
};

/// The result of a search, measured on the frames it was tuned on and on those held out.
struct Tuning {
  TuningGoal goal = TuningGoal::objects;
  bool sequence = false;                // most frames are consecutive: the end is held out
  std::vector<bool> held_out;           // by frame
  std::vector<Tunable> tunables;        // the options searched
  std::vector<std::string> not_judged;  // requested, but without effect on the loss
  SearchResult search;
  std::vector<FrameMeasure> before;  // of the start; empty if interrupted earlier
  std::vector<FrameMeasure> after;   // of the best
  std::vector<FrameMeasure> held_out_before;
  std::vector<FrameMeasure> held_out_after;
  double seconds = 0;
  TuneEnd end = TuneEnd::converged;
  std::string kept_because;  // why the start is kept; empty if it is not

  /// The recommended settings: the best, or the start if it is kept.
  [[nodiscard]] const std::vector<Setting>& settings() const;
};

/// Searches for the options that do best on these frames, starting from their common configuration (values
/// from the calibration of a frame are kept). The start is kept unless the best is better by 1 % of the loss
/// and significantly so, and no worse on the frames held out. The same number of evaluations gives the same
/// result for any number of threads. Throws Error: no frames, a frame that does not suit its configuration,
/// only options without effect on the loss, a single frame to be split, nothing that can be scored.
/// (docs/tune.md)
Tuning tune(const std::vector<TuningFrame>& frames, const TuneConfig& config, const Exec& exec,
            const TuneHooks& hooks = {});

}  // namespace cairn
