// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/recorder.hpp>
#include <memory>
#include <string>

#include "common.hpp"

namespace CLI {
class App;
}

namespace cairn::cli {

/// --record FILE and --record-what.
struct LiveRecordOptions {
  std::string file;
  std::string what = "input,objects";
};
void add_record_options(CLI::App& app, LiveRecordOptions& options);

/// An idle recorder. With `waits` no frame is skipped. Throws Error.
std::unique_ptr<live::Recorder> open_recorder(const LiveRecordOptions& options, live::RecordedRun run,
                                              bool waits);

/// Begins the recording requested by --record, after all other checks: an empty file would block the next
/// run. Throws Error.
void begin_recording(const LiveRecordOptions& options, live::Recorder& recorder);

/// The configuration stored in a recording, as the file of --config, during its lifetime. The file is in
/// memory, in no folder.
class RecordedConfig {
 public:
  /// Empty if `source` is not a recording, or one without a configuration, or if --preset or --config is
  /// given.
  RecordedConfig(const std::string& source, ConfigOptions& options, bool has_config_option);
  ~RecordedConfig();
  /// A line for stderr; empty if there is none.
  [[nodiscard]] std::string notice() const;
  /// A message about the configuration file, with the name of the recording instead.
  [[nodiscard]] std::string named(std::string message) const;
  RecordedConfig(const RecordedConfig&) = delete;
  RecordedConfig& operator=(const RecordedConfig&) = delete;

 private:
  std::string source_;
  std::string file_;  // of this process
  int descriptor_ = -1;
};

}  // namespace cairn::cli
