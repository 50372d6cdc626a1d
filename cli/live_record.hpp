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

/// A recorder, which records at once where --record says so. With `waits` no frame is skipped. Throws Error.
std::unique_ptr<live::Recorder> open_recorder(const LiveRecordOptions& options, live::RecordedRun run,
                                              bool waits);

/// The configuration that a recording was made with, as the file behind --config, while this lives.
class RecordedConfig {
 public:
  /// Nothing where `source` is no recording, or one without a configuration, or where --preset or --config is
  /// given; else it says so on stderr.
  RecordedConfig(const std::string& source, ConfigOptions& options, bool is_told);
  ~RecordedConfig();
  RecordedConfig(const RecordedConfig&) = delete;
  RecordedConfig& operator=(const RecordedConfig&) = delete;

 private:
  std::string file_;
};

}  // namespace cairn::cli
