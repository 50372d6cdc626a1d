// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/tuning/tune.hpp>
#include <chrono>
#include <cmath>
#include <utility>

namespace cairn {
namespace {

using Clock = std::chrono::steady_clock;

/// A smaller gain is not worth a configuration of its own.
constexpr Margin kMinGain{.least_share = 0.01};

// ---- options and frames ----

void check(const std::vector<TuningFrame>& frames, const TuneConfig& config) {
  if (frames.empty()) throw Error("frames: found none, expected one or more to tune on");
  if (!(config.budget_s > 0)) {
    throw Error("budget_s: found " + std::to_string(config.budget_s) + ", expected seconds > 0");
  }
  if (config.evaluations < 0) {
    throw Error("evaluations: found " + std::to_string(config.evaluations) +
                ", expected 0 or more; 0 = no limit");
  }
  if (!(config.holdout >= 0 && config.holdout <= 0.9)) {
    throw Error("holdout: found " + std::to_string(config.holdout) + ", expected a share of 0 … 0.9");
  }
  for (const TuningFrame& frame : frames) {
    try {
      validate(frame.config, frame.pair.size(), frame.rig.has_value());
    } catch (const Error& error) {
      throw Error("frame " + frame.name + ": " + error.what());
    }
  }
}

bool mostly_sequence(const std::vector<TuningFrame>& frames) {
  const auto following = std::count_if(frames.begin(), frames.end(), [](const auto& f) { return f.follows; });
  return frames.size() > 1 && 2 * following > static_cast<std::ptrdiff_t>(frames.size()) - 1;
}

void choose_tunables(const std::vector<std::string>& wanted, const Config& start, Tuning& tuning) {
  const bool objects = tuning.goal == TuningGoal::objects;
  std::vector<std::string> patterns = wanted.empty() ? usual_tunables(start, objects) : wanted;
  // Consistency cannot judge it: false islands agree with the right image, so the search would let them pass.
  if (wanted.empty() && tuning.goal == TuningGoal::consistency) std::erase(patterns, "speckle.size");
  tuning.tunables = tunables(patterns, start);
  if (objects) return;
  const auto judged = std::stable_partition(tuning.tunables.begin(), tuning.tunables.end(),
                                            [](const Tunable& t) { return changes_disparities(t.name); });
  for (auto t = judged; t != tuning.tunables.end(); ++t) tuning.not_judged.push_back(t->name);
  tuning.tunables.erase(judged, tuning.tunables.end());
  if (tuning.tunables.empty()) {
    throw Error("options " + wanted.front() +
                ": has no effect on disparities, and nothing else can be judged without true objects");
  }
}

/// Frames with the same name show the same scene, so they stay on one side of the split.
std::vector<bool> frames_held_out(const std::vector<TuningFrame>& frames, const TuneConfig& config,
                                  bool sequence) {
  std::vector<bool> out(frames.size(), false);
  if (config.holdout <= 0) return out;
  std::vector<std::string> names;
  for (const TuningFrame& frame : frames) {
    if (std::find(names.begin(), names.end(), frame.name) == names.end()) names.push_back(frame.name);
  }
  if (names.size() < 2) throw Error("holdout: found one frame, expected two or more to split");
  const std::vector<bool> drawn =
      held_out(static_cast<int>(names.size()), config.holdout, sequence, config.seed);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto name = std::find(names.begin(), names.end(), frames[i].name);
    out[i] = drawn[static_cast<std::size_t>(name - names.begin())];
  }
  return out;
}

Tuning prepared(const std::vector<TuningFrame>& frames, const TuneConfig& config) {
  check(frames, config);
  const Config& start = frames.front().config;
  Tuning tuning;
  tuning.goal = goal_of(frames);
  tuning.sequence = mostly_sequence(frames);
  tuning.held_out = frames_held_out(frames, config, tuning.sequence);
  choose_tunables(config.options, start, tuning);
  return tuning;
}

/// The reason to keep the starting settings; empty if the result is better.
std::string reason_to_keep(const Tuning& tuning) {
  const SearchResult& s = tuning.search;
  if (s.best == s.start || !clearly_better(s.start_losses, s.best_losses, kMinGain)) {
    return "no other setting is better by " + std::to_string(std::lround(100 * kMinGain.least_share)) +
           " % and significantly so";
  }
  const double before = mean_loss(losses_of(tuning.held_out_before));
  const double after = mean_loss(losses_of(tuning.held_out_after));
  if (!tuning.held_out_before.empty() && std::isfinite(before) && after > before)
    return "the best found is worse on the frames held out";
  return {};
}

// ---- the search ----

/// The state of a tuning run.
class TuningRun {
 public:
  TuningRun(const std::vector<TuningFrame>& frames, const TuneConfig& config, const Exec& exec,
            const TuneHooks& hooks)
      : frames_(frames),
        config_(config),
        hooks_(hooks),
        threads_(exec.threads()),
        target_(exec.target),
        matched_(frames.size()),
        tuning_(prepared(frames, config)),
        tuned_on_(tuning_.held_out) {
    tuned_on_.flip();
  }

  Tuning to_its_end() {
    SearchConfig search_config;
    search_config.seed = config_.seed;
    if (config_.evaluations > 0) search_config.evaluations = config_.evaluations;
    search_config.is_read = [&](const std::vector<Setting>& settings, std::size_t i) {
      return is_read(settings, tuning_.tunables[i].name);
    };
    // Calibrations may change options per frame, so the search starts from the options common to all frames.
    const std::vector<Setting> start = settings_of(frames_.front().config, tuning_.tunables);
    tuning_.search = search(
        tuning_.tunables, start, [&](const auto& settings) { return measure(settings); }, search_config,
        [&](const auto& settings) { keep(settings); });
    tuning_.seconds = seconds();
    tuning_.end = end();
    if (knows_start()) tuning_.kept_because = reason_to_keep(tuning_);
    return std::move(tuning_);
  }

 private:
  [[nodiscard]] bool is_read(const std::vector<Setting>& settings, const std::string& name) const {
    const std::vector<OptionInfo> read = active_options(with_settings(frames_.front().config, settings));
    return std::any_of(read.begin(), read.end(),
                       [&](const OptionInfo& option) { return option.name == name; });
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - start_time_).count();
  }
  [[nodiscard]] bool knows_start() const { return !tuning_.before.empty(); }
  [[nodiscard]] bool holds_out() const {
    return std::find(tuning_.held_out.begin(), tuning_.held_out.end(), true) != tuning_.held_out.end();
  }

  [[nodiscard]] TuneEnd end() const {
    if (interrupted_) return TuneEnd::interrupted;
    switch (tuning_.search.end) {
      case SearchEnd::converged:
        return TuneEnd::converged;
      case SearchEnd::evaluations:
        return TuneEnd::evaluations;
      case SearchEnd::stopped:
        break;
    }
    return TuneEnd::time;
  }

  bool is_to_stop() {
    if (hooks_.stop && hooks_.stop()) interrupted_ = true;
    return interrupted_ || (knows_start() && seconds() > config_.budget_s);
  }

  std::optional<std::vector<FrameMeasure>> measured(const std::vector<bool>& chosen,
                                                    const std::vector<Setting>& settings,
                                                    std::function<bool()> stop) {
    return measure_frames(frames_, chosen, settings, {tuning_.goal, threads_, target_, std::move(stop)},
                          matched_);
  }

  std::optional<std::vector<Loss>> measure(const std::vector<Setting>& settings) {
    if (hooks_.progress) hooks_.progress(progress());
    auto measures = measured(tuned_on_, settings, [this] { return is_to_stop(); });
    if (!measures) return std::nullopt;
    ++tried_;
    latest_ = std::move(*measures);
    return losses_of(latest_);
  }

  /// Records the settings that were just measured as the best so far.
  void keep(const std::vector<Setting>& settings) {
    const bool is_start = !knows_start();
    if (is_start && !std::isfinite(mean_loss(losses_of(latest_))))
      throw Error("the truth of the frames to tune on contains nothing that can be scored");
    tuning_.after = latest_;
    if (holds_out()) tuning_.held_out_after = *measured(tuning_.held_out, settings, {});
    if (!is_start) return;
    tuning_.before = tuning_.after;
    tuning_.held_out_before = tuning_.held_out_after;
  }

  [[nodiscard]] TuneProgress progress() const {
    TuneProgress now{tuning_.goal, tried_, seconds(), seconds() / config_.budget_s, {}, {}};
    if (config_.evaluations > 0)
      now.share = std::max(now.share, static_cast<double>(tried_) / config_.evaluations);
    now.share = std::min(now.share, 1.0);
    if (knows_start()) {
      now.before = mean_loss(losses_of(tuning_.before));
      now.best = mean_loss(losses_of(tuning_.after));
    }
    return now;
  }

  const std::vector<TuningFrame>& frames_;
  const TuneConfig& config_;
  const TuneHooks& hooks_;
  int threads_;
  Target target_;
  Clock::time_point start_time_ = Clock::now();
  std::vector<MatchResult> matched_;
  Tuning tuning_;
  std::vector<bool> tuned_on_;
  std::vector<FrameMeasure> latest_;
  int tried_ = 0;
  std::atomic<bool> interrupted_ = false;
};

}  // namespace

const std::vector<Setting>& Tuning::settings() const {
  return kept_because.empty() ? search.best : search.start;
}

Tuning tune(const std::vector<TuningFrame>& frames, const TuneConfig& config, const Exec& exec,
            const TuneHooks& hooks) {
  return TuningRun(frames, config, exec, hooks).to_its_end();
}

}  // namespace cairn
