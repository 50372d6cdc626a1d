// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

/// The folder of a batch run: run.json, manifest.jsonl, config.yaml, parts/ and work/. (docs/batch.md)
namespace cairn::batch {

using Json = nlohmann::ordered_json;

/// A frame of the manifest.
struct PlannedFrame {
  std::string name;  // unique in the run; a relative path that stays below where it starts
  Json how;          // the whole line: how to read it
};

/// A planned run.
struct Run {
  std::filesystem::path folder;
  std::string id;  // SHA-256 over version, manifest, configuration
  std::size_t frames = 0;
  /// For a run with tracks: the first frame of each sequence; shards do not split sequences. Empty:
  /// independent frames.
  std::vector<std::size_t> sequences;
  std::string manifest_sha256;
  std::string config_sha256;

  [[nodiscard]] std::filesystem::path manifest() const { return folder / "manifest.jsonl"; }
  [[nodiscard]] std::filesystem::path config() const { return folder / "config.yaml"; }
  [[nodiscard]] std::filesystem::path parts() const { return folder / "parts"; }
  [[nodiscard]] std::filesystem::path work() const { return folder / "work"; }
};

struct PlanResult {
  Run run;
  bool was_there = false;  // the same run was planned before
};

/// Writes the manifest of a run, one line per frame, and its configuration; run.json last. `sequences`: as in
/// Run. No effect if the folder already contains the same run. Throws Error if it contains another one or
/// other files, two frames have one name, or there is no frame.
PlanResult plan(const std::filesystem::path& folder, const std::vector<PlannedFrame>& frames,
                const std::vector<std::size_t>& sequences, std::string_view config_yaml);

/// Reads run.json. Throws Error if the folder contains no run, or one planned by another version.
Run open_run(const std::filesystem::path& folder);

/// Throws Error if manifest or configuration have changed since planning.
void check_unchanged(const Run& run);

/// Calls `visit` for the planned frames begin … end − 1 in the order of the manifest.
void each_planned(const Run& run, std::size_t begin, std::size_t end,
                  const std::function<void(std::size_t index, PlannedFrame frame)>& visit);

/// The beginning of the row of a frame: {"frame":"000012",
std::string row_begin(const std::string& frame);
/// The row of an unusable frame.
std::string error_row(const std::string& frame, const std::string& why);
/// Whether this row of the frame is an error row.
bool is_error_row(std::string_view row, const std::string& frame);

}  // namespace cairn::batch
