// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/sequence.hpp>
#include <string>

#include "common.hpp"

namespace CLI {
class App;
}

namespace cairn::cli {

/// SOURCE and its options, for commands on sequences.
struct SourceInput {
  std::string source;
  std::string frames;  // "10:60:2"
  input::SourceOptions options;
};
void add_source_options(CLI::App& app, SourceInput& input);
/// Throws Error.
std::unique_ptr<input::Sequence> open_source(const SourceInput& input, const Pool& pool,
                                             const ConfigOptions& config);

/// Makes Ctrl-C end a camera source like the end of a file, during its lifetime, since cameras do not end by
/// themselves. No effect on files. One at a time.
class EndsBySignal {
 public:
  explicit EndsBySignal(input::Sequence& sequence);
  ~EndsBySignal();
  EndsBySignal(const EndsBySignal&) = delete;
  EndsBySignal& operator=(const EndsBySignal&) = delete;
};

/// Throws Error if both priors are given, since only one would be used.
void refuse_two_priors(const std::string& odometry, const std::string& imu);

/// The remarks on skipped frames, for stderr: one line each, and one for an early end.
std::string remarks_text(const input::Sequence& sequence);
/// 3 after an early end, 2 if frames could not be read, else 0.
int exit_code_of(const input::Sequence& sequence);

}  // namespace cairn::cli
