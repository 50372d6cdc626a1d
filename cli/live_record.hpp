// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <CLI/CLI.hpp>
#include <live/recorder.hpp>
#include <memory>
#include <string>

#include "common.hpp"

namespace cairn::cli {

/// --record FILE and what is recorded.
struct LiveRecordOptions {
  std::string file;
  std::string what = "input,objects";
};
void add_record_options(CLI::App& app, LiveRecordOptions& options);

/// A recorder that records nothing yet. With `waits` no frame is skipped. Throws Error.
std::unique_ptr<live::Recorder> open_recorder(const LiveRecordOptions& options, live::RecordedRun run,
                                              bool waits);

/// Begins where --record says so, once nothing else can be refused: an empty file would be in the next run's
/// way. Throws Error.
void begin_recording(const LiveRecordOptions& options, live::Recorder& recorder);

/// The configuration that a recording was made with, as the file behind --config, while this lives.
class RecordedConfig {
 public:
  /// Nothing where `source` is no recording, or one without a configuration, or where --preset or --config is
  /// given.
  RecordedConfig(const std::string& source, ConfigOptions& options, bool is_told);
  ~RecordedConfig();
  /// A line for stderr; empty where there is nothing to say.
  [[nodiscard]] std::string notice() const;
  /// A message about the configuration's file, with the recording's name in its place.
  [[nodiscard]] std::string named(std::string message) const;
  RecordedConfig(const RecordedConfig&) = delete;
  RecordedConfig& operator=(const RecordedConfig&) = delete;

 private:
  std::string source_;
  std::string file_;
};

}  // namespace cairn::cli
