// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "interrupt.hpp"
#include "run_sinks.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

std::string line_of(const TrackedFrame& step, const std::string& name) {
  const auto count = [&](auto&& which) {
    return std::count_if(step.tracks.list.begin(), step.tracks.list.end(), which);
  };
  const auto seen =
      count([](const Track& t) { return t.object != ObjectId::none && t.state != TrackState::tentative; });
  const auto moving = count([](const Track& t) {
    return t.is_moving && t.object != ObjectId::none && t.state != TrackState::tentative;
  });
  std::string line = name + ": " + std::to_string(seen) + (seen == 1 ? " track" : " tracks") + " in view";
  if (moving > 0) line += ", " + std::to_string(moving) + " moving";
  if (step.is_lost) return line + ", place not known";
  const Point3 p = step.map_from_camera.translation_m;
  line += ", at " + text_of("%.2f", p.x) + ", " + text_of("%.2f", p.y) + ", " + text_of("%.2f", p.z) + " m";
  if (step.index > 0 && step.motion.refusal != MotionRefusal::none)
    line += " (" + choice_name(step.motion.refusal, kMotionRefusals) + ")";
  return line;
}

/// "12/100 010, 41 Hz, 2 s left"
std::string progress_words(std::size_t done, std::optional<std::size_t> all, const std::string& name,
                           double seconds) {
  std::string words = std::to_string(done) + (all ? "/" + std::to_string(*all) : "") + " " + name;
  if (done == 0 || seconds <= 0) return words;
  const double rate = static_cast<double>(done) / seconds;
  words += ", " + text_of("%.1f Hz", rate);
  if (all && *all >= done) words += ", " + text_of("%.0f s left", static_cast<double>(*all - done) / rate);
  return words;
}

std::string unreliable_line(const TrackedFrame& step, const std::string& name) {
  return name + ": unreliable since " + std::to_string(step.reliability.weak_frames) + " frames (" +
         text_of("%.2f", double{step.reliability.value.value_or(0)}) +
         "), weakest: " + step.reliability.weakest;
}

std::string event_line(const LandmarkEvent& event) {
  std::string line = "  " + choice_name(event.kind, kLandmarkEventKinds);
  if (event.landmark != LandmarkId::none) line += ": landmark " + std::to_string(number(event.landmark));
  if (event.kind == LandmarkEventKind::moved) line += ", by " + text_of("%.2f m", length(event.moved_by_m));
  return line;
}

/// Prints a line per frame, its events, and on a terminal the progress.
class FollowConsole : public live::Sink {
 public:
  FollowConsole(std::optional<std::size_t> frames, bool prints)
      : frames_(frames), prints_(prints), progress_(frames.value_or(0)) {}

  void offer(const live::LiveFramePtr& frame) override {
    const TrackedFrame& step = frame->step;
    const std::string& name = frame->pair->name;
    progress_.clear();
    if (prints_) std::cout << line_of(step, name) << "\n";
    if (step.control) std::cerr << name << ": " << control_line(*step.control) << "\n";
    if (output::becomes_unreliable(step)) std::cerr << unreliable_line(step, name) << "\n";
    std::cerr << changes_text(name, frame->changes);
    for (const LandmarkEvent& event : frame->events) {
      if (prints_) std::cout << event_line(event) << "\n";
    }
    ++done_;
    const auto all = static_cast<double>(std::max<std::size_t>(1, frames_.value_or(0)));
    progress_.bar(frames_ ? static_cast<double>(done_) / all : 0.0,
                  progress_words(done_, frames_, name,
                                 std::chrono::duration<double>(live::Clock::now() - began_).count()));
  }
  void finish() override { progress_.clear(); }

 private:
  std::optional<std::size_t> frames_;
  bool prints_;
  Progress progress_;
  std::size_t done_ = 0;
  live::Clock::time_point began_ = live::Clock::now();
};

/// Why a run with a map has stored no landmark; empty if it has any.
std::string no_landmark_text(const LandmarkUpdate& marked) {
  if (!marked.state.map.list.empty()) return {};
  std::string text = "no landmark stored";
  for (const auto& reason : kLandmarkRefusals) {
    const auto count = std::ranges::count(marked.tracks, reason.value, &LandmarkOfTrack::refusal);
    if (count > 0)
      text += ", " + count_of(static_cast<std::size_t>(count), "track") + ": " + std::string(reason.name);
  }
  return text + " (landmarks.min_frames and the like: cairn config --sequence)\n";
}

int follow(const RunOptions& options) {
  check(options.files, options.source.source);
  check(options.view);
  const Exec exec = make_exec(options.exec);
  const auto source = open_source(options.source, exec.pool, options.config);
  const FollowConfig config = resolve_follow(options.config, source->disparities(), source->ground());
  const RunSinks* opened = nullptr;
  live::LiveOptions how = live::LiveOptions::unpaced();
  how.when_ended = RunState::aborted;
  how.is_ended = [&] { return is_interrupted() || !std::cout || (opened && opened->is_closed()); };
  live::Runner runner(*source, options.source.source, sensor_files(options.sensors, *source), config, how,
                      exec);
  FollowConsole console(source->size(), !options.json_lines);
  RunSinks sinks(options, runner, *source, config, true, true, console);
  opened = &sinks;
  const EndsBySignal ends(*source);
  catch_interrupts();
  sinks.begin();
  runner.run();
  if (sinks.is_closed()) std::cout.setstate(std::ios::badbit);
  const RunTotals& totals = sinks.totals();
  std::cerr << remarks_text(*source) << count_of(totals.milliseconds.size(), "frame") << ", "
            << count_of(totals.confirmed.size(), "track") << ", " << text_of("%.2f m", totals.path_m)
            << " of path, " << text_of("%.1f ms", totals.percentile(0.5)) << " a frame (p99 "
            << text_of("%.1f", totals.percentile(0.99)) << ")\n";
  for (const LandmarkEvent& change : changes_of(totals.events)) std::cerr << event_line(change) << "\n";
  if (!options.sensors.map.empty()) std::cerr << no_landmark_text(runner.marked());
  std::cerr << sinks.summary();
  return is_interrupted() ? kInterrupted : sinks.exit_code(*source);
}

}  // namespace

Work declare_follow(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  add_run_options(app, *options);
  return [options] { return follow(*options); };
}

}  // namespace cairn::cli
