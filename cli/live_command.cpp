// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/live/looped.hpp>
#include <cairn/live/runner.hpp>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "interrupt.hpp"
#include "run_sinks.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

struct LiveCommandOptions {
  RunOptions run;
  bool has_config_option = false;  // --preset or --config was given
  bool every_frame = false;
  bool no_tracks = false;
  double max_age_ms = 200;
  bool has_max_age = false;  // --max-age was given
  double pace = 1;
  bool has_pace = false;  // --pace was given
  double duration_s = 0;
  bool loop = false;
};

/// Prints to stderr: findings about the rig and of the search for better options and, if it is a terminal, a status
/// line per second.
class StatusLine : public live::Sink {
 public:
  void offer(const live::LiveFramePtr& frame) override {
    if (frame->step.control) {
      progress_.clear();
      std::cerr << frame->pair->name << ": " << control_line(*frame->step.control) << "\n";
    }
    if (!frame->changes.empty()) {
      progress_.clear();
      std::cerr << changes_text(frame->pair->name, frame->changes);
    }
    if (frame->done - shown_ < std::chrono::seconds(1)) return;
    shown_ = frame->done;
    const std::string words =
        frame->pair->name + ": " + std::to_string(frame->step.frame.objects.list.size()) + " objects, " +
        text_of("%.1f Hz, ", frame->rate_hz) +
        text_of("%.0f ms from image to objects", live::ms_between(frame->arrived, frame->done)) +
        (frame->source.is_connected ? "" : ", NOT CONNECTED: " + frame->source.trouble);
    progress_.bar(0, words);
  }
  void finish() override { progress_.clear(); }

 private:
  Progress progress_{0};
  live::Clock::time_point shown_;
};

void check(const LiveCommandOptions& options) {
  const auto refuse = [](const std::string& option, double found, const std::string& expected) {
    throw Error(option + ": found " + text_of("%g", found) + ", expected " + expected);
  };
  if (!(options.max_age_ms >= 0 && options.max_age_ms <= 1e6))
    refuse("--max-age", options.max_age_ms, "ms, 0 ... 1e6 (0: pairs of any age)");
  if (options.has_max_age && options.every_frame)
    throw Error("--max-age: found --every-frame as well, with which no pair is dropped");
  if (!(options.pace >= 0 && options.pace <= 1000))
    refuse("--pace", options.pace, "0 ... 1000 times as fast (0: as fast as it goes)");
  if (!(options.duration_s >= 0 && options.duration_s <= 1e9))
    refuse("--duration", options.duration_s, "s, 0 ... 1e9 (0: until the source ends)");
  if (!options.no_tracks) return;
  const std::vector<std::string> needing = options.run.sensors.given();
  if (!needing.empty()) throw Error(needing.front() + ": found --no-tracks as well, but it needs tracks");
  if (!options.run.files.output.empty())
    throw Error("-o: found --no-tracks as well, but its files hold tracks");
}

std::string summary_text(const live::LiveSummary& summary) {
  std::string text = std::to_string(summary.frames) + " frames in " + text_of("%.1f s", summary.seconds);
  if (summary.frames > 0) {
    text += ", " + text_of("%.1f Hz", static_cast<double>(summary.frames) / summary.seconds) +
            "; from image to objects " + text_of("%.1f ms", summary.p50_ms) + " (p99 " +
            text_of("%.1f", summary.p99_ms) + ", at most " + text_of("%.1f", summary.max_ms) + ")";
  }
  text += "\n";
  const auto& [at_source, replaced, too_old] = summary.drops;
  if (at_source + replaced + too_old > 0) {
    text += "not processed: " + std::to_string(replaced) + " replaced by a newer pair, " +
            std::to_string(too_old) + " too old, " + std::to_string(at_source) + " lost at the source\n";
  }
  return text;
}

int live_command(LiveCommandOptions options) {
  check(options);
  RunOptions& run = options.run;
  check(run.files, run.source.source);
  const RecordedConfig recorded(run.source.source, run.config, options.has_config_option);
  check(run.view);
  const Exec exec = make_exec(run.exec);
  const auto open = [&] { return open_source(run.source, exec.pool, run.config); };
  const std::unique_ptr<input::Sequence> source = options.loop ? live::looped(open) : open();
  if (options.has_pace && source->status().is_live)
    throw Error("--pace: is for files, " + source->name() + " is a camera, which sets its own");
  const FollowConfig config = [&] {
    try {
      return resolve_follow(run.config, source->disparities(), source->ground());
    } catch (const Error& error) {
      throw Error(recorded.named(error.what()));
    }
  }();
  std::cerr << recorded.notice();
  const RunSinks* opened = nullptr;
  live::LiveOptions how;
  how.every_frame = options.every_frame;
  if (options.max_age_ms > 0) {
    how.max_age = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double, std::milli>(options.max_age_ms));
  }
  how.is_ended = [&opened] { return is_interrupted() || (opened != nullptr && opened->is_closed()); };
  how.tracks = !options.no_tracks;
  how.pace = options.pace;
  if (options.duration_s > 0) {
    how.duration = std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(options.duration_s));
  }
  live::Runner runner(*source, run.source.source, sensor_files(run.sensors, *source), config, how, exec);
  StatusLine console;
  RunSinks sinks(run, runner, *source, config, how.tracks, how.every_frame, console);
  opened = &sinks;
  const EndsBySignal ends(*source);
  catch_interrupts();
  sinks.begin();
  const live::LiveSummary summary = runner.run();
  std::cerr << remarks_text(*source) << summary_text(summary) << sinks.summary();
  return sinks.exit_code(*source);
}

}  // namespace

Work declare_live(CLI::App& app) {
  auto options = std::make_shared<LiveCommandOptions>();
  add_run_options(app, options->run);
  app.add_flag("--no-tracks", options->no_tracks, "single frames without tracking, as in cairn segment");
  app.add_flag("--every-frame", options->every_frame,
               "processing of every frame; default: a newer pair replaces a waiting one");
  app.add_option("--max-age", options->max_age_ms,
                 "largest age of a camera pair before it is dropped; 0: no limit")
      ->type_name("MS")
      ->capture_default_str();
  app.add_option("--pace", options->pace, "playback speed of files; 0: as fast as possible")
      ->type_name("TIMES")
      ->capture_default_str();
  app.add_flag("--loop", options->loop, "endless repetition of files");
  app.add_option("--duration", options->duration_s, "duration of the run; 0: until the source ends")
      ->type_name("S")
      ->capture_default_str();
  return [options, &app] {
    options->has_max_age = app.count("--max-age") > 0;
    options->has_pace = app.count("--pace") > 0;
    options->has_config_option = app.count("--preset") + app.count("--config") > 0;
    return live_command(*options);
  };
}

}  // namespace cairn::cli
