// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "tune_sequence.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/tuning/search.hpp>
#include <chrono>
#include <iostream>
#include <limits>

#include "source_options.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxFrames = 300;  // held in memory
constexpr std::size_t kMinFrames = 10;
/// A smaller gain, or one below two standard errors, does not count.
constexpr Margin kMinGain{.least_share = 0.05, .standard_errors = 2};

struct SteadinessRun {
  std::vector<float> frames;  // for each frame but the first
  [[nodiscard]] double mean(std::size_t first, std::size_t last) const {
    double sum = 0;
    for (std::size_t i = first; i < last; ++i) sum += double{frames[i]};
    return last > first ? sum / static_cast<double>(last - first) : 0;
  }
};

std::string text(double steadiness) {
  return text_of("%.3f", steadiness);
}

std::vector<input::SequenceFrame> held_frames(input::Sequence& source, const std::string& name) {
  std::vector<input::SequenceFrame> frames;
  while (frames.size() < kMaxFrames) {
    std::optional<input::SequenceFrame> frame = source.next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  if (frames.size() < kMinFrames) {
    throw Error(name + ": has " + std::to_string(frames.size()) + " frames, expected " +
                std::to_string(kMinFrames) + " or more to judge steadiness");
  }
  return frames;
}

/// The steadiness of the frames tuned on and of those held out.
struct Comparison {
  SteadinessRun before;
  SteadinessRun best;
  std::size_t tuned_on = 0;
  [[nodiscard]] std::size_t count() const { return before.frames.size(); }
  [[nodiscard]] bool is_luck() const {
    return tuned_on < count() && best.mean(tuned_on, count()) < before.mean(tuned_on, count());
  }
  [[nodiscard]] const std::vector<Setting>& kept(const SearchResult& found) const {
    return is_luck() ? found.start : found.best;
  }
};

void print(const Comparison& runs, const SearchResult& found) {
  std::cout << "steadiness: " << text(runs.before.mean(0, runs.tuned_on)) << " before, "
            << text(runs.best.mean(0, runs.tuned_on)) << " after";
  if (runs.tuned_on < runs.count()) {
    std::cout << "; of the frames held out " << text(runs.before.mean(runs.tuned_on, runs.count())) << ", "
              << text(runs.best.mean(runs.tuned_on, runs.count()));
  }
  std::cout << "\n";
  const std::vector<Setting>& kept = runs.kept(found);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == found.start[i]) continue;
    std::cout << "  " << kept[i].option << ": " << found.start[i].value << " -> " << kept[i].value << "\n";
  }
  if (runs.is_luck()) {
    std::cout << "The options are unchanged: the best found is worse on the frames held out.\n";
  } else if (kept == found.start) {
    std::cout << "The options are unchanged: no other setting is clearly steadier.\n";
  }
}

SearchConfig search_config(const TuneSequenceOptions& options, const std::vector<Tunable>& tried,
                           const Config& start) {
  SearchConfig config;
  config.seed = options.seed;
  config.margin = kMinGain;
  if (options.evaluations > 0) config.evaluations = options.evaluations;
  config.is_read = [&](const std::vector<Setting>& settings, std::size_t i) {
    const std::vector<OptionInfo> active = active_options(with_settings(start, settings));
    return std::any_of(active.begin(), active.end(),
                       [&](const OptionInfo& option) { return option.name == tried[i].name; });
  };
  return config;
}

/// Runs of the sequence with different settings.
class SequenceTrials {
 public:
  SequenceTrials(const std::vector<input::SequenceFrame>& frames, const FollowConfig& start,
                 const std::optional<StereoRig>& rig, const Exec& exec, double seconds,
                 const std::function<bool()>& stop)
      : frames_(frames), start_(start), rig_(rig), exec_(exec), limit_s_(seconds), stop_(stop) {}

  /// nullopt if the time is up or the user stopped; without frames if the settings were refused.
  std::optional<SteadinessRun> operator()(const std::vector<Setting>& settings) {
    FollowConfig config = start_;
    config.segmentation = with_settings(start_.segmentation, settings);
    Follower follower(config, rig_, exec_);
    SteadinessRun steady;
    for (const input::SequenceFrame& frame : frames_) {
      if (stop_() || (tried_ > 0 && seconds() > limit_s_)) {
        is_up_ = true;
        return std::nullopt;
      }
      try {
        const TrackedFrame step = follower.next(input::pair_of(frame), frame.stamp);
        if (step.index > 0) steady.frames.push_back(step.reliability.steadiness);
      } catch (const Error&) {  // settings that contradict each other or the images
        if (tried_ == 0) throw;
        steady.frames.clear();
        break;
      }
    }
    ++tried_;
    return steady;
  }

  [[nodiscard]] int tried() const { return tried_; }
  [[nodiscard]] bool is_up() const { return is_up_; }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - began_).count();
  }

 private:
  const std::vector<input::SequenceFrame>& frames_;
  const FollowConfig& start_;
  const std::optional<StereoRig>& rig_;
  const Exec& exec_;
  double limit_s_;
  const std::function<bool()>& stop_;
  Clock::time_point began_ = Clock::now();
  int tried_ = 0;
  bool is_up_ = false;
};

void write(const Comparison& runs, const SearchResult& found, const ResolvedConfig& base,
           const std::string& file) {
  const double reference = runs.before.mean(0, runs.tuned_on);
  const double after = runs.is_luck() ? reference : runs.best.mean(0, runs.tuned_on);
  io::write_file(
      file, "# Written by cairn tune --sequence: steadiness " + text(reference) + " before, " + text(after) +
                " after.\n" +
                io::changed_config_yaml(base.preset, with_settings(base.config, runs.kept(found))));
  std::cout << "wrote " << file << ", for --config\n";
}

}  // namespace

int tune_sequence(const TuneSequenceOptions& options, const std::function<bool()>& stop) {
  SourceInput input;
  input.source = options.source;
  input.options.calib = options.calib;
  const Exec exec = make_exec(options.exec);
  const auto source = open_source(input, exec.pool, options.config);
  FollowConfig start;
  const ResolvedConfig base = resolve(options.config);  // without options from the calibration
  start.segmentation = resolve(options.config, source->disparities()).config;
  start.segmentation.ground.known = source->ground();
  validate(start);

  const std::vector<input::SequenceFrame> frames = held_frames(*source, options.source);
  const double share = options.holdout.value_or(0.25);
  const std::size_t count = frames.size() - 1;  // the first frame has no predecessor
  const auto tuned_on = count - static_cast<std::size_t>(share * static_cast<double>(count));

  const Progress progress(frames.size());
  const std::optional<StereoRig> rig = source->rig();
  SequenceTrials run(frames, start, rig, exec, options.seconds, stop);
  const std::vector<Tunable> options_tried =
      tunables(options.patterns.empty() ? usual_tunables(start.segmentation, true) : options.patterns,
               start.segmentation);
  const std::vector<Setting> from = settings_of(start.segmentation, options_tried);
  const std::optional<SteadinessRun> before = run(from);
  if (!before) throw Error(options.source + ": stopped before the first run ended; nothing is written");
  const double reference = before->mean(0, tuned_on);
  SteadinessRun best = *before;
  SteadinessRun latest = *before;
  // The loss falls as steadiness rises, from 1 + reference at the start to 1 + 2 · reference if nothing is steady.
  // It is infinite for settings that were refused.
  const auto losses = [&](const SteadinessRun& steady) {
    std::vector<Loss> all(tuned_on, Loss{std::numeric_limits<double>::infinity(), 1, 0});
    for (std::size_t i = 0; i < tuned_on && !steady.frames.empty(); ++i)
      all[i].sum = 1 + 2 * reference - double{steady.frames[i]};
    return all;
  };
  const SearchResult found = search(
      options_tried, from,
      [&](const std::vector<Setting>& settings) -> std::optional<std::vector<Loss>> {
        progress.bar(std::min(1.0, run.seconds() / options.seconds),
                     std::to_string(run.tried()) + " tried, steadiness " + text(best.mean(0, tuned_on)) +
                         " (was " + text(reference) + ")");
        std::optional<SteadinessRun> steady = settings == from ? before : run(settings);
        if (!steady) return std::nullopt;
        latest = std::move(*steady);
        return losses(latest);
      },
      search_config(options, options_tried, start.segmentation),
      [&](const std::vector<Setting>&) { best = latest; });
  progress.clear();

  const Comparison runs{*before, best, tuned_on};
  std::cout << count_of(frames.size(), "frame") << ", " << count_of(options_tried.size(), "option") << ", "
            << run.tried() << " runs in " << text_of("%.1f s", run.seconds())
            << (run.is_up() ? ", stopped\n" : "\n");
  print(runs, found);
  write(runs, found, base, options.output);
  return 0;
}

}  // namespace cairn::cli
