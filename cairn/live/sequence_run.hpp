// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <cairn/input/sequence.hpp>
#include <cairn/live/sensors.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/map_file.hpp>
#include <cairn/sequence/trajectory_error.hpp>

namespace cairn::live {

/// Follows a source frame by frame, with data of other sensors and landmarks; Runner (runner.hpp) is the loop
/// around it.
class SequenceRun {
 public:
  /// Opens the files; the run of a map begins with the first frame. Throws Error like the readers,
  /// MapFile::open() and Follower, and for poses without stamps. `source` must outlive it.
  SequenceRun(const input::Sequence& source, std::string source_name, const SensorFiles& files,
              FollowConfig config, Exec exec);

  /// The next frame of the source. Throws Error like Follower::next() and MapFile::write(), and if the known
  /// poses have none within 5 ms of its stamp.
  TrackedFrame next(const input::SequenceFrame& frame);

  /// Like Follower::prefetch().
  void prefetch(const input::SequenceFrame& frame);

  /// The landmarks of the last frame; empty without a rig.
  [[nodiscard]] const LandmarkUpdate& marked() const { return marked_; }
  [[nodiscard]] const FollowConfig& config() const { return follower_.config(); }
  /// MapFile::map_id() of the map; empty without one.
  [[nodiscard]] const std::string& map_id() const { return map_id_; }
  /// What is assumed about sensors on topics that have no transform to the camera, one line each.
  [[nodiscard]] std::vector<std::string> assumptions() const { return sensors_.assumptions(); }
  /// Like Follower::set_config().
  void set_config(FollowConfig config) { follower_.set_config(std::move(config)); }
  /// Ends the run in the map. No effect without a writable map or any frame.
  void close(RunState state);

 private:
  void mark(const TrackedFrame& step, const input::SequenceFrame& frame);
  /// Begins a run on these landmarks; `number` is its own without a writable map.
  void begin_run(Stamp began, LandmarkMap landmarks, std::int64_t number, const std::optional<Pose>& start);

  const input::Sequence& source_;
  std::string source_name_;
  Follower follower_;
  Sensors sensors_;
  std::vector<TimedPose> poses_;
  std::string poses_name_;
  std::optional<MapFile> map_;  // nullopt when closed
  std::string map_id_;
  bool is_map_read_only_ = false;
  std::optional<Pose> start_;
  bool has_begun_ = false;
  LandmarkUpdate marked_;
  Stamp before_;
  Pose pose_before_;
};

}  // namespace cairn::live
