// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Replaces the sequence commands in a build without their dependencies.
#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>

#include "batch_frames.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "evaluate_sequence.hpp"
#include "tune_sequence.hpp"

namespace cairn::cli {
namespace {

[[noreturn]] void refuse() {
  throw Error(
      "sequences are not built in: they need OpenCV's video and calib3d, Eigen, dlib and SQLiteCpp "
      "(libopencv-video-dev libopencv-calib3d-dev libeigen3-dev libdlib-dev libsqlitecpp-dev); "
      "./dev build installs them");
}

Work not_built_in(CLI::App& app) {
  app.allow_extras();
  return []() -> int { refuse(); };
}

}  // namespace

std::vector<OptionInfo> sequence_options(const ConfigOptions&) {
  refuse();
}

Work declare_follow(CLI::App& app) {
  return not_built_in(app);
}
Work declare_live(CLI::App& app) {
  return not_built_in(app);
}
Work declare_map(CLI::App& app) {
  return not_built_in(app);
}
Work declare_agent(CLI::App& app) {
  return not_built_in(app);
}
Work declare_odometry(CLI::App& app) {
  return not_built_in(app);
}
Work declare_record(CLI::App& app) {
  return not_built_in(app);
}

input::FrameRange range_of(const std::string& /*text*/) {
  refuse();
}
std::vector<std::size_t> sequence_frames(const BatchSequence& /*sequence*/,
                                         const input::FrameRange& /*range*/, const Pool& /*pool*/) {
  refuse();
}
std::string config_of_tracked_run(const ConfigOptions& /*options*/) {
  refuse();
}
struct TrackRows::State {};
TrackRows::TrackRows(ConfigOptions /*config*/, const Exec& /*exec*/) {}
TrackRows::~TrackRows() = default;
std::string TrackRows::row(const batch::PlannedFrame& /*frame*/, std::string& /*news*/) {
  refuse();
}
struct SequenceReader::State {};
SequenceReader::SequenceReader(ConfigOptions /*config*/, Pool /*pool*/) {}
SequenceReader::~SequenceReader() = default;
BatchFrame SequenceReader::read(const BatchSequence& /*sequence*/, std::size_t /*index*/) {
  refuse();
}

int evaluate_sequence(const EvaluateSequenceOptions& /*options*/) {
  refuse();
}
int tune_sequence(const TuneSequenceOptions& /*options*/, const std::function<bool()>& /*stop*/) {
  refuse();
}
int evaluate_trajectory(const EvaluateSequenceOptions& /*options*/) {
  refuse();
}

}  // namespace cairn::cli
