// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/batch/summary.hpp>
#include <cairn/core/error.hpp>
#include <cairn/io/sha256.hpp>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

namespace cairn::batch {
namespace {

namespace fs = std::filesystem;

/// The shards with a file of this extension; empty without the folder.
std::vector<Shard> shards_in(const fs::path& folder, const char* ending) {
  std::vector<Shard> shards;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    if (it->path().extension() != ending) continue;
    if (const auto shard = shard_of_file(it->path())) shards.push_back(*shard);
  }
  return shards;
}

struct Part {
  FrameSpan span;
  Shard shard;
};

/// Finished, non-empty parts by first frame; the longest first if they start at the same frame.
std::vector<Part> parts_of(const Run& run) {
  std::vector<Part> parts;
  for (const Shard shard : shards_in(run.parts(), ".jsonl")) {
    const FrameSpan span = span_of(shard, run);
    if (span.begin < span.end) parts.push_back({span, shard});
  }
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return std::pair(a.span.begin, b.span.end) < std::pair(b.span.begin, a.span.end);
  });
  return parts;
}

/// The number of rows of an unfinished shard; 0 if not started, or without locks.
std::size_t lines_in(const Run& run, Shard shard) {
  std::ifstream file(run.work() / (part_file(run, shard).stem().string() + ".rows"), std::ios::binary);
  std::size_t lines = 0;
  for (std::string line; std::getline(file, line) && !file.eof();) ++lines;
  return lines;
}

/// The number of frames in the union of the spans.
std::size_t united(std::vector<FrameSpan> spans) {
  std::sort(spans.begin(), spans.end(),
            [](const FrameSpan& a, const FrameSpan& b) { return a.begin < b.begin; });
  std::size_t count = 0;
  std::size_t end = 0;
  for (const FrameSpan& span : spans) {
    const std::size_t begin = std::max(span.begin, end);
    if (span.end <= begin) continue;
    count += span.end - begin;
    end = span.end;
  }
  return count;
}

/// The part to use for each range of frames; frames between ranges are missing.
std::vector<Part> stretches_of(const Run& run) {
  std::vector<Part> stretches;
  std::size_t at = 0;
  for (const Part& part : parts_of(run)) {
    if (part.span.end <= at) continue;
    stretches.push_back({{std::max(at, part.span.begin), part.span.end}, part.shard});
    at = part.span.end;
  }
  return stretches;
}

/// Reads a part row by row.
class PartReader {
 public:
  PartReader(const Run& run, const Part& stretch)
      : path_(part_file(run, stretch.shard)), file_(path_, std::ios::binary) {
    if (!file_) throw Error(path_.string() + ": cannot be read");
    std::string row;
    for (std::size_t i = span_of(stretch.shard, run).begin; i < stretch.span.begin; ++i)
      std::getline(file_, row);
  }
  /// Includes the newline. Throws Error if the row is not that of this frame.
  std::string row_of(const std::string& frame) {
    std::string row;
    const bool is_whole = std::getline(file_, row) && !file_.eof();
    if (!is_whole || !row.starts_with(row_begin(frame)) || !row.ends_with('}')) {
      throw Error(path_.string() + ": has no complete row of frame " + frame +
                  ", expected a part written by cairn batch work; delete it and process this shard again");
    }
    return row + "\n";
  }

 private:
  fs::path path_;
  std::ifstream file_;
};

}  // namespace

Status status_of(const Run& run) {
  const auto less = [](Shard a, Shard b) { return std::pair(a.of, a.number) < std::pair(b.of, b.number); };
  std::map<Shard, ShardStatus, decltype(less)> shards(less);
  const auto at = [&](Shard shard) -> ShardStatus& {
    ShardStatus& status = shards[shard];
    status.shard = shard;
    status.span = span_of(shard, run);
    return status;
  };
  for (const Shard shard : shards_in(run.parts(), ".jsonl")) at(shard).is_done = true;
  for (const Shard shard : shards_in(run.work(), ".lock")) {
    at(shard).worker = see_worker(run.work() / (part_file(run, shard).stem().string() + ".lock"));
  }
  Status all;
  std::vector<FrameSpan> spans;
  double frames_per_s = 0;
  for (auto& [shard, status] : shards) {
    const auto& worker = status.worker;
    const std::size_t frames = status.span.end - status.span.begin;
    status.rows = status.is_done ? frames : std::min(lines_in(run, shard), frames);
    spans.push_back({status.span.begin, status.span.begin + status.rows});
    if (worker) all.errors += worker->note.errors;
    if (worker && worker->is_held && !status.is_done) {
      const WorkerNote& note = worker->note;
      const double seconds = note.updated_s - note.started_s;
      if (seconds > 0 && note.rows > note.resumed)
        frames_per_s += static_cast<double>(note.rows - note.resumed) / seconds;
    }
    all.shards.push_back(status);
  }
  all.frames_done = united(std::move(spans));
  if (frames_per_s > 0) all.seconds_left = static_cast<double>(run.frames - all.frames_done) / frames_per_s;
  return all;
}

std::vector<MissingFrames> missing_frames(const Run& run) {
  std::vector<MissingFrames> missing;
  std::size_t at = 0;
  const auto none_until = [&](std::size_t end) {
    if (at < end) missing.push_back({{at, end}, {}, {}});
  };
  for (const Part& stretch : stretches_of(run)) {
    none_until(stretch.span.begin);
    at = stretch.span.end;
  }
  none_until(run.frames);
  if (missing.empty()) return missing;
  auto gap = missing.begin();
  each_planned(run, gap->span.begin, missing.back().span.end, [&](std::size_t index, PlannedFrame frame) {
    if (index == gap->span.begin) gap->first = frame.name;
    if (index + 1 == gap->span.end) (gap++)->last = std::move(frame.name);
  });
  return missing;
}

MergeResult merge(const Run& run, const std::function<void(std::string_view)>& take) {
  const std::vector<Part> stretches = stretches_of(run);
  MergeResult merged;
  io::Sha256 sum;
  auto stretch = stretches.begin();
  std::optional<PartReader> reader;
  each_planned(run, 0, run.frames, [&](std::size_t index, const PlannedFrame& frame) {
    if (stretch != stretches.end() && index == stretch->span.end) {
      reader.reset();
      ++stretch;
    }
    if (stretch == stretches.end() || index < stretch->span.begin) return;
    if (!reader) reader.emplace(run, *stretch);
    const std::string row = reader->row_of(frame.name);
    sum.add(row);
    take(row);
    ++merged.rows;
    merged.errors += is_error_row(row, frame.name) ? 1 : 0;
  });
  merged.sha256 = sum.hex();
  return merged;
}

}  // namespace cairn::batch
