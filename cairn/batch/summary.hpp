// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/batch/shard.hpp>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::batch {

/// A shard with a worker, past or present.
struct ShardStatus {
  Shard shard;
  FrameSpan span;
  bool is_done = false;
  std::size_t rows = 0;
  std::optional<SeenWorker> worker;  // the last one, if its note is readable
};

struct Status {
  std::vector<ShardStatus> shards;  // by number of shards, then by number
  std::size_t frames_done = 0;      // in any shard, complete or not
  std::size_t errors = 0;           // rows of unusable frames
  /// Estimate for the remaining frames, at the pace of the running workers; nullopt without any.
  std::optional<double> seconds_left;
};
Status status_of(const Run& run);

/// The frames begin … end − 1 without a row.
struct MissingFrames {
  FrameSpan span;
  std::string first;  // names
  std::string last;
};
/// The frames without a complete part. Reads the manifest only if some are missing.
std::vector<MissingFrames> missing_frames(const Run& run);

struct MergeResult {
  std::size_t rows = 0;
  std::size_t errors = 0;
  std::string sha256;  // of the rows, each with its newline
};
/// Passes the rows of all frames in the order of the manifest to `take`, from whichever parts; frames without
/// a row are skipped. Throws Error if a part is not as a worker wrote it.
MergeResult merge(const Run& run, const std::function<void(std::string_view row_and_newline)>& take);

}  // namespace cairn::batch
