// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <batch/run.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <source/sequence.hpp>
#include <string>
#include <vector>

#include "common.hpp"

/// From the inputs of `cairn batch plan` to the lines of a manifest, and from those to frames.
namespace cairn::cli {

struct BatchInputs {
  std::vector<std::string> paths;
  std::string calib;
  std::string layout;  // of one video
  std::string frames;  // of each input: "10:60:2"
  bool rectify = false;
  bool tracks = false;  // each input is a sequence, and followed from its first frame on
};

struct PlannedFrames {
  std::vector<batch::PlannedFrame> frames;
  std::vector<std::size_t> sequences;  // with tracks: the first frame of each
};
/// The frames of all inputs in their order. Throws Error.
PlannedFrames planned_frames(const BatchInputs& inputs, const Pool& pool);

/// A file of options that loads as the command line's: what the calibration of a frame says still counts
/// where they leave it open. `elsewhere`: as of resolve().
std::string config_of_run(const ConfigOptions& options,
                          const std::function<bool(std::string_view, std::string_view)>& elsewhere = {});
/// The same with the options of a sequence.
std::string config_of_tracked_run(const ConfigOptions& options);

struct BatchFrame {
  LoadedFrame loaded;
  std::optional<std::int64_t> stamp_ns;  // of sequences
};

/// How a sequence is read.
struct BatchSequence {
  std::string source;  // as open_sequence() takes it
  std::string calib;
  std::string layout;
  bool rectify = false;
  std::size_t step = 1;   // between the frames that are planned
  std::size_t first = 0;  // with tracks: where they begin

  bool operator==(const BatchSequence&) const = default;
};

/// --frames; empty: all. Throws Error.
io::FrameRange range_of(const std::string& text);
/// The numbers of the frames of a sequence that are in the range. Files are read to their end: what a video
/// says of its length is an estimate. Throws Error.
std::vector<std::size_t> sequence_frames(const BatchSequence& sequence, const io::FrameRange& range,
                                         const Pool& pool);

/// Reads frames of sequences, those of one in rising order.
class SequenceReader {
 public:
  SequenceReader(ConfigOptions config, Pool pool);
  SequenceReader(const SequenceReader&) = delete;
  SequenceReader& operator=(const SequenceReader&) = delete;
  ~SequenceReader();
  /// What a frame gives depends on nothing but the sequence and its number, whichever were read before.
  /// Throws Error where it cannot be read.
  BatchFrame read(const BatchSequence& sequence, std::size_t index);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// How the frame of a manifest's line is read; the source is empty where it has files of its own.
BatchSequence sequence_of(const batch::PlannedFrame& frame);
std::size_t index_of(const batch::PlannedFrame& frame);

/// Makes the rows of sequences that are followed: the lines of tracks.jsonl, under the frames' names.
class TrackRows {
 public:
  TrackRows(ConfigOptions config, const Exec& exec);
  TrackRows(const TrackRows&) = delete;
  TrackRows& operator=(const TrackRows&) = delete;
  ~TrackRows();
  /// Goes through all frames of the sequence before, where it has not just made the row of the one before.
  std::string row(const batch::PlannedFrame& frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads the frames of a manifest.
class BatchReader {
 public:
  BatchReader(ConfigOptions config, const Exec& exec);

  /// Throws Error where nothing can be said of the frame on this machine: its folder is not there, or its
  /// calibration is another than when it was planned.
  void check(const batch::PlannedFrame& frame);
  /// Throws Error where the frame cannot be used.
  BatchFrame read(const batch::PlannedFrame& frame);

 private:
  ConfigOptions config_;
  const Exec& exec_;
  SequenceReader sequences_;
  std::map<std::string, std::string> calibrations_;  // SHA-256 of those that were read
};

}  // namespace cairn::cli
