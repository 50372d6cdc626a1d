// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "run_sinks.hpp"

#include <CLI/CLI.hpp>
#include <cairn/live/queued_sink.hpp>
#include <cairn/live/service_notice.hpp>
#include <iostream>

namespace cairn::cli {
namespace {

/// Prints once what the run assumes about other sensors, when these have had the time to say something.
class SensorNotice : public live::Sink {
 public:
  explicit SensorNotice(const live::Runner& runner) : runner_(runner) {}
  void offer(const live::LiveFramePtr& /*frame*/) override {
    if (++frames_ == 30) print();
  }
  void finish() override {
    if (frames_ < 30) print();
  }

 private:
  void print() const {
    for (const std::string& assumed : runner_.assumptions()) std::cerr << "cairn: " << assumed << "\n";
  }

  const live::Runner& runner_;
  int frames_ = 0;
};

}  // namespace

void add_run_options(CLI::App& app, RunOptions& options) {
  add_source_options(app, options.source);
  add_sensor_options(app, options.sensors);
  add_config_options(app, options.config);
  add_exec_options(app, options.exec);
  add_device_option(app, options.exec);
  add_run_files_options(app, options.files);
  app.add_flag("--json-lines", options.json_lines, "one line of JSON per frame on standard output");
  add_record_options(app, options.record);
  add_view_options(app, options.view);
  add_ros2_options(app, options.ros2);
  add_share_options(app, options.share);
}

RunSinks::RunSinks(const RunOptions& options, live::Runner& runner, const input::Sequence& source,
                   const FollowConfig& config, bool tracks, bool waits, live::Sink& console)
    : options_(options), runner_(runner) {
  const std::string preset = preset_of(options.config);
  const live::MessageForm form{.rig = source.rig(), .preset = preset, .tracks = tracks};
  recorder_ =
      open_recorder(options.record, live::recorded_run(source, options.source.source, preset, tracks), waits);
  files_ = std::make_unique<RunFiles>(options.files, form, runner, source, options.source.source, config);
  if (options.json_lines) lines_ = std::make_unique<JsonLines>(form);
  const auto add_slow = [&](live::Sink& sink, const char* name, const char* skipped) {
    if (waits) return runner.add(sink);
    add(std::make_unique<live::QueuedSink>(sink, name, skipped));
  };
  if (waits || !options.files.output.empty())
    add_slow(*files_, "-o", "frames not written, because the disk was too slow");
  if (lines_) add_slow(*lines_, "stdout", "lines dropped, because they were read too slowly");
  runner.add(console);
  add(std::make_unique<SensorNotice>(runner));
  runner.add(*recorder_);
  add(make_view(options.view, runner, *recorder_, source, preset));
  add(make_ros2_sink(options.ros2, source));
  add(make_share_sink(options.share, options.sensors, runner, source));
  add(std::make_unique<live::ServiceNotice>());
}

void RunSinks::add(std::unique_ptr<live::Sink> sink) {
  if (!sink) return;
  runner_.add(*sink);
  sinks_.push_back(std::move(sink));
}

void RunSinks::begin() {
  begin_recording(options_.record, *recorder_);
}

std::string RunSinks::summary() const {
  std::string text;
  const auto add_line = [&](const live::Sink& sink) {
    if (const std::string line = sink.summary(); !line.empty()) text += line + "\n";
  };
  add_line(*recorder_);
  for (const auto& sink : sinks_) add_line(*sink);
  return text;
}

int RunSinks::exit_code(const input::Sequence& source) const {
  return recorder_->status().trouble.empty() ? exit_code_of(source) : 3;
}

}  // namespace cairn::cli
