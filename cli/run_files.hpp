// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/runner.hpp>
#include <cairn/live/topics.hpp>
#include <cairn/output/follow_files.hpp>
#include <cairn/output/follow_page.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace cairn::cli {

/// The result files of a sequence.
struct RunFilesOptions {
  std::string output;
  bool frames_out = false;
  bool html = false;
};
void add_run_files_options(CLI::App& app, RunFilesOptions& options);
/// Throws Error for options without -o, and for a folder in `source`: results among the frames would be read as
/// frames by the next run.
void check(const RunFilesOptions& options, const std::string& source);

/// Totals of a run.
struct RunTotals {
  std::vector<double> milliseconds;
  double path_m = 0;
  std::set<std::int64_t> confirmed;
  int lost = 0;
  int keyframes = 0;
  std::map<std::string, int> refusals;
  std::vector<LandmarkEvent> events;
  int unreliable = 0;
  // For each witness and for the resulting value: sum, and number of frames where it is known.
  std::map<std::string, std::pair<double, int>> reliability;

  void add(const live::LiveFrame& frame);
  /// Of the times of the frames.
  [[nodiscard]] double percentile(double share) const;

 private:
  void add(const std::string& name, std::optional<float> share);
  std::optional<Point3> place_;
};

/// Writes the files of -o, if it is given, and keeps the totals.
class RunFiles : public live::Sink {
 public:
  /// `config`: at the start. Throws Error if the folder cannot be written.
  RunFiles(RunFilesOptions options, live::MessageForm form, const live::Runner& runner,
           const input::Sequence& source, std::string source_name, FollowConfig config);
  void offer(const live::LiveFramePtr& frame) override;
  /// The page and summary.json, however the run ended.
  void finish() override;
  [[nodiscard]] const RunTotals& totals() const { return totals_; }

 private:
  [[nodiscard]] std::string state() const;
  [[nodiscard]] output::Json summary_json() const;

  RunFilesOptions options_;
  live::MessageForm form_;
  const live::Runner& runner_;
  const input::Sequence& source_;
  std::string source_name_;
  FollowConfig config_;
  RunTotals totals_;
  std::optional<DeviceReport> device_;
  std::optional<output::FollowFiles> files_;
  std::optional<output::FollowPage> page_;
};

}  // namespace cairn::cli
