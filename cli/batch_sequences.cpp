// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/input/mcap_sequence.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/live/runner.hpp>
#include <cairn/live/topics.hpp>
#include <cairn/sequence/follow_config.hpp>
#include <cstdlib>

#include "batch_frames.hpp"
#include "findings.hpp"
#include "follow_options.hpp"
#include "source_options.hpp"

namespace cairn::cli {
namespace {

std::unique_ptr<input::Sequence> open(const BatchSequence& sequence, const input::FrameRange& range,
                                      const Pool& pool) {
  // Silences FFmpeg, which prints to stderr; "-8" is its quiet level.
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  input::SourceOptions options;
  options.calib = sequence.calib;
  options.layout = sequence.layout;
  options.rectify = sequence.rectify;
  options.scale_calibration = sequence.scale_calibration;
  options.binning = sequence.binning;
  options.frames = range;
  return input::open_sequence(sequence.source, options, pool);
}

/// Frame folders keep their numbers if a right image is missing; other sources do not.
std::optional<std::size_t> count_in_folder(const BatchSequence& sequence) {
  const std::string& source = sequence.source;
  std::error_code unknown;
  if (!std::filesystem::is_directory(source, unknown)) return std::nullopt;
  try {
    if (!sequence.layout.empty()) return io::find_both(source, io::layout_of(sequence.layout)).size();
    return io::find_frames(source).size();
  } catch (const Error&) {  // folders of raw cameras, where all frames are pairs
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::size_t> sequence_frames(const BatchSequence& sequence, const input::FrameRange& range,
                                         const Pool& pool) {
  const auto opened = open(sequence, range, pool);
  if (opened->status().is_live) {
    throw Error(sequence.source +
                ": is a camera, expected a source with an end; cairn record makes a folder of frames");
  }
  std::vector<std::size_t> frames;
  const auto add_until = [&](std::size_t end) {
    const std::size_t next = frames.empty() ? range.first : frames.back() + range.step;
    for (std::size_t i = next; i < end; i += range.step) frames.push_back(i);
  };
  std::error_code unknown;
  const std::filesystem::path left = sequence.source.substr(0, sequence.source.find(','));
  const bool is_video = std::filesystem::is_regular_file(left, unknown) || input::recording_in(left);
  if (!is_video) {  // image lists: no need to decode any
    std::size_t end = range.first + opened->size().value_or(0) * range.step;
    if (const auto all = count_in_folder(sequence)) end = std::min(*all, range.last_excluded.value_or(*all));
    add_until(end);
  } else {
    // Undecodable frames are planned too; their rows report the error.
    while (const auto frame = opened->next()) add_until(frame->index + 1);
  }
  if (frames.empty()) throw Error(sequence.source + ": no frame of it can be read, or none is in --frames");
  return frames;
}

input::FrameRange range_of(const std::string& text) {
  return input::parse_frame_range(text);
}

struct SequenceReader::State {
  ConfigOptions config;
  Pool pool;
  BatchSequence of;
  std::unique_ptr<input::Sequence> opened;         // the source being read sequentially
  std::optional<input::SequenceFrame> read_ahead;  // a frame already read, if earlier ones were skipped
  std::size_t next = 0;                            // first frame not yet passed

  [[nodiscard]] BatchFrame loaded(input::SequenceFrame frame, const input::Sequence& from) const {
    BatchFrame made;
    made.stamp_ns = frame.stamp.ns;
    made.loaded.left = std::move(frame.left);
    if (frame.disparity_px.empty()) {
      made.loaded.right = std::move(frame.right);
    } else {
      made.loaded.given = with_holes_marked(frame.disparity_px, {});
    }
    made.loaded.rig = from.rig();
    ResolvedConfig resolved = resolve(config, from.disparities());
    made.loaded.config = std::move(resolved.config);
    made.loaded.config.ground.known = from.ground();
    made.loaded.preset = std::move(resolved.preset);
    return made;
  }

  /// Opens the source for one frame, so that the error does not depend on frames read before.
  [[nodiscard]] BatchFrame alone(std::size_t index) const {
    const auto only = open(of, {index, index + 1, 1}, pool);
    auto frame = only->next();
    if (!frame) throw Error(of.source + ": frame " + std::to_string(index) + " cannot be read");
    return loaded(std::move(*frame), *only);
  }

  /// The frame, if sequential reading reaches it.
  std::optional<input::SequenceFrame> read_on(std::size_t index) {
    try {
      if (!opened || index < next) {
        read_ahead.reset();
        opened = open(of, {index, {}, of.step}, pool);
      }
      next = index + 1;
      while (!read_ahead || read_ahead->index < index) {
        read_ahead = opened->next();
        if (!read_ahead) return std::nullopt;
      }
    } catch (const Error&) {  // of this frame or an earlier one: alone() finds out
      opened.reset();
      read_ahead.reset();
      return std::nullopt;
    }
    if (read_ahead->index != index) return std::nullopt;
    return std::exchange(read_ahead, std::nullopt);
  }
};

SequenceReader::SequenceReader(ConfigOptions config, Pool pool)
    : state_(std::make_unique<State>(State{std::move(config), std::move(pool), {}, {}, {}, 0})) {}
SequenceReader::~SequenceReader() = default;

BatchFrame SequenceReader::read(const BatchSequence& sequence, std::size_t index) {
  State& state = *state_;
  if (sequence != state.of) {
    state.of = sequence;
    state.opened.reset();
    state.read_ahead.reset();
  }
  if (auto frame = state.read_on(index)) return state.loaded(std::move(*frame), *state.opened);
  return state.alone(index);
}

// ---- tracks ----

std::string config_of_tracked_run(const ConfigOptions& options) {
  const auto is_of_sequence = [](std::string_view name, std::string_view) { return is_of_following(name); };
  return config_of_run(options, is_of_sequence) + io::options_yaml(sequence_options(options));
}

struct TrackRows::State {
  ConfigOptions config;
  const Exec& exec;
  BatchSequence of;
  std::unique_ptr<input::Sequence> opened;
  std::unique_ptr<live::Runner> run;
  live::LiveFramePtr read_ahead;
  std::size_t next = 0;  // next frame to follow
  std::string ended;     // why no further frame can be followed

  void begin(const BatchSequence& sequence) {
    of = sequence;
    next = of.first;
    read_ahead.reset();
    run.reset();
    ended.clear();
    try {
      opened = open(of, {of.first, {}, of.step}, exec.pool);
      run = std::make_unique<live::Runner>(*opened, of.source, live::SensorFiles{},
                                           resolve_follow(config, opened->disparities(), opened->ground()),
                                           live::LiveOptions::unpaced(), exec);
    } catch (const Error& error) {
      ended = error.what();
    }
  }

  /// The row of frame `next`, which has this name.
  std::string advance(const std::string& name, std::string& news) {
    const std::size_t index = next;
    next += of.step;
    if (!ended.empty()) return batch::error_row(name, ended);
    try {
      if (!read_ahead) read_ahead = run->next();
      if (!read_ahead || read_ahead->pair->index != index)
        return batch::error_row(name, of.source + ": frame " + std::to_string(index) + " cannot be read");
      news += changes_text(name, read_ahead->changes);
      output::Json line = *results_of(*std::exchange(read_ahead, nullptr), {});
      line["frame"] = name;
      line.erase("name");
      return output::json_text(line);
    } catch (const Error& error) {
      ended = error.what();
      return batch::error_row(name, ended);
    }
  }
};

TrackRows::TrackRows(ConfigOptions config, const Exec& exec)
    : state_(std::make_unique<State>(State{std::move(config), exec, {}, {}, {}, {}, 0, {}})) {}
TrackRows::~TrackRows() = default;

std::string TrackRows::row(const batch::PlannedFrame& frame, std::string& news) {
  State& state = *state_;
  const BatchSequence sequence = sequence_of(frame);
  const std::size_t index = index_of(frame);
  if (sequence != state.of || index != state.next) state.begin(sequence);
  while (state.next < index) (void)state.advance(frame.name, news);
  return state.advance(frame.name, news);
}

}  // namespace cairn::cli
