// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <batch/shard.hpp>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::batch {

/// A shard on which somebody has begun to work.
struct ShardStatus {
  Shard shard;
  FrameSpan span;
  bool is_done = false;
  std::size_t rows = 0;
  std::optional<SeenWorker> worker;  // the last one, where its note can be read
};

struct Status {
  std::vector<ShardStatus> shards;  // by number of shards, then by number
  std::size_t frames_done = 0;      // in some shard, done or not
  std::size_t errors = 0;           // rows of frames that could not be used
  /// Of the frames that are not done, at the pace of the workers that run; none where none does.
  std::optional<double> seconds_left;
};
Status status_of(const Run& run);

/// Frames begin … end − 1 that have no row yet.
struct MissingFrames {
  FrameSpan span;
  std::string first;  // names
  std::string last;
};
/// Those of no finished part. Reads the manifest only where some are missing.
std::vector<MissingFrames> missing_frames(const Run& run);

struct Merged {
  std::size_t rows = 0;
  std::size_t errors = 0;
  std::string sha256;  // of the rows, each with its newline
};
/// Hands out the rows of all frames in the manifest's order, from whatever parts hold them; frames without a
/// row are passed over. Throws Error where a part is not what a worker wrote.
Merged merge(const Run& run, const std::function<void(std::string_view row_and_newline)>& take);

}  // namespace cairn::batch
