// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/batch/run.hpp>
#include <cairn/input/sequence.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"

/// From the inputs of `cairn batch plan` to the lines of a manifest, and from those to frames.
namespace cairn::cli {

struct BatchInputs {
  std::vector<std::string> paths;
  std::string calib;
  std::string layout;  // of a single video
  std::string frames;  // of each input: "10:60:2"
  bool rectify = false;
  bool scale_calibration = false;
  int binning = 1;
  bool tracks = false;  // each input is a sequence, tracked from its first frame
};

struct PlannedFrames {
  std::vector<batch::PlannedFrame> frames;
  std::vector<std::size_t> sequences;  // with tracks: the first frame of each
};
/// The frames of all inputs in order. Throws Error.
PlannedFrames planned_frames(const BatchInputs& inputs, const Pool& pool);

/// The options of the command line as a file; values from the calibration of a frame still apply where they
/// are unset. `elsewhere`: as in resolve().
std::string config_of_run(const ConfigOptions& options,
                          const std::function<bool(std::string_view, std::string_view)>& elsewhere = {});
/// The same including the options of a sequence.
std::string config_of_tracked_run(const ConfigOptions& options);

struct BatchFrame {
  LoadedFrame loaded;
  std::optional<std::int64_t> stamp_ns;  // for sequences
};

/// The options of reading a sequence.
struct BatchSequence {
  std::string source;  // for open_sequence()
  std::string calib;
  std::string layout;
  bool rectify = false;
  bool scale_calibration = false;
  int binning = 1;
  std::size_t step = 1;   // between planned frames
  std::size_t first = 0;  // with tracks: the first frame

  bool operator==(const BatchSequence&) const = default;
};

/// Parses --frames; empty: all. Throws Error.
input::FrameRange range_of(const std::string& text);
/// The indices of the frames of a sequence within the range. Reads files to the end, since the stated length
/// of a video is an estimate. Throws Error.
std::vector<std::size_t> sequence_frames(const BatchSequence& sequence, const input::FrameRange& range,
                                         const Pool& pool);

/// Reads frames of sequences, in ascending order per sequence.
class SequenceReader {
 public:
  SequenceReader(ConfigOptions config, Pool pool);
  SequenceReader(const SequenceReader&) = delete;
  SequenceReader& operator=(const SequenceReader&) = delete;
  ~SequenceReader();
  /// A frame, independent of the frames read before. Throws Error if it cannot be read.
  BatchFrame read(const BatchSequence& sequence, std::size_t index);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The source of a manifest line; empty for a frame with its own files.
BatchSequence sequence_of(const batch::PlannedFrame& frame);
std::size_t index_of(const batch::PlannedFrame& frame);

/// Computes the rows of tracked sequences: the lines of tracks.jsonl, under the names of the frames.
class TrackRows {
 public:
  TrackRows(ConfigOptions config, const Exec& exec);
  TrackRows(const TrackRows&) = delete;
  TrackRows& operator=(const TrackRows&) = delete;
  ~TrackRows();
  /// Processes all earlier frames of the sequence, unless the previous row was that of the frame before. Adds to
  /// `news` what is found about the rig: lines for stderr.
  std::string row(const batch::PlannedFrame& frame, std::string& news);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Reads the frames of a manifest.
class BatchReader {
 public:
  BatchReader(ConfigOptions config, const Exec& exec);

  /// Throws Error if the frame cannot be processed on this machine: its folder is missing, or its calibration
  /// differs from that of the plan.
  void check(const batch::PlannedFrame& frame);
  /// Throws Error if the frame is unusable.
  BatchFrame read(const batch::PlannedFrame& frame);

 private:
  ConfigOptions config_;
  const Exec& exec_;
  SequenceReader sequences_;
  std::map<std::string, std::string> calibrations_;  // SHA-256 of the calibrations read
};

}  // namespace cairn::cli
