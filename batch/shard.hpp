// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <batch/run.hpp>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace cairn::batch {

/// The k-th of n parts of a run, k from 1 on.
struct Shard {
  std::size_t number = 1;
  std::size_t of = 1;
};
/// "3/8". Throws Error.
Shard parse_shard(std::string_view text);
/// What Slurm's job arrays say of a task: its place in the array, whatever numbers that has. None outside of
/// one; throws Error where the numbers are no range.
std::optional<Shard> shard_of_slurm();
std::string text(Shard shard);

/// The frames begin … end − 1 of the manifest: neighbours, so that a video is decoded in one go. With tracks
/// a shard has whole sequences.
struct FrameSpan {
  std::size_t begin = 0;
  std::size_t end = 0;
};
FrameSpan span_of(Shard shard, const Run& run);

std::filesystem::path part_file(const Run& run, Shard shard);
/// The shard that a file in parts/ or work/ belongs to.
std::optional<Shard> shard_of_file(const std::filesystem::path& file);

/// What a worker says of itself in work/part-K-of-N.lock: JSON, while it holds the file's lock and after.
struct WorkerNote {
  std::string host;
  long pid = 0;
  double started_s = 0;     // since 1970
  double updated_s = 0;     // the same
  std::size_t resumed = 0;  // rows that were there when it began
  std::size_t rows = 0;
  std::size_t errors = 0;
};

struct Worked {
  bool was_done = false;  // the part was there
  std::size_t frames = 0;
  std::size_t resumed = 0;  // rows of an interrupted worker
  std::size_t errors = 0;
};

/// What turns a planned frame into its row: a line of JSON without its end that begins as row_begin() says.
/// What it throws ends the work, which goes on from there when it is called again.
using MakeRow = std::function<std::string(const PlannedFrame&)>;

/// What is said while it works: the place in the shard of the frame that is next.
using OnFrame = std::function<void(std::size_t place, std::size_t frames, const std::string& name)>;

/// Works on a shard until its part is there, whole. Rows are kept one by one in work/, each with a digest, so
/// that an interrupted worker loses one frame at most; on disk they are every 256 frames or 60 s. Of two
/// workers on one shard the second waits for the first (`on_wait`: for whom) and takes over where that one
/// was interrupted. Throws Error where a file cannot be written.
Worked work_on(const Run& run, Shard shard, const MakeRow& make_row, const OnFrame& on_frame,
               const std::function<void(const std::string&)>& on_wait);

/// A worker's note; none where the file holds none. `is_held`: the worker still runs.
struct SeenWorker {
  WorkerNote note;
  bool is_held = false;
};
std::optional<SeenWorker> see_worker(const std::filesystem::path& lock_file);

}  // namespace cairn::batch
