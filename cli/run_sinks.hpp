// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "follow_options.hpp"
#include "json_lines.hpp"
#include "live_record.hpp"
#include "live_ros2.hpp"
#include "live_share.hpp"
#include "live_view.hpp"
#include "run_files.hpp"
#include "source_options.hpp"

namespace CLI {
class App;
}

namespace cairn::cli {

/// What `cairn follow` and `cairn live` have in common: the inputs, and the sinks of their frames.
struct RunOptions {
  SourceInput source;
  SensorInput sensors;
  ConfigOptions config;
  ExecOptions exec;
  RunFilesOptions files;
  bool json_lines = false;
  LiveRecordOptions record;
  ViewInput view;
  Ros2CommandOptions ros2;
  ShareInput share;
};
void add_run_options(CLI::App& app, RunOptions& options);

/// The sinks of a run, as the options request them.
class RunSinks {
 public:
  /// Adds them to the runner, `console` among them. `waits`: no sink skips a frame, and the files are written
  /// within the loop. Throws Error.
  RunSinks(const RunOptions& options, live::Runner& runner, const input::Sequence& source,
           const FollowConfig& config, bool tracks, bool waits, live::Sink& console);
  /// Whether the reader of stdout has gone.
  [[nodiscard]] bool is_closed() const { return lines_ && lines_->is_closed(); }
  /// Begins the recording, after all other checks. Throws Error.
  void begin();
  [[nodiscard]] const RunTotals& totals() const { return files_->totals(); }
  /// A line for each sink that has one.
  [[nodiscard]] std::string summary() const;
  /// exit_code_of() the source; 3 if the recording has stopped early.
  [[nodiscard]] int exit_code(const input::Sequence& source) const;

 private:
  void add(std::unique_ptr<live::Sink> sink);

  const RunOptions& options_;
  live::Runner& runner_;
  std::unique_ptr<live::Recorder> recorder_;
  std::unique_ptr<RunFiles> files_;
  std::unique_ptr<JsonLines> lines_;
  std::vector<std::unique_ptr<live::Sink>> sinks_;
};

}  // namespace cairn::cli
