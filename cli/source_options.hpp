// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <CLI/CLI.hpp>
#include <source/sequence.hpp>
#include <string>

namespace cairn::cli {

/// SOURCE and how it is read, for commands that work on sequences.
struct SourceInput {
  std::string source;
  std::string frames;  // "10:60:2"
  io::SourceOptions options;
};
void add_source_options(CLI::App& app, SourceInput& input);
/// Throws Error.
std::unique_ptr<io::Sequence> open_source(const SourceInput& input, const Pool& pool);

/// A camera never ends by itself, and one that hangs gives no frame at hand: while this lives, Ctrl-C ends it
/// as a file's end would. Of files nothing changes. One at a time.
class EndsBySignal {
 public:
  explicit EndsBySignal(io::Sequence& sequence);
  ~EndsBySignal();
  EndsBySignal(const EndsBySignal&) = delete;
  EndsBySignal& operator=(const EndsBySignal&) = delete;
};

/// Of the two only one would be asked: throws Error where both are given.
void refuse_two_priors(const std::string& odometry, const std::string& imu);

/// What became of the source's frames, for stderr: a line for each remark, and one where it ended early.
std::string remarks_text(const io::Sequence& sequence);
/// 3 where it ended early, 2 where frames could not be read, else 0.
int exit_code_of(const io::Sequence& sequence);

}  // namespace cairn::cli
