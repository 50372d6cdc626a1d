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

/// One frame of the manifest.
struct PlannedFrame {
  std::string name;  // unique in the run; a relative path that stays below where it starts
  Json how;          // the whole line: what reads it
};

/// A run that is planned.
struct Run {
  std::filesystem::path folder;
  std::string id;  // SHA-256 over version, manifest, configuration
  std::size_t frames = 0;
  /// Of a run with tracks: the first frame of each sequence, which no shard parts. Empty: frames by
  /// themselves.
  std::vector<std::size_t> sequences;
  std::string manifest_sha256;
  std::string config_sha256;

  [[nodiscard]] std::filesystem::path manifest() const { return folder / "manifest.jsonl"; }
  [[nodiscard]] std::filesystem::path config() const { return folder / "config.yaml"; }
  [[nodiscard]] std::filesystem::path parts() const { return folder / "parts"; }
  [[nodiscard]] std::filesystem::path work() const { return folder / "work"; }
};

struct Planned {
  Run run;
  bool was_there = false;  // the same run had been planned before
};

/// Writes a run's manifest, a line for each frame, and its configuration; run.json last. `sequences`: as in
/// Run. Where the folder holds the same run already nothing changes. Throws Error where it holds another one
/// or other files, where two frames have one name, and where there is no frame.
Planned plan(const std::filesystem::path& folder, const std::vector<PlannedFrame>& frames,
             const std::vector<std::size_t>& sequences, std::string_view config_yaml);

/// Reads run.json. Throws Error where the folder holds no run, or one that another version planned.
Run open_run(const std::filesystem::path& folder);

/// Throws Error where manifest or configuration are not those that were planned.
void check_unchanged(const Run& run);

/// Calls `visit` for each planned frame of begin … end − 1 in the manifest's order.
void each_planned(const Run& run, std::size_t begin, std::size_t end,
                  const std::function<void(std::size_t index, PlannedFrame frame)>& visit);

/// How the row of a frame begins: {"frame":"000012",
std::string row_begin(const std::string& frame);
/// The row of a frame that cannot be used.
std::string error_row(const std::string& frame, const std::string& why);
/// Whether this row of the frame is one.
bool is_error_row(std::string_view row, const std::string& frame);

}  // namespace cairn::batch
