// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/batch/run.hpp>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace cairn::batch {

/// Part k of n of a run, k from 1.
struct Shard {
  std::size_t number = 1;
  std::size_t of = 1;
};
/// "3/8". Throws Error.
Shard parse_shard(std::string_view text);
/// The shard of a task in a Slurm job array: its position in the array, whatever its numbers. nullopt outside
/// of an array; throws Error if the numbers are not a range.
std::optional<Shard> shard_of_slurm();
std::string text(Shard shard);

/// The frames begin … end − 1 of the manifest: consecutive ones, so that a video is decoded in one pass. With
/// tracks a shard has whole sequences.
struct FrameSpan {
  std::size_t begin = 0;
  std::size_t end = 0;
};
FrameSpan span_of(Shard shard, const Run& run);

std::filesystem::path part_file(const Run& run, Shard shard);
/// The shard that a file in parts/ or work/ belongs to.
std::optional<Shard> shard_of_file(const std::filesystem::path& file);

/// The status of a worker in work/part-K-of-N.lock: JSON, while it holds the lock of the file and after.
struct WorkerNote {
  std::string host;
  long pid = 0;
  double started_s = 0;     // since 1970
  double updated_s = 0;     // the same
  std::size_t resumed = 0;  // rows present at its start
  std::size_t rows = 0;
  std::size_t errors = 0;
};

struct WorkResult {
  bool was_done = false;  // the part was already complete
  std::size_t frames = 0;
  std::size_t resumed = 0;  // rows of an interrupted worker
  std::size_t errors = 0;
};

/// Computes the row of a planned frame: a line of JSON without newline that begins with row_begin().
/// Exceptions end the work, which continues from there when called again.
using MakeRow = std::function<std::string(const PlannedFrame&)>;

/// Called during the work with the position of the next frame in the shard.
using OnFrame = std::function<void(std::size_t place, std::size_t frames, const std::string& name)>;

/// Works on a shard until its part is complete. Rows are appended one by one in work/, each with a digest, so
/// that an interrupted worker loses at most one frame; they are synced to disk every 256 frames or 60 s. Of
/// two workers on one shard the second waits for the first (`on_wait`: for whom) and continues if that one
/// was interrupted. Throws Error if a file cannot be written.
WorkResult work_on(const Run& run, Shard shard, const MakeRow& make_row, const OnFrame& on_frame,
                   const std::function<void(const std::string&)>& on_wait);

/// The note of a worker; nullopt if the file has none. `is_held`: the worker still runs.
struct SeenWorker {
  WorkerNote note;
  bool is_held = false;
};
std::optional<SeenWorker> see_worker(const std::filesystem::path& lock_file);

}  // namespace cairn::batch
