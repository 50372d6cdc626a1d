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

#include "../ros/from_step.hpp"
#include "live_frame.hpp"

namespace cairn::live {

/// What of each frame is recorded. (docs/recordings.md lists the topics)
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

/// What a recording says of the run that it is of.
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
/// Of a source that is open.
RecordedRun recorded_run(const io::Sequence& source, const std::string& name, const std::string& preset,
                         bool tracks);

struct RecorderOptions {
  RecordWhat what{.input = true, .objects = true};
  std::size_t most_waiting = 16;  // frames; further ones are skipped, which the recording says
  bool waits = false;             // instead of skipping: offer() then takes as long as it takes
  ros::FrameNames names;
  // Told once where a recording ends because it cannot be written, in one line.
  std::function<void(const std::string&)> on_trouble = {};
};

struct RecorderStatus {
  bool is_recording = false;
  std::string path;
  std::uint64_t frames = 0;  // recorded
  std::uint64_t skipped = 0;
  std::uint64_t bytes = 0;
  std::string trouble;  // why it ended before it was stopped
};

/// Records frames, while it is asked to, as MCAP. Writes on a thread of its own. Whatever becomes of the
/// file, the run goes on. start(), stop() and status() from any thread.
class Recorder : public Sink {
 public:
  Recorder(RecordedRun run, RecorderOptions options);
  ~Recorder() override;

  /// With the next frame. Throws Error where the file is there already or cannot be written, or one is being
  /// recorded.
  void start(const std::filesystem::path& path);
  /// What waits is written, and the file is whole. Nothing where nothing is recorded.
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
