// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <cairn/live/live_frame.hpp>
#include <cairn/ros/from_step.hpp>

namespace cairn::live {

/// The recorded parts of each frame. (docs/recordings.md lists the topics)
struct RecordWhat {
  bool input = false;      // both images and their camera_info
  bool objects = false;    // objects, tracks, transforms, times
  bool disparity = false;  // with its holes
  bool masks = false;      // labels, and the reason of each hole
  bool clouds = false;     // obstacles and floor
  bool grid = false;       // of obstacles
};
/// "input,objects", "all". Throws Error.
RecordWhat parse_record_what(std::string_view text);

/// The metadata of a recording about its run.
struct RecordedRun {
  std::string source;
  std::optional<StereoRig> rig;
  Size size;
  std::optional<int> disparities;
  KnownGround ground;
  std::string preset;
  std::string stamps_from;
  bool tracks = true;
};
/// For an open source.
RecordedRun recorded_run(const input::Sequence& source, const std::string& name, const std::string& preset,
                         bool tracks);

struct RecorderOptions {
  RecordWhat what{.input = true, .objects = true};
  std::size_t most_waiting = 16;  // frames; further ones are skipped, and the recording notes that
  bool waits = false;             // wait instead of skipping: offer() then blocks
  // Called once if a recording ends because it cannot be written, with one line.
  std::function<void(const std::string&)> on_trouble = {};
};

struct RecorderStatus {
  bool is_recording = false;
  std::string path;
  std::uint64_t frames = 0;  // recorded
  std::uint64_t skipped = 0;
  std::uint64_t bytes = 0;
  std::string trouble;  // why it ended early
};

/// Records frames as MCAP, on request. Writes on its own thread. The run continues even if the file fails.
/// start(), stop() and status() from any thread.
class Recorder : public Sink {
 public:
  Recorder(RecordedRun run, RecorderOptions options);
  ~Recorder() override;

  /// Begins with the next frame. Throws Error if the file exists or cannot be written, or a recording is
  /// active.
  void start(const std::filesystem::path& path);
  /// Writes waiting frames and completes the file. No effect without a recording.
  void stop();
  [[nodiscard]] RecorderStatus status() const;

  void offer(const LiveFramePtr& frame) override;
  void finish() override { stop(); }
  [[nodiscard]] std::string summary() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// "cairn-20260131-235959.mcap": a name for a recording that begins now, in UTC.
std::string recording_name();

}  // namespace cairn::live
